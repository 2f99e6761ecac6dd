// control_guard.hpp - restores the floating-point control that code of a library changed.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "refusal.hpp"

#include <ilaw/floating_control.hpp>

#include <string>

namespace ilaw::loading {

class control_guard {
 public:
  // Restores it and refuses that library.
  void check(const std::string& path, const char* when) const {
    if (ilaw::floating_control::now() == before_) return;
    before_.restore();
    throw refusal(ILAW_BAD_LIBRARY,
                  path + ": " + when +
                      " changed how the processor rounds, traps or flushes to zero; expected no change "
                      "(linking with -ffast-math makes one)");
  }
  ~control_guard() {
    if (ilaw::floating_control::now() != before_) before_.restore();
  }
  control_guard() = default;
  control_guard(const control_guard&) = delete;
  control_guard& operator=(const control_guard&) = delete;

 private:
  const ilaw::floating_control before_ = ilaw::floating_control::now();
};

}  // namespace ilaw::loading
