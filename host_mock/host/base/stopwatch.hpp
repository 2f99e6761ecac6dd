// stopwatch.hpp - adds wall-clock times of one phase after the other to sums. The system's clock
// takes as long as a step of a small scene, so that x86 processors count ticks instead.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <cstdint>

#ifdef __x86_64__
#include <x86intrin.h>
#endif

namespace ilaw::host {

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
