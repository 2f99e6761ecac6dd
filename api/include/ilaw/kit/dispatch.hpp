// dispatch.hpp - the block loop compiled for several instruction sets, the best chosen at create.
// All of them give the same bits, since they use the same IEEE operations in the same order.
// ILAW_ISA=baseline|v3|v4 in the environment caps the choice, to test just that.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit/kernel.hpp>

#include <cstdlib>
#include <cstring>

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && defined(__OPTIMIZE__)
#define ILAW_KIT_X86_LEVELS 1
#else
#define ILAW_KIT_X86_LEVELS 0
#endif

namespace ilaw::kit {

enum class instruction_set { baseline, v3, v4 };

inline instruction_set best_instruction_set() {
#if ILAW_KIT_X86_LEVELS
  const char* cap = std::getenv("ILAW_ISA");
  const auto allowed = [cap](const char* level) { return !cap || std::strcmp(cap, level) >= 0; };
  if (cap && std::strcmp(cap, "baseline") == 0) return instruction_set::baseline;
  __builtin_cpu_init();
  if (allowed("v4") && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
      __builtin_cpu_supports("avx512cd") && __builtin_cpu_supports("avx512dq") &&
      __builtin_cpu_supports("avx512vl"))
    return instruction_set::v4;
  if (allowed("v3") && __builtin_cpu_supports("avx2") && __builtin_cpu_supports("bmi2") &&
      __builtin_cpu_supports("fma"))
    return instruction_set::v3;
#endif
  return instruction_set::baseline;
}

// Where a whole batch is walked through, block by block; Walk is a callable made of inlined code only.
#if ILAW_KIT_X86_LEVELS
template <class Walk, class... Arguments>
[[gnu::target("arch=x86-64-v4,prefer-vector-width=512"), gnu::flatten]] auto walk_v4(
    Arguments&... arguments) {
  return Walk::run(arguments...);
}
template <class Walk, class... Arguments>
[[gnu::target("arch=x86-64-v3"), gnu::flatten]] auto walk_v3(Arguments&... arguments) {
  return Walk::run(arguments...);
}
#endif
template <class Walk, class... Arguments>
[[gnu::flatten]] auto walk_baseline(Arguments&... arguments) {
  return Walk::run(arguments...);
}

template <class Walk, class... Arguments>
auto dispatch(instruction_set level, Arguments&... arguments) {
#if ILAW_KIT_X86_LEVELS
  if (level == instruction_set::v4) return walk_v4<Walk>(arguments...);
  if (level == instruction_set::v3) return walk_v3<Walk>(arguments...);
#endif
  (void)level;
  return walk_baseline<Walk>(arguments...);
}

}  // namespace ilaw::kit
