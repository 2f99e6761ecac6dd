// random.hpp - the random numbers of tests: the same for a seed, on every machine.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <random>

namespace ilaw::testing {

class Random {
 public:
  explicit Random(std::uint64_t seed = 1) : engine(seed) {}

  double operator()(double low = -1.0, double high = 1.0) {
    return low + (high - low) * (static_cast<double>(engine() >> 11) * 0x1p-53);
  }
  double between(double low, double high) { return (*this)(low, high); }
  // 10^x with x between both, or within +- most.
  double decades(double low, double high) { return std::pow(10.0, between(low, high)); }
  double decades(double most) { return decades(-most, most); }
  int below(int count) { return static_cast<int>(between(0.0, count)); }
  // Components within +- size.
  std::array<double, 3> vector(double size = 1.0) {
    const double x = size * (*this)(), y = size * (*this)(), z = size * (*this)();
    return {x, y, z};
  }

  std::mt19937_64 engine;
};

}  // namespace ilaw::testing
