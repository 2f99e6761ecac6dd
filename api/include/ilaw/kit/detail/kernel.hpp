// kernel.hpp - the loop over the nodes of a block: builds each node from its columns, steps it, writes
// columns. One loop serves every layout and frame; it is compiled once per instruction set (dispatch.hpp).
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit/declare.hpp>
#include <ilaw/kit/detail/frame.hpp>
#include <ilaw/kit/detail/gather.hpp>
#include <ilaw/kit/detail/node_state.hpp>
#include <ilaw/kit/detail/streams.hpp>
#include <ilaw/kit/window.hpp>

#include <bit>

namespace ilaw::kit::inline ILAW_KIT_LEVEL::detail {

// How many of the next blocks are not tried first, see try_first, and after the next one that fails.
struct full_blocks {
  int left = 0, after_next = 1;
};

// A block of nodes as columns. Pointers may lead into the host's arrays.
template <class Law>
struct node_block {
  static constexpr int states = state_doubles<Law>;

  int count;
  const streams* ahead;  // null: no other block follows
  std::int64_t next;     // position of the block that does
  double time, velocity_step, position_step;
  double impulse_guard;   // an impulse that overflows when multiplied by it may do so as the host is given it
  const double* axes[9];  // normal, tangents; see frame.hpp
  const double* v_free[3];
  const double* v_previous[3];            // as the law may read it, see batch_walk.hpp
  const double* v_previous_of_energy[3];  // as the host gave it
  const double* delassus[6];
  const double *gap, *gap_offset, *area;
  const double* state_in[states + 1];  // one more than needed: no array of length zero; rows: the first alone
  double* history_values;              // in state_out, of the block's first node (of node 0 with an index)
  std::int64_t history_node_stride, history_component_stride;
  const std::int64_t* history_nodes;  // null: consecutive
  const double* earlier[3];           // of laws with a window: what it sums up to before the step,
  const double* earlier_refused;      // and why it does not

  double* impulse[3];
  double* state_out[states + 1];
  double* velocity[3];
  double* energy[ILAW_ENERGY_COUNT];
  double* status;
  double* refused;   // 1 where the input was bad, else 0
  double* stirs;     // 0 where a carried frame stays as it was
  double* given[3];  // of laws with a window: the impulse for it, in the local frame,
  double* reached;   // and the status
  full_blocks* in_full;

  std::int64_t history_offset(int i) const {
    return (history_nodes ? history_nodes[i] : i) * history_node_stride;
  }
  history history_of(int i) const { return {history_values + history_offset(i), history_component_stride}; }
};

// What is computed besides impulse and state: nothing, v_previous read as well, velocity and status, or all.
enum class scope { impulse, with_previous, motion, outputs };
template <scope Scope>
inline constexpr scope reading = Scope == scope::impulse ? scope::impulse : scope::with_previous;

template <class Law, class Delassus, class Frame>
using node_in = node<Delassus, state_t<Law>, typename Frame::vector_type, Law::card.inputs>;

template <class Law, class Delassus, class Frame>
struct stepped {
  node_in<Law, Delassus, Frame> result;
  bool accepted;
};

template <class Delassus, class Layout, std::size_t... K>
Delassus delassus_at(const double* const* columns, int i, std::index_sequence<K...>) {
  const double components[] = {Layout::at(columns[K], i)...};
  return Delassus::from(components);
}

inline vector zero_unless_finite(vector a) {
  const bool good = defect(a) == 0.0;
  return {good ? a.n : 0.0, good ? a.t1 : 0.0, good ? a.t2 : 0.0};
}
inline projected_vector zero_unless_finite(projected_vector a) {
  const bool good = defect(a) == 0.0;
  return {good ? a.n : 0.0, good ? a.x : 0.0, good ? a.y : 0.0, good ? a.z : 0.0};
}

// Whether a law's instances may carry a frame in this kind of frame.
template <class Law, class Frame>
inline constexpr bool can_carry = std::is_same_v<Frame, stored_frame> &&
                                  (has_history<Law> || has_vector_state<Law>());

template <class Law>
inline constexpr bool reads_previous = (Law::card.inputs & reads_v_previous) != 0;
// Whatever its parameters: then there is one loop less to compile, and one for velocity and status alone.
template <class Law>
inline constexpr bool always_reads_previous = [] {
  if constexpr (requires { Law::always_reads; }) return (Law::always_reads & reads_v_previous) != 0;
  return reads_previous<Law> && !requires(const Law& law) { law.inputs(); };
}();

// Inputs as the law's card has them.
template <class Law, class Layout, scope Scope, class Basis>
auto previous_of(const node_block<Law>& b, int i, const Basis& frame) {
  using vector_type = decltype(frame.to_local(axis{}));
  if constexpr (!reads_previous<Law>) {
    return undeclared_vector<vector_type>{};
  } else if constexpr (Scope == scope::impulse) {
    return vector_type{};
  } else {
    return frame.to_local(Layout::get(b.v_previous, i));
  }
}
template <class Law, class Layout>
auto gap_of(const node_block<Law>& b, int i) {
  if constexpr ((Law::card.inputs & reads_gap) != 0)
    return Layout::at(b.gap, i) - Layout::at(b.gap_offset, i);
  else
    return undeclared_input<reads_gap>{};
}
template <class Law, class Layout>
auto area_of(const double* areas, int i) {
  if constexpr ((Law::card.inputs & reads_area) != 0)
    return Layout::at(areas, i);
  else
    return undeclared_input<reads_area>{};
}
template <class Law>
const_history history_of(const node_block<Law>& b, int i) {
  if constexpr (has_history<Law>) return b.history_of(i);
  return {};
}
template <class Law>
vector earlier_of(const node_block<Law>& b, int i) {
  if constexpr (has_window<Law>) return {b.earlier[0][i], b.earlier[1][i], b.earlier[2][i]};
  return {};
}
template <class Law>
double refused_before(const node_block<Law>& b, int i) {
  if constexpr (has_window<Law>) return b.earlier_refused[i];
  return not_refused;
}
template <class Law, class Layout>
state_t<Law> incoming_state(const node_block<Law>& b, int i) {
  if constexpr (has_state<Law>)
    return state_at<Law, Layout>(b.state_in, i, std::make_index_sequence<state_doubles<Law>>{});
  else
    return {};
}

// A node as it comes in, in its local frame. A normal that is no unit vector makes v_free a defect.
template <class Law, class Delassus, class Frame, class Layout, scope Scope>
node_in<Law, Delassus, Frame> load_node(const node_block<Law>& b, int i) {
  const auto frame = Frame::template at<Layout>(b.axes, i);
  auto v_free = frame.to_local(Layout::get(b.v_free, i));
  if constexpr (!std::is_same_v<Frame, local_frame>) v_free.n += frame.unit_defect();
  node_in<Law, Delassus, Frame> n{.time = b.time,
                                  .velocity_step = b.velocity_step,
                                  .position_step = b.position_step,
                                  .v_free = v_free,
                                  .v_previous = previous_of<Law, Layout, Scope>(b, i, frame),
                                  .delassus = frame.to_local(delassus_at<Delassus, Layout>(
                                      b.delassus, i, std::make_index_sequence<Delassus::components>{})),
                                  .gap = gap_of<Law, Layout>(b, i),
                                  .area = area_of<Law, Layout>(b.area, i),
                                  .history = history_of(b, i),
                                  .earlier = earlier_of(b, i),
                                  .impulse = {},
                                  .state = {},
                                  .refused = refused_before(b, i)};
  // Assigned, not initialised: then GCC takes the struct apart, as vector code needs.
  if constexpr (has_state<Law>) n.state = incoming_state<Law, Layout>(b, i);
  return n;
}

template <class Law, scope Scope, class Node>
double input_defect(const Node& n, double found) {
  found = defect(n.v_free, n.delassus.positive_defect(found));
  if constexpr ((Law::card.inputs & reads_gap) != 0) found = defect(n.gap, found);
  if constexpr (reads_previous<Law> && Scope != scope::impulse) found = defect(n.v_previous, found);
  if constexpr ((Law::card.inputs & reads_area) != 0)
    found = defect(n.area, found) + defect_unless(n.area >= 0.0);
  return found;
}

// What a law may not give: a status that ilaw.h does not have, a pull or an impulse out of reach that its
// card does not announce; zero where it keeps to it. Who is out of reach is to be left alone while it is
// fresh, as nodes without a state always are.
// Without a comparison, which GCC would take into the choices of a step: a choice between truths does not
// vectorise. The product is zero at the statuses, and large where it is not.
inline double status_defect(double s) {
  static_assert(status::free == 0.0 && status::healed == 6.0);
  const double middle = s - 3.0, square = middle * middle;
  const double product = middle * (square - 1.0) * ((square - 4.0) * (square - 9.0));
  return defect(product * 0x1p1000 * 0x1p1000);
}
template <class Law>
inline constexpr bool may_pull = (Law::card.capabilities & ILAW_CAN_ADHERE) != 0;
template <class Law>
inline constexpr bool may_act_anywhere =
    (Law::card.capabilities & acts_at_distance) != 0 || has_history<Law> || has_state<Law> ||
    (Law::card.inputs & reads_gap) == 0;
template <class Law, class Node>
double pull_defect(const Node& n) {
  return may_pull<Law> ? 0.0 : absolute(n.impulse.n) - n.impulse.n;
}
inline double size_of(vector a) { return absolute(a.n) + (absolute(a.t1) + absolute(a.t2)); }
inline double size_of(projected_vector a) {
  return (absolute(a.n) + absolute(a.x)) + (absolute(a.y) + absolute(a.z));
}
template <class Vector>
double overflow_defect(Vector impulse, double guard, double found = 0.0) {
  return defect(guard * size_of(impulse), found);
}
template <class Node>
double distance_defect(const Node& n) {
  return kit::kept_if(is_out_of_reach(n), size_of(n.impulse));
}

// Steps one node, and says whether its input was good and its result one that a law may give and a double
// can hold.
template <class Law, class Delassus, class Frame, class Layout, scope Scope, class Step>
stepped<Law, Delassus, Frame> step_node(Step step, const node_block<Law>& b, int i) {
  // In place: a copy of a node is one that GCC may not take apart.
  stepped<Law, Delassus, Frame> s{load_node<Law, Delassus, Frame, Layout, Scope>(b, i), false};
  auto& n = s.result;
  const double before = incoming_state_defect<Law>(n.state), inputs = input_defect<Law, Scope>(n, 0.0);
  step(n);
  // In the host's axes a component may be as large as the whole vector: it must be a number there, too.
  const double found = overflow_defect(n.impulse, b.impulse_guard, inputs);
  // Of what there is: GCC keeps additions of zero.
  double given = status_defect(n.status);
  if constexpr (!may_pull<Law>) given += pull_defect<Law>(n);
  if constexpr (!may_act_anywhere<Law>) given += distance_defect(n);
  if constexpr (has_state<Law>) given += before + state_defect<Law>(n.state);
  // One comparison: of two, where refused was chosen, GCC makes branches, and no vector code.
  s.accepted = found + given == -n.refused;
  return s;
}

// Energy split of ilaw.h from the work of the impulse, -r.(v^- + v)/2 less what was stored of it, normal and
// tangential part apart. Where H couples them one may be negative, and is then taken off the other, so that
// both are dissipations and their sum stays the work.
struct energy_split {
  double friction, impact, rupture, stored;
};
template <class Node, class Vector>
energy_split split_energy(const Node& n, Vector v_previous, Vector v) {
  const Vector mean = v_previous + v;
  const double along_normal = -0.5 * normal_product(n.impulse, mean) - n.normal_gain;
  const double along_tangents = -0.5 * tangential_product(n.impulse, mean) - n.tangential_gain;
  const double normal = positive_part(along_normal + smaller(along_tangents, 0.0));
  const double tangential = positive_part(along_tangents + smaller(along_normal, 0.0));
  // Of a law that books its bond itself, the rest of a breaking step is friction and impact.
  const bool broken =
      (n.status == status::broken) & (n.normal_gain == 0.0) & (n.tangential_gain == 0.0) & (n.rupture == 0.0);
  return {broken ? 0.0 : tangential, broken ? 0.0 : normal, (broken ? normal + tangential : 0.0) + n.rupture,
          defect(n.stored) == 0.0 ? n.stored : infinity};  // its terms overflow
}

// A vector in the axes of the batch; where the node is refused, what the host is to find instead.
template <class Frame, class Layout>
axis outgoing(const double* const* axes, int i, typename Frame::vector_type a, bool accepted,
              axis otherwise) {
  const axis out = Frame::template at<Layout>(axes, i).to_global(a);
  return {accepted ? out.x : otherwise.x, accepted ? out.y : otherwise.y, accepted ? out.z : otherwise.z};
}

// The velocity before the step, of a node whose law may never read it.
template <class Law, class Frame, class Layout, class Node>
auto previous_for_energy(const node_block<Law>& b, int i, const Node& n) {
  if constexpr (reads_previous<Law>) {
    return n.v_previous;
  } else {
    const auto frame = Frame::template at<Layout>(b.axes, i);
    return zero_unless_finite(frame.to_local(columns::get(b.v_previous, i)));
  }
}

template <class Frame, class Layout, class Law, class Node>
void store_motion(const node_block<Law>& b, int i, const Node& n, bool accepted, axis v_free) {
  const auto v = n.v_free + n.delassus.times(n.impulse);
  Layout::put(b.velocity, i, outgoing<Frame, Layout>(b.axes, i, v, accepted, v_free));
  b.status[i] = accepted ? n.status : double{ILAW_BAD_INPUT};
}

template <class Frame, class Layout, class Law, class Node>
void store_energy(const node_block<Law>& b, int i, const Node& n, bool accepted) {
  const auto v = n.v_free + n.delassus.times(n.impulse);
  const energy_split e = split_energy(n, previous_for_energy<Law, Frame, Layout>(b, i, n), v);
  const bool known = accepted & (defect(columns::get(b.v_previous_of_energy, i)) == 0.0);
  b.energy[ILAW_ENERGY_FRICTION][i] = known ? e.friction : 0.0;
  b.energy[ILAW_ENERGY_IMPACT][i] = known ? e.impact : 0.0;
  b.energy[ILAW_ENERGY_RUPTURE][i] = known ? e.rupture : 0.0;
  b.energy[ILAW_ENERGY_STORED][i] = accepted ? e.stored : 0.0;
}

// Whether a form of a law works with its history in the step, node by node; one that forgets does not.
template <class Law, class Form>
inline constexpr bool remembers = has_history<Law> && !has_window<Law> && !requires {
  Form::forgets;
};

// Zero where the step left all as it was: a frame that moved on alone would make skipping such a node, which
// its host may do out of reach, another motion. Summed: comparisons of choices would become branches.
template <class Law, class Node>
double stirring(const Node& n, const state_t<Law>& before) {
  static_assert(status::free == 0.0);
  const double acts = absolute(n.impulse.n) + (absolute(n.impulse.t1) + absolute(n.impulse.t2)) + n.status;
  const double changes = kit::kept_if(!same_bits<Law>(n.state, before), 1.0);
  return acts + changes + kit::kept_if(!is_out_of_reach(n), 1.0);
}

template <class Law, class Node>
void keep_for_window(const node_block<Law>& b, int i, const Node& n) {
  b.given[0][i] = n.impulse.n;
  b.given[1][i] = n.impulse.t1;
  b.given[2][i] = n.impulse.t2;
  b.reached[i] = n.status;
}

// Steps and writes node i; valid: what the caller knows of its parameters.
template <class Law, class Delassus, class Frame, class Layout, scope Scope, class Form, class Step>
void run_node(const Form& law, const node_block<Law>& b, int i, Step step, bool valid = true) {
  auto [n, accepted] = step_node<Law, Delassus, Frame, Layout, Scope>(step, b, i);
  accepted = accepted & valid;
  const axis v_free = Layout::get(b.v_free, i);  // first: loads beneath a mask wait for what is being written
  Layout::put(b.impulse, i, kept_if(accepted, Frame::template at<Layout>(b.axes, i).to_global(n.impulse)));
  if constexpr (Scope >= scope::motion)  // six numbers of H leave no register for it
    store_motion<Frame, Layout>(b, i, n, accepted,
                                Delassus::components < 6 ? v_free : Layout::get(b.v_free, i));
  if constexpr (Scope == scope::outputs) store_energy<Frame, Layout>(b, i, n, accepted);
  if constexpr (has_window<Law> && !requires { Form::forgets; })
    keep_for_window(b, i, n);
  else if constexpr (remembers<Law, Form>)
    if (accepted) law.record(n, b.history_of(i));
  if constexpr (has_state<Law> || can_carry<Law, Frame>) {
    const state_t<Law> before = load_node<Law, Delassus, Frame, Layout, Scope>(b, i).state;
    if constexpr (can_carry<Law, Frame>) b.stirs[i] = stirring<Law>(n, before);
    if constexpr (has_state<Law>)
      store_state<Law, Layout>(b.state_out, i, n.state, before, accepted,
                               std::make_index_sequence<state_doubles<Law>>{});
  }
  b.refused[i] = accepted ? 0.0 : 1.0;
}

}  // namespace ilaw::kit::detail
