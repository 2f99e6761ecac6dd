// knobs.hpp - sizes and intervals that change the way to a solution, not the solution. Built with
// ILAW_HOSTILE they are as small as they can be, so that tests with few contacts take every path: all of them
// are shared by threads, each color overflows, methods take turns after a few iterations.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>

namespace ilaw::coupled::knobs {

#ifdef ILAW_HOSTILE
inline constexpr bool is_hostile = true;
#else
inline constexpr bool is_hostile = false;
#endif

template <class T>
constexpr T usually(T usual, T hostile) {
  return is_hostile ? hostile : usual;
}

// Contacts of a block.
inline constexpr std::size_t max_lanes = usually<std::size_t>(128, 8);
// Colors; contacts without a free one have a block each. A body with as many contacts leads to it.
inline constexpr int serial_color = usually(63, 2);
// Contacts that are colored at a time: few enough that their bodies stay in the second cache while all
// colors are visited, enough that threads have several blocks of each color.
inline constexpr std::size_t chunk = usually<std::size_t>(16384, 8);
// Bytes of blocks up to which one thread iterates, and nothing is fetched ahead.
inline constexpr std::size_t cached_bytes = usually<std::size_t>(std::size_t{1} << 20, 0);
// Blocks, and bodies, up to which one thread works on them outside of iterations.
inline constexpr std::size_t few_blocks = usually<std::size_t>(100, 1),
                             few_bodies = usually<std::size_t>(10000, 1);
// Iterations between looks for sleeping contacts that come within reach.
inline constexpr std::uint32_t wake_interval = usually(4U, 1U);
// Iterations of the conjugate method before others, and of each of these before another one gets its turn.
inline constexpr std::uint32_t first_conjugate = usually(30U, 1U), first_part = usually(100U, 30U);
// Try Newton's method first.
inline constexpr bool newton_first = is_hostile;

}  // namespace ilaw::coupled::knobs
