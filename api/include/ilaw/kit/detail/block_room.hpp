// block_room.hpp - room for what a block of nodes copies, and where the host's state has what a law names.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit/detail/gather.hpp>
#include <ilaw/kit/detail/kernel.hpp>

namespace ilaw::kit::inline ILAW_KIT_LEVEL::detail {

// Columns of a block that are copies: where the host's arrays are not consecutive, or are turned to the local
// frame.
template <class Law, int Length>
struct block_room {
  using column = column_to<Length>;
  static constexpr int states = state_doubles<Law>;
  column v_free[3], v_previous[3], delassus[6], gap, gap_offset, area, normal[3], tangent[3];
  column impulse[3], velocity[3], energy[ILAW_ENERGY_COUNT], status, refused, stirs;
  column state_in[states + 1], state_out[states + 1];
  column first_tangent[3], second_tangent[3], frame_before[6], finite_previous[3];
  std::int64_t nodes[has_history<Law> ? Length : 1];  // where history is, of listed nodes
};

// How many numbers of a node make its H.
inline int delassus_numbers(std::uint32_t form, int dimension) {
  switch (form) {
    case ILAW_DELASSUS_SCALAR:
      return 1;
    case ILAW_DELASSUS_TRANSVERSE:
      return dimension > 1 ? 2 : 1;
    case ILAW_DELASSUS_DIAGONAL:
      return dimension;
    default:
      return dimension * (dimension + 1) / 2;
  }
}

}  // namespace ilaw::kit::detail
