// stopwatch.hpp - adds the wall-clock time of a scope to a sum of seconds.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>

namespace ilaw::host {

class Stopwatch {
 public:
  // weight: how often the time counts; 0: it is not taken, which costs more than a small scope.
  Stopwatch(double& seconds, int weight) : seconds_(seconds), weight_(weight) {
    if (weight_ > 0) start_ = std::chrono::steady_clock::now();
  }
  ~Stopwatch() {
    if (weight_ > 0)
      seconds_ += weight_ * std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }
  Stopwatch(const Stopwatch&) = delete;
  Stopwatch& operator=(const Stopwatch&) = delete;

 private:
  double& seconds_;
  int weight_;
  std::chrono::steady_clock::time_point start_;
};

}  // namespace ilaw::host
