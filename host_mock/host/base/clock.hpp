// clock.hpp - the system's clocks, and the median of what they measure.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <ctime>
#include <vector>

namespace ilaw::host {

// Seconds of a clock. CLOCK_THREAD_CPUTIME_ID, the processor's time of this thread, is one that others on the
// machine disturb little.
inline double clock_seconds(clockid_t clock) {
  std::timespec now{};
  clock_gettime(clock, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

inline double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// Wall-clock times of phases that follow each other: a reading ends one and begins the next.
class Laps {
 public:
  // weight: rounds that this one stands for; 0: it is not timed. A phase far longer than those of
  // rounds that are worth a weight was interrupted, and stands for itself.
  explicit Laps(int weight) : weight_(weight), last_(weight > 0 ? clock_seconds(CLOCK_MONOTONIC) : 0.0) {}
  void add_to(double& seconds) {
    if (weight_ == 0) return;
    const double now = clock_seconds(CLOCK_MONOTONIC);
    seconds += (now - last_ > longest ? 1 : weight_) * (now - last_);
    last_ = now;
  }

 private:
  static constexpr double longest = 1e-4;

  int weight_;
  double last_;
};

}  // namespace ilaw::host
