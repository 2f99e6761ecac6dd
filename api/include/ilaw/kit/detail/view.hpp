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

// In the place of a host's number type: a pack of nodes that was copied to columns of doubles.
struct copied {};

// The arrays of a view. Careful: the loop finds the reason of each bad node, and writes such nodes, too.
template <class Number>
struct arrays_of {
  static constexpr bool are_careful = false;
  using value = Number;
  template <class T, int Count>
  using array_type = array<T>;
  template <class T>
  using state_type = array<T>;
};
template <>
struct arrays_of<copied> {
  static constexpr bool are_careful = true;
  using value = double;
  template <class T, int Count>
  using array_type = columns<T, Count>;
  template <class T>
  using state_type = columns<T, most_states>;
};

template <class Number>
struct view : view_options {
  using arrays = arrays_of<Number>;
  static constexpr bool is_careful = arrays::are_careful;
  using value = typename arrays::value;
  template <class T, int Count>
  using array_of = typename arrays::template array_type<T, Count>;

  array_of<const value, 3> v_free, v_smooth, v_previous, normal, tangent, spin_free, spin_previous;
  array_of<const value, 6> delassus;
  array_of<const value, 1> gap, gap_offset, area;
  const double* parameters[most_parameters];  // by the law's; null: the same at all nodes
  array_of<value, 3> impulse, velocity, moment, spin;
  array_of<value, ILAW_ENERGY_COUNT> energy;
  value* amounts[most_amounts];
  std::uint8_t* status;
  typename arrays::template state_type<const double> state_in;
  typename arrays::template state_type<double> state_out;
  array_of<const double, 6> frame_in;
  array_of<double, 6> frame_out;
  // Windows: what they sum up to, and codes of refusals; the impulse, and 1 or 0 for windows that take it in,
  // and for those that are emptied before. Null: the law has none, or remembers nothing.
  const double *earlier[3], *earlier_refused;
  double *given[3], *adds, *clears;

  bool varies(int parameter) const { return parameters[parameter] || (tables && tables[parameter].per_node); }
};

// A pack of nodes as columns of doubles: for the last, unfilled pack and for packs with a bad node. Lanes
// without a node are as the last one.
class pack_copy {
 public:
  view<copied> pack;

  template <class Number>
  [[gnu::noinline, gnu::cold]] pack_copy(const view<Number>& b, std::int64_t i, int width)
      : pack{}, first_(i), width_(width) {
    static_cast<view_options&>(pack) = b;
    pack.count = b.count - i < width ? b.count - i : width;
    pack.is_scalar = false;
    for_inputs([&](const array_card&, auto& from, auto& to, auto& copy) { take(from, to, copy); }, b, pack,
               copies_);
    take(b.delassus, pack.delassus, delassus_);
    if (b.is_scalar)
      for (int k = 0; k < width; ++k) delassus_[1][k] = delassus_[0][k];
    for (int p = 0; p < most_parameters; ++p) pack.parameters[p] = take(b.parameters[p], parameters_[p]);
    const auto aim = [](const array_card&, auto& from, auto& to, auto& copy) {
      if (from.at) to.at = copy[0];
    };
    for_outputs(aim, b, pack, copies_);
    for (int a = 0; a < most_amounts; ++a)
      if (b.amounts[a]) pack.amounts[a] = amounts_[a];
    if (b.status) pack.status = status_;
    take(b.state_in, pack.state_in, state_in_);
    pack.state_out.at = state_out_[0];
    take(b.frame_in, pack.frame_in, frame_in_);
    pack.frame_out.at = frame_out_[0];
    for (int c = 0; c < 3; ++c) {
      pack.earlier[c] = take(b.earlier[c], earlier_[c]);
      pack.given[c] = given_[c];
    }
    pack.earlier_refused = take(b.earlier_refused, earlier_[3]);
    pack.adds = given_[3];
    pack.clears = given_[4];
  }
  pack_copy(const pack_copy&) = delete;

  // Outputs, to the view that it was copied from.
  template <class Number>
  [[gnu::noinline, gnu::cold]] void give_back(const view<Number>& b) const {
    for_outputs([&](const array_card&, auto& to, auto& copy) { give(to, copy); }, b, copies_);
    for (int a = 0; a < most_amounts; ++a) give(b.amounts[a], amounts_[a]);
    give(b.status, status_);
    give(b.state_out, state_out_);
    give(b.frame_out, frame_out_);
    for (int c = 0; c < 3; ++c) give(b.given[c], given_[c]);
    give(b.adds, given_[3]);
    give(b.clears, given_[4]);
  }

 private:
  std::int64_t node(int lane) const { return first_ + (lane < pack.count ? lane : pack.count - 1); }
  template <class Number>
  const double* take(const Number* from, double* to) const {
    if (!from) return nullptr;
    for (int k = 0; k < width_; ++k) to[k] = static_cast<double>(from[node(k)]);
    return to;
  }
  template <class Number, int Count>
  void take(const array<Number>& from, columns<const double, Count>& to,
            double (&copy)[Count][copy_lanes]) const {
    if (!from.at) return;
    to.at = copy[0];
    for (int c = 0; c < Count; ++c)
      for (int k = 0; k < width_; ++k)
        copy[c][k] = c < from.count ? static_cast<double>(from.of(node(k), c)) : 0.0;
  }
  template <class Number, class From>
  void give(Number* to, const From* from) const {
    if (!to) return;
    for (int k = 0; k < pack.count; ++k) to[first_ + k] = static_cast<Number>(from[k]);
  }
  template <class Number, int Count>
  void give(const array<Number>& to, const double (&copy)[Count][copy_lanes]) const {
    if (!to.at) return;
    for (int c = 0; c < to.count; ++c)
      for (int k = 0; k < pack.count; ++k) to.of(first_ + k, c) = static_cast<Number>(copy[c][k]);
  }

  const std::int64_t first_;
  const int width_;
  using column = double[copy_lanes];
  struct alignas(64) copies {
    column v_free[3], v_smooth[3], v_previous[3], normal[3], tangent[3], gap[1], gap_offset[1], area[1];
    column spin_free[3], spin_previous[3];
    column impulse[3], velocity[3], energy[ILAW_ENERGY_COUNT], moment[3], spin[3];
  };
  copies copies_;
  alignas(64) column delassus_[6],
      parameters_[most_parameters], earlier_[4], given_[5], state_in_[most_states];
  alignas(64) column state_out_[most_states], frame_in_[6], frame_out_[6];
  alignas(64) column amounts_[most_amounts];
  std::uint8_t status_[copy_lanes];
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
