// clock.hpp - the system's clocks, and the median of what they measure.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <ctime>
#include <vector>

#ifdef __x86_64__
#include <x86intrin.h>
#endif

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

// Wall-clock times of one phase after the other, added to sums. The system's clock takes as long as a step of
// a small scene, so that x86 processors count ticks instead.
inline std::int64_t ticks_now() {
#ifdef __x86_64__
  return static_cast<std::int64_t>(__rdtsc());
#else
  return std::chrono::steady_clock::now().time_since_epoch().count();
#endif
}

// How long a tick is, by the system's clock since the start.
class TickLength {
 public:
  double seconds() const {
    const std::int64_t ticks = ticks_now() - first_tick_;
    const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start_;
    return ticks > 0 ? elapsed.count() / static_cast<double>(ticks) : 0.0;
  }

 private:
  std::int64_t first_tick_ = ticks_now();
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

// Phases that follow each other: a reading ends one and begins the next.
class Laps {
 public:
  // weight: rounds that this one stands for; 0: it is not timed. A phase far longer than those of
  // rounds that are worth a weight was interrupted, and stands for itself.
  explicit Laps(int weight) : weight_(weight), last_(weight > 0 ? ticks_now() : 0) {}
  void add_to(std::int64_t& ticks) {
    if (weight_ == 0) return;
    const std::int64_t now = ticks_now();
    ticks += (now - last_ > longest ? 1 : weight_) * (now - last_);
    last_ = now;
  }

 private:
  static constexpr std::int64_t longest = 1 << 18;

  int weight_;
  std::int64_t last_;
};

}  // namespace ilaw::host
