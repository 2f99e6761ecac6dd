// float_environment.hpp - the floating-point environment that laws are computed in, whatever the host's is.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit/detail/level.hpp>

#if !defined(__x86_64__)
#include <cfenv>
#endif

namespace ilaw::kit::inline ILAW_KIT_LEVEL::detail {

// As long as it lives: round to nearest, subnormal numbers, no traps. Then the host's environment again, with
// the exception flags as they were. Written only where it differs: reading it costs a cycle or two, writing
// it some twenty.
#if defined(__x86_64__)
class float_environment {
 public:
  float_environment() : host_(read()) {
    if ((host_ & ~all_flags) != all_masked) write(all_masked);
  }
  ~float_environment() {
    if (read() != host_) write(host_);
  }
  float_environment(const float_environment&) = delete;
  float_environment& operator=(const float_environment&) = delete;

 private:
  static constexpr unsigned all_masked = 0x1F80, all_flags = 0x3F;  // of the register MXCSR

  static unsigned read() {
    unsigned value;
    asm volatile("stmxcsr %0" : "=m"(value)::"memory");
    return value;
  }
  static void write(unsigned value) { asm volatile("ldmxcsr %0" ::"m"(value) : "memory"); }

  unsigned host_;
};
#else
class float_environment {
 public:
  float_environment() {
    std::fegetenv(&host_);
    std::fesetenv(FE_DFL_ENV);
  }
  ~float_environment() { std::fesetenv(&host_); }
  float_environment(const float_environment&) = delete;
  float_environment& operator=(const float_environment&) = delete;

 private:
  std::fenv_t host_;
};
#endif

}  // namespace ilaw::kit::detail
