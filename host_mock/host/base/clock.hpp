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

}  // namespace ilaw::host
