// node.hpp - what a step sees: a pack of interface nodes (or one, V = double), in their local frames.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit/law.hpp>
#include <ilaw/kit/vector.hpp>

namespace ilaw::kit::inline ILAW_KIT_LEVEL {

// ---- statuses

// A status of ilaw.h. Statuses of nodes are made from these by select alone, so that a step cannot give
// another one.
struct status_value {
  double code;
};
namespace status {
inline constexpr status_value free{ILAW_FREE}, closed{ILAW_CLOSED}, stick{ILAW_STICK}, slip{ILAW_SLIP},
    bonded{ILAW_BONDED}, broken{ILAW_BROKEN}, healed{ILAW_HEALED};
}  // namespace status

template <class V>
class status_of {
 public:
  ILAW_KIT_INLINE status_of(status_value s) : code_(s.code) {}
  ILAW_KIT_INLINE V code() const { return code_; }
  ILAW_KIT_INLINE static status_of from(V code) {
    status_of s{status::free};
    s.code_ = code;
    return s;
  }

  ILAW_KIT_INLINE friend mask_of<V> operator==(status_of a, status_value b) { return a.code_ == b.code; }
  ILAW_KIT_INLINE friend status_of select(mask_of<V> m, status_of a, status_of b) {
    return from(select(m, a.code_, b.code_));
  }

 private:
  V code_;
};
template <int Registers>
ILAW_KIT_INLINE status_of<pack_of<Registers>> select(pack_mask<Registers> m, status_value a, status_value b) {
  using V = pack_of<Registers>;
  return status_of<V>::from(select(m, V(a.code), V(b.code)));
}
ILAW_KIT_INLINE status_of<double> select(bool m, status_value a, status_value b) { return m ? a : b; }
ILAW_KIT_INLINE status_of<pack_of_one> select(mask_of_one m, status_value a, status_value b) {
  return m.m ? a : b;
}

// ---- why a law refuses a node

enum class refusal {
  none,
  several_solutions,    // the law's equations have more than one
  no_solution,          // the law's equations have none for this input
  impossible_state,     // the law cannot have written this state
  time_before_history,  // the clock was set back
  unserved_delassus,    // these parameters serve no such H
};

// ---- a node

// Stands in the place of an input that the law's card does not name: who reads it is told what to write.
template <class V, std::uint32_t Input>
struct undeclared_input {
  operator V() const {
    static_assert(Input != reads_gap, "the law reads gap: write reads_gap among .inputs of its card");
    static_assert(Input != reads_area, "the law reads area: write reads_area among .inputs of its card");
    static_assert(Input != reads_v_previous,
                  "the law reads v_previous: write reads_v_previous among .inputs of its card");
    static_assert(Input != reads_v_smooth,
                  "the law reads v_smooth: write reads_v_smooth among .inputs of its card");
    return 0.0;
  }
};
template <class Vector, std::uint32_t Input>
struct undeclared_vector {
  undeclared_input<typename Vector::number, Input> n, t1, t2;

  operator Vector() const { return {n}; }
  typename Vector::number tangential_length() const { return n; }
};

template <class Law, std::uint32_t Input, class Declared, class Undeclared>
using input_t = std::conditional_t<(Law::card.inputs & Input) != 0, Declared, Undeclared>;

// Stands in the place of spins and moments where H has none.
struct spinless {};

// What a step reads. Law: with its number type. Vector: vector<V>, or projected<V> for isotropic laws in the
// host's axes. Delassus: transverse<V> or full<V>.
template <class Law, class Vector, class Delassus>
struct node_inputs {
  using number = typename number_of_law<Law>::type;
  using V = number;
  using spin_type = std::conditional_t<has_spin_form<Delassus>, Vector, spinless>;

  const double time, velocity_step, position_step, per_position_step;
  const bool wants_energy;  // whether the results after "stored" are asked for, or an amount
  const bool is_coupled;    // the host gives v_smooth
  const bonds of_bonds;     // of laws that can_hold_bonds
  const prepared_t<Law>& prepared;
  const Vector v_free;  // relative velocity without interface
  // Without the impulse of any contact in the step; v_free where the host gives none.
  static constexpr bool has_smooth = reads<Law>(reads_v_smooth);
  const input_t<Law, reads_v_smooth, Vector, undeclared_vector<Vector, reads_v_smooth>> v_smooth;
  const input_t<Law, reads_v_previous, Vector, undeclared_vector<Vector, reads_v_previous>>
      v_previous;  // of the half step before
  const Delassus delassus;
  const input_t<Law, reads_gap, V, undeclared_input<V, reads_gap>> gap;  // offset already taken off
  const input_t<Law, reads_area, V, undeclared_input<V, reads_area>> area;
  // A spin w is given as w_N and w x n: the velocity at the contact point of a sphere of unit radius.
  const spin_type spin_free = {}, spin_previous = {};
  vector<V> earlier = {};  // what the law's window sums up to before the step
};

// What a step writes.
template <class Law, class Vector, class Spin>
struct node_results {
  using V = typename number_of_law<Law>::type;

  Vector impulse = {};
  Spin moment = {};         // m_N and m x n likewise
  state_t<Law> state = {};  // comes in as it was, leaves as it is
  V stored = 0.0;           // energy stored by the interface at the end of the step
  // Energy that the step added to it, by the normal and by the tangential motion; the rest of the work is
  // dissipated.
  V normal_gain = 0.0, tangential_gain = 0.0;
  V rupture = 0.0;  // part of these gains that is not stored: dissipated by rupture
  V rubbing = 1.0;  // part of the area that may rub: where a bond holds there is no wear
  V amounts[own_amount_count<Law> + 1] = {};
  V refused = 0.0;  // code of a refusal

  ILAW_KIT_INLINE void refuse(mask_of<V> where, refusal reason) {
    refused = select(where, V(static_cast<double>(reason)), refused);
  }
};

template <class Law, class Vector, class Delassus>
struct node : node_inputs<Law, Vector, Delassus>,
              node_results<Law, Vector, typename node_inputs<Law, Vector, Delassus>::spin_type> {
  using inputs = node_inputs<Law, Vector, Delassus>;
  using results = node_results<Law, Vector, typename inputs::spin_type>;
  using V = typename inputs::V;
};

template <class Node>
using number_of = typename Node::number;

// Kinds of nodes that laws tell apart when they are compiled: whether H = diag(h_N, h_T, h_T) at all of them,
// whether their vectors have tangential components with names, and spins.
template <class Node>
inline constexpr bool is_transverse = is_transverse_form<std::remove_cvref_t<decltype(Node::delassus)>>;
template <class Node>
inline constexpr bool has_tangents =
    std::is_same_v<std::remove_cvref_t<decltype(Node::v_free)>, vector<number_of<Node>>>;

template <class Node>
inline constexpr bool has_spins = has_spin_form<std::remove_cvref_t<decltype(Node::delassus)>>;

// The node that initialise sees: there is no motion yet.
template <class Law>
struct initial_node {
  const double time;
  const input_t<Law, reads_area, double, undeclared_input<double, reads_area>> area;
  state_t<Law> state;
};

// Result of ask at a node: whether a problem is left, and the status if none is.
template <class V>
struct asked {
  mask_of<V> open;
  status_of<V> status;
};

// Whether the law is given the velocity without the impulse of any contact in the step.
template <class Node>
inline constexpr bool has_smooth = requires {
  requires Node::has_smooth;
};

template <class Node>
ILAW_KIT_INLINE auto smooth_velocity(const Node& node) {
  if constexpr (has_smooth<Node>)
    return node.v_smooth;
  else
    return node.v_free;
}

// See ilaw.h: out of reach, to the last bit. The smaller of the next gaps with v_free and with v_smooth.
template <class Node>
ILAW_KIT_INLINE auto next_gap(const Node& node) {
  auto next = node.gap + node.position_step * node.v_free.n;
  if constexpr (has_smooth<Node>)
    if (node.is_coupled) next = smaller(node.gap + node.position_step * node.v_smooth.n, next);
  return next;
}
template <class Node>
ILAW_KIT_INLINE auto is_out_of_reach(const Node& node) {
  return (node.gap > 0.0) & (next_gap(node) > 0.0);
}

// The time over which a step's impulse acts: from half step to half step.
struct step_interval {
  double end, length;
};

}  // namespace ilaw::kit
