// floating_control.hpp - for C++ hosts: how the processor rounds, traps and flushes to zero, without the
// exception flags. A library that changes it makes all later code of its thread wrong. Reading it takes some
// nanoseconds.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cfenv>
#include <cstdint>

#ifdef __x86_64__
#include <x86intrin.h>
#endif

namespace ilaw {

class floating_control {
 public:
  bool operator==(const floating_control&) const = default;

#ifdef __x86_64__
  static floating_control now() {
    floating_control control;
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
  static floating_control now() {
    floating_control control;
    control.rounding_ = std::fegetround();
    return control;
  }
  void restore() const { std::fesetround(rounding_); }

 private:
  int rounding_ = 0;
#endif
};

}  // namespace ilaw
