// anderson.hpp - Anderson acceleration of a fixed-point iteration x = G(x) (Anderson 1965; Walker, Ni 2011,
// Anderson acceleration for fixed-point iterations): from the last images, the combination with the least
// residual if G were linear. It has the fixed points of G, and no others.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <limits>
#include <vector>

namespace ilaw::coupled {

class Anderson {
 public:
  static constexpr std::size_t max_depth = 10;
  // Sums numbers over all ranks.
  using Sum = std::function<void(double* values, std::size_t count)>;

  // slack: the history is dropped where the squared residual exceeds the least so far by this factor.
  void reset(std::size_t size, std::size_t depth, double slack);
  void forget();
  // The next x is the image G(x) plus this correction, given the residual G(x) - x. Returns false where there
  // is none.
  bool correct(const std::vector<double>& image, const std::vector<double>& residual, const Sum& sum,
               std::vector<double>& correction);

 private:
  void store(const std::vector<double>& image, const std::vector<double>& residual);
  bool solve(std::array<double, max_depth>& right) const;

  std::size_t size_ = 0, depth_ = 0, stored_ = 0, next_ = 0;
  double slack_ = 1.0, least_ = std::numeric_limits<double>::infinity();
  bool has_last_ = false;
  std::vector<double> last_image_, last_residual_;
  std::array<std::vector<double>, max_depth> images_, residuals_;  // differences of successive ones
  std::array<std::array<double, max_depth>, max_depth> products_{};
};

}  // namespace ilaw::coupled
