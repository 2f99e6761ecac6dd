// level.hpp - instruction-set levels. ilaw_add_plugin compiles a law's source once per level, with the
// compiler's -march; each level lives in an inline namespace of its own, so that the linker never mixes their
// code. All levels give the same bits, since they do the same IEEE operations in the same order.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#ifndef ILAW_KIT_LEVEL
#define ILAW_KIT_LEVEL baseline
#endif

namespace ilaw::kit::inline ILAW_KIT_LEVEL::detail {

// The code for old processors beside that of others has fewer loops: less to compile, and the same bits.
#if defined(ILAW_KIT_OTHER_LEVELS)
inline constexpr bool is_for_old_processors = true;
#else
inline constexpr bool is_for_old_processors = false;
#endif

}  // namespace ilaw::kit::detail
