// floating_control.hpp - how the processor rounds, traps and flushes to zero; not the flags that
// operations raise. Reading it costs some nanoseconds, where fegetenv costs a hundred.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cfenv>
#include <cstdint>

#ifdef __x86_64__
#include <x86intrin.h>
#endif

namespace ilaw::host {

class FloatingControl {
 public:
  bool operator==(const FloatingControl&) const = default;

#ifdef __x86_64__
  static FloatingControl now() {
    FloatingControl control;
    control.sse_ = _mm_getcsr() & ~flags;
    asm volatile("fnstcw %0" : "=m"(control.x87_));
    return control;
  }
  void restore() const {
    _mm_setcsr((_mm_getcsr() & flags) | sse_);
    asm volatile("fldcw %0" : : "m"(x87_));
  }

 private:
  static constexpr std::uint32_t flags = 0x3F;
  std::uint32_t sse_ = 0;
  std::uint16_t x87_ = 0;
#else
  static FloatingControl now() {
    FloatingControl control;
    control.rounding_ = std::fegetround();
    return control;
  }
  void restore() const { std::fesetround(rounding_); }

 private:
  int rounding_ = 0;
#endif
};

}  // namespace ilaw::host
