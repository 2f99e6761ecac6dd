// SPDX-License-Identifier: BSD-3-Clause
#include "study/exact_parts.hpp"

#include "base/scene_error.hpp"

#include <algorithm>

namespace ilaw::host {

void refuse(const std::string& expected) { throw SceneError("/exact", "expected " + expected); }

void require(bool good, const std::string& expected) {
  if (!good) refuse(expected);
}

ExactNode piecewise(const std::vector<double>& instants, const std::vector<double>& velocities) {
  const auto velocity = [=](double time) {
    const auto k = std::upper_bound(instants.begin(), instants.end(), time) - instants.begin();
    return velocities[static_cast<std::size_t>(k)];
  };
  const auto displacement = [=](double time) {
    double sum = 0.0, from = 0.0;
    for (std::size_t k = 0; k < velocities.size() && from < time; ++k) {
      const double to = k < instants.size() ? std::min(instants[k], time) : time;
      sum += velocities[k] * (to - from);
      from = to;
    }
    return sum;
  };
  return {displacement, velocity, {}};
}

}  // namespace ilaw::host
