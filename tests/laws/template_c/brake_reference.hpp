// brake_reference.hpp - the equations of template_c, solved by bisection, apart from the law's own code.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>

namespace ilaw::testing {

// mu on a grid of slip speeds and temperatures: linear along both axes, constant beyond their ends.
struct FrictionTable {
  std::array<double, 3> speeds;
  std::array<double, 2> temperatures;
  std::array<std::array<double, 2>, 3> mu;  // a row per speed

  double operator()(double speed, double temperature) const {
    const auto part = [](double x, double low, double high) {
      return x <= low ? 0.0 : x >= high ? 1.0 : (x - low) / (high - low);
    };
    const std::size_t k = speed < speeds[1] ? 0 : 1;
    const double s = part(speed, speeds[k], speeds[k + 1]),
                 t = part(temperature, temperatures[0], temperatures[1]);
    const auto at = [&](std::size_t row) { return (1.0 - t) * mu[row][0] + t * mu[row][1]; };
    return (1.0 - s) * at(k) + s * at(k + 1);
  }
};

// v + h mu(v, T) r_N = v_free, 0 where it sticks. Needs a left side that rises with v.
inline double slip_after(const FrictionTable& mu, double temperature, double h, double r_N, double v_free) {
  if (v_free <= h * mu(0.0, temperature) * r_N) return 0.0;
  double low = 0.0, high = v_free;
  for (int k = 0; k < 200; ++k) {
    const double v = 0.5 * (low + high);
    (v + h * mu(v, temperature) * r_N < v_free ? low : high) = v;
  }
  return high;
}

}  // namespace ilaw::testing
