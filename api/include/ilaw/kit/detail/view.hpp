// view.hpp - what a loop over packs works on: the host's arrays where they are rows or columns, copies of
// short blocks elsewhere (lists of nodes, other strides).
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit/detail/load_store.hpp>
#include <ilaw/kit/law.hpp>

namespace ilaw::kit::inline ILAW_KIT_LEVEL::detail {

inline constexpr int most_parameters = 32, most_amounts = 8, most_states = 24, frame_size = 6;

// Where the tangents of nodes in the host's axes come from.
enum class tangents { of_plane, given, carried, chosen };

// Some nodes of a view, one by one, whatever they are; the pointers lead to types that are the same at every
// level. problems: of a law with a solver, else null.
using careful_function = void (*)(const void* law, const void* view, std::int64_t first, std::int64_t count,
                                  void* found, void* problems);
// The scalar fallback for problem k of a law with a solver.
using scalar_function = void (*)(const void* law, const void* step, void* problems, int k);

// Values that all nodes of a view share.
struct view_options {
  std::int64_t count;
  step_sizes step;
  bonds of_bonds = bonds::decided_by_law;
  double impulse_guard;  // an impulse times this must be finite: otherwise it overflows in the host's numbers
  int dimension;
  tangents tangents_from;
  bool is_scalar;       // H
  bool reads_previous;  // the law's motion does; else v_previous is there for energies alone, or absent
  bool frame_follows;   // a carried frame follows the normal wherever the node is
  bool varying;         // some parameter comes per node
  bool in_memory;       // no cache holds the batch
  bool moves;           // more than impulse and state is asked for
  bool has_balance;     // energy or an amount is
  bool has_amounts;     // an amount is
  const table* tables;  // by the law's parameters, over fields that come per node; null: none
  // Compiled at the baseline alone.
  careful_function careful;
  scalar_function scalar;
};

// ---- the arrays of a batch: one list for checks, walks, copies and devices, whose structs name them alike

inline constexpr int of_dimension = 0;  // components
inline constexpr std::uint32_t reads_motion = 1U << 31, reads_spins = 1U << 30;
struct array_card {
  std::uint32_t reads;  // a batch has it where it reads all of these
  bool is_required;
  int components;
  const char *absent, *flat, *collides;

  ILAW_KIT_INLINE bool is_in(std::uint32_t read) const { return (read & reads) == reads; }
  ILAW_KIT_INLINE int count(int dimension) const {
    return components == of_dimension ? dimension : components;
  }
};
// Calls f with the card of each array, and the array of that name in each of the structs. H comes apart.
#define ILAW_KIT_ARRAY(name, reads, is_required, components)                                     \
  f(array_card{reads, is_required, components, #name " is null",                                 \
               #name " has one component per node (component stride 0), expected a (d,n) array", \
               #name " has a stride of 0"},                                                      \
    s.name...)
template <class F, class... Structs>
ILAW_KIT_INLINE void for_inputs(F f, Structs&... s) {
  ILAW_KIT_ARRAY(v_free, reads_motion, true, of_dimension);
  ILAW_KIT_ARRAY(v_smooth, ILAW_INPUT_V_SMOOTH, false, of_dimension);
  ILAW_KIT_ARRAY(v_previous, ILAW_INPUT_V_PREVIOUS, true, of_dimension);
  ILAW_KIT_ARRAY(normal, ILAW_INPUT_NORMAL, true, of_dimension);
  ILAW_KIT_ARRAY(tangent, ILAW_INPUT_TANGENT, true, of_dimension);
  ILAW_KIT_ARRAY(gap, ILAW_INPUT_GAP, true, 1);
  ILAW_KIT_ARRAY(gap_offset, ILAW_INPUT_GAP, false, 1);
  ILAW_KIT_ARRAY(area, ILAW_INPUT_AREA, true, 1);
  ILAW_KIT_ARRAY(spin_free, reads_spins, true, 3);
  ILAW_KIT_ARRAY(spin_previous, reads_spins | ILAW_INPUT_V_PREVIOUS, true, 3);
}
template <class F, class... Structs>
ILAW_KIT_INLINE void for_outputs(F f, Structs&... s) {
  ILAW_KIT_ARRAY(impulse, reads_motion, true, of_dimension);
  ILAW_KIT_ARRAY(velocity, reads_motion, false, of_dimension);
  ILAW_KIT_ARRAY(energy, reads_motion, false, int{ILAW_ENERGY_COUNT});
  ILAW_KIT_ARRAY(moment, reads_spins, true, 3);
  ILAW_KIT_ARRAY(spin, reads_spins, false, 3);
}
#undef ILAW_KIT_ARRAY

// State: of arrays with the numbers of a state in space, or of a device's.
template <class Number, template <class> class State = array>
struct view : view_options {
  using value = Number;

  array<const value> v_free, v_smooth, v_previous, normal, tangent, spin_free, spin_previous;
  array<const value> delassus, gap, gap_offset, area;
  const double* parameters[most_parameters];  // by the law's; null: the same at all nodes
  array<value> impulse, velocity, moment, spin, energy;
  value* amounts[most_amounts];
  std::uint8_t* status;
  State<const double> state_in;
  State<double> state_out;
  array<const double> frame_in;
  array<double> frame_out;
  // Windows: what they sum up to, and codes of refusals; the impulse, and 1 or 0 for windows that take it in,
  // and for those that are emptied before. Null: the law has none, or remembers nothing.
  const double *earlier[3], *earlier_refused;
  double *given[3], *adds, *clears;

  bool varies(int parameter) const { return parameters[parameter] || (tables && tables[parameter].per_node); }
};

// Reasons of bad nodes, in the order in which they are looked for; from first_of_state on, one per state
// variable.
enum reason : int {
  no_reason,
  reason_parameter,
  reason_normal,
  reason_tangent,
  reason_v_free,
  reason_v_smooth,
  reason_delassus,
  reason_gap,
  reason_v_previous,
  reason_spin,
  reason_area,
  reason_frame,
  reason_state,
  reason_several_solutions,
  reason_no_solution,
  reason_impossible_state,
  reason_time_before_history,
  reason_unserved_delassus,
  reason_not_a_number,
  reason_overflow,
  reason_pull,
  reason_reach,
  reason_of_first_variable = 32,
};

// Findings of a walk.
struct tally {
  std::int64_t bad_count = 0, first_bad_node = -1, by_scalar_fallback = 0;
  int reason = no_reason;
  double stable_velocity_step = infinity;
};

// For doubles only, as floats lose by it: how many nodes ahead a loop prefetches arrays that no cache holds,
// and from how many nodes on; 32 to 128 are alike.
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
  prefetch(b.gap, i, nodes);
  prefetch(b.impulse, i, nodes);
  prefetch(b.velocity, i, nodes);
  prefetch(b.state_in, i, nodes);
  prefetch(b.state_out, i, nodes);
}

}  // namespace ilaw::kit::detail
