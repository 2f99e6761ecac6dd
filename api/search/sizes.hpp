// sizes.hpp - the structs of search.h among those that grow (ilaw/sized.hpp).
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/search.h>
#include <ilaw/sized.hpp>

namespace ilaw::sized {

template <>
inline constexpr std::uint32_t least<ilaw_facets_setup> = ILAW_FACETS_SETUP_SIZE_1_0;
template <>
inline constexpr std::uint32_t least<ilaw_facets_positions> = ILAW_FACETS_POSITIONS_SIZE_1_0;
template <>
inline constexpr std::uint32_t least<ilaw_facets_nearby> = ILAW_FACETS_NEARBY_SIZE_1_0;
template <>
inline constexpr std::uint32_t least<ilaw_facets_pairs_of> = ILAW_FACETS_PAIRS_OF_SIZE_1_0;
template <>
inline constexpr std::uint32_t least<ilaw_facets_overlaps_of> = ILAW_FACETS_OVERLAPS_OF_SIZE_1_0;
template <>
inline constexpr std::uint32_t least<ilaw_facets_counts> = ILAW_FACETS_COUNTS_SIZE_1_0;

}  // namespace ilaw::sized
