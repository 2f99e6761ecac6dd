// dispatch.hpp - chooses, at create, the level whose compiled loops an instance will use; and the
// floating-point environment that laws are computed in, whatever the host's is. ILAW_ISA=baseline|v3|v4 in
// the environment caps the choice: to test a level, or to compare. Other texts are refused.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/ilaw.h>
#include <ilaw/kit/pack.hpp>

#include <atomic>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <initializer_list>

#if defined(__x86_64__)
#include <cpuid.h>
#else
#include <cfenv>
#endif

// A loop over a view, and what is done to the windows of a block before and after it. The pointers lead to
// types that are the same at every level.
using ilaw_kit_loop = void (*)(const void* law, const void* view, void* found);
using ilaw_kit_windows = void (*)(const void* window, const void* place, void* block);
// What is compiled of a law for each level. An array of them, one per law of the library, is what a level
// gives to the baseline, which does all the rest.
struct ilaw_kit_part {
  ilaw_kit_loop (*loop)(const void* instance, bool of_floats);  // null: floats have none
  ilaw_kit_windows read, write;                                 // null: the law has none
  void (*to_doubles)(const float* from, double* to, std::int64_t count);
  void (*to_floats)(const double* from, float* to, std::int64_t count);
};

#if defined(ILAW_KIT_OTHER_LEVELS)
// Null where the library was built without that level.
extern "C" [[gnu::weak, gnu::visibility("hidden")]] const ilaw_kit_part* ilaw_kit_parts_v3();
extern "C" [[gnu::weak, gnu::visibility("hidden")]] const ilaw_kit_part* ilaw_kit_parts_v4();
#endif

namespace ilaw::kit::inline ILAW_KIT_LEVEL::detail {

// Which levels of x86-64 a processor serves, by all that a compiler may use of them. Source: System V ABI,
// x86-64 supplement, section 3.1.1 (levels); Intel 64 Software Developer's Manual, volume 2, CPUID.

// Results of the instruction CPUID, and the registers that the operating system keeps (XCR0).
struct processor {
  std::uint32_t leaf_1_ecx = 0, leaf_7_ebx = 0, extended_ecx = 0, kept = 0;
};

constexpr std::uint32_t bits(std::initializer_list<int> places) {
  std::uint32_t mask = 0;
  for (const int place : places) mask |= std::uint32_t{1} << place;
  return mask;
}

// SSE3, SSSE3, FMA, CMPXCHG16B, SSE4.1, SSE4.2, MOVBE, POPCNT, XSAVE, OSXSAVE, AVX, F16C; BMI1, AVX2, BMI2;
// LAHF, LZCNT; registers of SSE and AVX.
inline constexpr processor level_v3{bits({0, 9, 12, 13, 19, 20, 22, 23, 26, 27, 28, 29}), bits({3, 5, 8}),
                                    bits({0, 5}), bits({1, 2})};
// Besides: AVX512 F, DQ, CD, BW, VL; their masks and registers.
inline constexpr processor level_v4{level_v3.leaf_1_ecx, level_v3.leaf_7_ebx | bits({16, 17, 28, 30, 31}),
                                    level_v3.extended_ecx, level_v3.kept | bits({5, 6, 7})};

constexpr bool serves(const processor& p, const processor& level) {
  return (p.leaf_1_ecx & level.leaf_1_ecx) == level.leaf_1_ecx &&
         (p.leaf_7_ebx & level.leaf_7_ebx) == level.leaf_7_ebx &&
         (p.extended_ecx & level.extended_ecx) == level.extended_ecx && (p.kept & level.kept) == level.kept;
}

inline processor this_processor() {
  processor p;
#if defined(__x86_64__)
  std::uint32_t a = 0, b = 0, c = 0, d = 0;
  if (__get_cpuid(1, &a, &b, &c, &d)) p.leaf_1_ecx = c;
  if (__get_cpuid_count(7, 0, &a, &b, &c, &d)) p.leaf_7_ebx = b;
  if (__get_cpuid(0x80000001U, &a, &b, &c, &d)) p.extended_ecx = c;
  // XGETBV is there if OSXSAVE is.
  if (p.leaf_1_ecx & bits({27})) __asm__ volatile("xgetbv" : "=a"(p.kept), "=d"(d) : "c"(0));
#endif
  return p;
}

// The text of ILAW_ISA when it names no level, otherwise null.
inline const char* unknown_level() {
  const char* cap = std::getenv("ILAW_ISA");
  for (const char* known : {"baseline", "v3", "v4"})
    if (cap && std::strcmp(cap, known) == 0) return nullptr;
  return cap;
}

#if defined(ILAW_KIT_OTHER_LEVELS)
// Bits of the levels that the processor serves, and bit 0 once it was asked: CPUID traps under a hypervisor,
// for 40 us. Hidden, because g++ shares other variables of headers among libraries, and never unloads these.
[[gnu::visibility("hidden")]] inline constinit std::atomic<std::uint32_t> known_levels{0};

inline std::uint32_t levels_served() {
  std::uint32_t served = known_levels.load(std::memory_order_relaxed);
  if (served != 0) return served;
  const processor here = this_processor();
  served = bits({0}) | (serves(here, level_v3) ? bits({3}) : 0) | (serves(here, level_v4) ? bits({4}) : 0);
  known_levels.store(served, std::memory_order_relaxed);
  return served;
}

struct other_level {
  const char* name;
  std::uint32_t bit;
  const ilaw_kit_part* (*parts)();
};
inline constexpr other_level other_levels[] = {{"v4", bits({4}), ilaw_kit_parts_v4},
                                               {"v3", bits({3}), ilaw_kit_parts_v3}};
#endif

// The parts of the best level that was compiled, that the processor has and the environment allows; null: the
// baseline's own.
inline const ilaw_kit_part* best_parts() {
#if defined(ILAW_KIT_OTHER_LEVELS)
  const char* cap = std::getenv("ILAW_ISA");
  const auto allowed = [cap](const char* level) {
    return !cap || (std::strcmp(cap, "baseline") != 0 && std::strcmp(cap, level) >= 0);
  };
  for (const other_level& level : other_levels)
    if (level.parts && allowed(level.name) && (levels_served() & level.bit) != 0) return level.parts();
#endif
  return nullptr;
}

// ---- the floating-point environment

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
