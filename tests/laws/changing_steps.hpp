// changing_steps.hpp - step sizes of the tests of order.
#pragma once

#include <cmath>
#include <functional>
#include <vector>

namespace ilaw::testing {

// Steps of three sequences without a common factor, from coarse to fine.
inline const std::vector<double> step_sets[] = {
    {1.03e-2, 2.9e-3, 1.03e-3, 2.9e-4}, {8.7e-3, 2.3e-3, 7.1e-4, 1.9e-4}, {1.3e-2, 3.7e-3, 1.3e-3, 3.7e-4}};

// The step at a time: fixed, or changing smoothly by 40 %.
using Steps = std::function<double(double time)>;
inline Steps fixed(double h) {
  return [h](double) { return h; };
}
inline Steps varying(double h) {
  return [h](double time) { return h * (1.0 + 0.4 * std::sin(3.0 * time)); };
}

}  // namespace ilaw::testing
