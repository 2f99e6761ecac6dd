// order.hpp - the order of convergence of errors.
#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

namespace ilaw::testing {

// Slope of log(error) over log(h) by least squares.
inline double order(const std::vector<double>& h, const std::vector<double>& error) {
  double sx = 0, sy = 0, sxx = 0, sxy = 0;
  const auto n = static_cast<double>(h.size());
  for (std::size_t k = 0; k < h.size(); ++k) {
    const double x = std::log(h[k]), y = std::log(error[k]);
    sx += x;
    sy += y;
    sxx += x * x;
    sxy += x * y;
  }
  return (n * sxy - sx * sy) / (n * sxx - sx * sx);
}

}  // namespace ilaw::testing
