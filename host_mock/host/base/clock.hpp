// clock.hpp - the system's clocks, for those who measure.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ctime>

namespace ilaw::host {

// Seconds of a clock. CLOCK_THREAD_CPUTIME_ID, the processor's time of this thread, is one that others on the
// machine disturb little.
inline double clock_seconds(clockid_t clock) {
  std::timespec now{};
  clock_gettime(clock, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

}  // namespace ilaw::host
