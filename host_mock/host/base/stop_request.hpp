// stop_request.hpp - whether a signal asked the process to end: runs look at it after each step.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <csignal>
#include <stdexcept>

namespace ilaw::host {

inline volatile std::sig_atomic_t stop_signal = 0;  // 0: none came

inline bool stop_requested() { return stop_signal != 0; }

// Thrown where work that has no results yet ends because of it.
class Interrupted : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace ilaw::host
