// stopwatch.hpp - adds the wall-clock time of a scope to a sum. The system's clock takes as long as
// a step of a small scene, so that x86 processors count ticks instead.
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

class Stopwatch {
 public:
  explicit Stopwatch(std::int64_t& ticks) : ticks_(ticks), start_(ticks_now()) {}
  ~Stopwatch() { ticks_ += ticks_now() - start_; }
  Stopwatch(const Stopwatch&) = delete;
  Stopwatch& operator=(const Stopwatch&) = delete;

 private:
  std::int64_t& ticks_;
  std::int64_t start_;
};

}  // namespace ilaw::host
