// draw.hpp - random numbers of a scene: the same on every machine, as the standard's distributions
// are not.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

namespace ilaw::host {

class Draw {
 public:
  explicit Draw(std::uint64_t seed) : bits_(seed) {}

  double uniform(double low, double high) {
    return low + (high - low) * static_cast<double>(bits_() >> 11U) * 0x1p-53;
  }
  // Every order of magnitude is as likely as the next.
  double magnitude(double low, double high) { return std::exp(uniform(std::log(low), std::log(high))); }
  int whole(int low, int high) {
    return low + static_cast<int>(bits_() % static_cast<std::uint64_t>(high - low + 1));
  }
  bool chance(double probability) { return uniform(0.0, 1.0) < probability; }
  template <class Value>
  const Value& one_of(const std::vector<Value>& values) {
    return values[static_cast<std::size_t>(whole(0, static_cast<int>(values.size()) - 1))];
  }
  std::vector<double> vector(int dimension, double size) {
    std::vector<double> made(static_cast<std::size_t>(dimension));
    for (double& component : made) component = size * uniform(-1.0, 1.0);
    return made;
  }
  std::vector<double> direction(int dimension) {
    std::vector<double> made;
    double square = 0.0;
    while (!(square > 0.01 && square <= 1.0)) {
      made.clear();
      square = 0.0;
      for (int c = 0; c < dimension; ++c) {
        made.push_back(uniform(-1.0, 1.0));
        square += made.back() * made.back();
      }
    }
    for (double& component : made) component /= std::sqrt(square);
    return made;
  }

 private:
  std::mt19937_64 bits_;
};

inline std::vector<double> along_last_axis(int dimension, double value) {
  std::vector<double> made(static_cast<std::size_t>(dimension), 0.0);
  made.back() = value;
  return made;
}

}  // namespace ilaw::host
