// dispatch.hpp - chooses, at create, the level whose compiled loops an instance will use.
// ILAW_ISA=baseline|v3|v4 in the environment caps the choice: to test a level, or to compare.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/ilaw.h>
#include <ilaw/kit/detail/level.hpp>
#include <ilaw/kit/detail/processor.hpp>

#include <cstdlib>
#include <cstring>

// Runs a checked batch of an instance; the pointers lead to types that are the same at every level.
// found: a tally. An array of them, one per law of the library, is what a level gives to the baseline.
using ilaw_kit_walk = void (*)(const void* instance, const ilaw_batch& batch, void* found);

#if defined(ILAW_KIT_OTHER_LEVELS)
extern "C" const ilaw_kit_walk* ilaw_kit_walks_v3();
extern "C" const ilaw_kit_walk* ilaw_kit_walks_v4();
#endif

namespace ilaw::kit::inline ILAW_KIT_LEVEL::detail {

// The walks of the best level that was compiled, that the processor has and the environment allows; null: the
// baseline's own.
inline const ilaw_kit_walk* best_walks() {
#if defined(ILAW_KIT_OTHER_LEVELS)
  const char* cap = std::getenv("ILAW_ISA");
  const auto allowed = [cap](const char* level) {
    return !cap || (std::strcmp(cap, "baseline") != 0 && std::strcmp(cap, level) >= 0);
  };
  const processor here = this_processor();
  if (allowed("v4") && serves(here, level_v4)) return ilaw_kit_walks_v4();
  if (allowed("v3") && serves(here, level_v3)) return ilaw_kit_walks_v3();
#endif
  return nullptr;
}

}  // namespace ilaw::kit::detail
