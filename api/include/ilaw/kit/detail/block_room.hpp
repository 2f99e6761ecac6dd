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

// Entry of the host's state that holds double k of struct state; -1: a component beyond the dimension.
template <class Law>
int state_entry(int k, int dimension) {
  int entry = 0;
  if constexpr (has_state<Law>)
    for (std::size_t v = 0; v < std::size(Law::state_variables); ++v) {
      const auto& member = Law::state_variables[v].member;
      const int component = k - state_places<Law>[v];
      if (component >= 0 && component < member.doubles())
        return component < member.components(dimension) ? entry + component : -1;
      entry += member.components(dimension);
    }
  return -1;
}

template <class Law>
int state_entries(int dimension) {
  int count = 0;
  for (int k = 0; k < state_doubles<Law>; ++k) count += state_entry<Law>(k, dimension) >= 0 ? 1 : 0;
  return count;
}

}  // namespace ilaw::kit::detail
