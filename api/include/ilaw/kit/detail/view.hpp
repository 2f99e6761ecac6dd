// view.hpp - what a loop over packs works on: the host's arrays where they are rows or columns, copies of short blocks
// elsewhere (lists of nodes, other strides).
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit/detail/load_store.hpp>
#include <ilaw/kit/law.hpp>

namespace ilaw::kit::inline ILAW_KIT_LEVEL::detail {

inline constexpr int most_parameters = 32, most_amounts = 8;

// Where the tangents of nodes in the host's axes come from.
enum class tangents { of_plane, given, carried, chosen };

// The nodes worked on together where arrays are copied or windows summed.
inline constexpr int block_nodes = 64;

// Windows of a block: what they sum up to before the step, and codes of refusals; and what the step gave: the impulse
// in the local frame, and 1 or 0 for windows that take it in, and for those that are emptied before.
struct window_sums {
  alignas(64) double earlier[3][block_nodes], refused[block_nodes];
  alignas(64) double impulse[3][block_nodes], adds[block_nodes], clears[block_nodes];
};

template <class Number>
struct view {
  std::int64_t count;
  step_sizes step;
  double impulse_guard;  // an impulse times this must be finite: otherwise it overflows in the host's numbers
  int dimension;
  tangents tangents_from;
  bool is_scalar;         // H
  bool reads_previous;    // the law's motion does; else v_previous is there for energies alone, or absent
  bool frame_follows;     // a carried frame follows the normal wherever the node is
  bool varying;           // some parameter comes per node
  bool in_memory;         // no cache holds the batch
  bool moves;             // more than impulse and state is asked for
  array<const Number> v_free, v_previous, normal, tangent, delassus;
  const Number *gap, *gap_offset, *area;
  const Number* parameters[most_parameters];  // by the law's parameters; null: the same at all nodes
  array<Number> impulse, velocity, energy;
  Number* amounts[most_amounts];
  std::uint8_t* status;
  array<const double> state_in;
  array<double> state_out;
  array<const double> frame_in;  // six numbers
  array<double> frame_out;
  window_sums* windows;  // null: the law has none, or remembers nothing
  // Free histories: of the node at position 0, and the nodes where they are listed.
  double* history;
  std::int64_t history_node_stride, history_component_stride;
  const std::int64_t* nodes;
};

// Reasons of bad nodes, in the order in which they are looked for; from first_of_state on, one per state variable.
enum reason : int {
  no_reason,
  reason_parameter,
  reason_normal,
  reason_tangent,
  reason_v_free,
  reason_delassus,
  reason_gap,
  reason_v_previous,
  reason_area,
  reason_frame,
  reason_state,
  reason_several_solutions,
  reason_no_solution,
  reason_impossible_state,
  reason_time_before_history,
  reason_not_a_number,
  reason_overflow,
  reason_pull,
  reason_reach,
  reason_of_first_variable = 32,
};

// What a walk found.
struct tally {
  std::int64_t bad_count = 0, first_bad_node = -1, by_scalar_fallback = 0;
  int reason = no_reason;
  double stable_velocity_step = infinity;
};

// How many nodes ahead a loop asks for arrays that no cache holds, and from how many nodes on; 32 to 128 are alike.
inline constexpr int prefetch_distance = 64;
inline constexpr std::int64_t prefetch_from = 16384;

template <class Number>
ILAW_KIT_INLINE void prefetch(const array<Number>& a, std::int64_t i, int nodes) {
  constexpr int line = 64 / static_cast<int>(sizeof(Number));
  if (!a.at) return;
  if (a.rows) {
    for (int k = 0; k < a.count * nodes; k += line) __builtin_prefetch(a.at + a.count * i + k);
  } else {
    for (int c = 0; c < a.count; ++c) __builtin_prefetch(a.at + c * a.component + i);
  }
}
template <class Number>
ILAW_KIT_INLINE void prefetch(const view<Number>& b, std::int64_t i, int nodes) {
  prefetch(b.v_free, i, nodes);
  prefetch(b.v_previous, i, nodes);
  prefetch(b.normal, i, nodes);
  prefetch(b.delassus, i, nodes);
  if (b.gap) __builtin_prefetch(b.gap + i);
  prefetch(b.impulse, i, nodes);
  prefetch(b.velocity, i, nodes);
  prefetch(b.state_in, i, nodes);
  prefetch(b.state_out, i, nodes);
}

}  // namespace ilaw::kit::detail
