// refusal.hpp - why a node was refused, in words.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit/detail/run_block.hpp>

#include <string>

namespace ilaw::kit::inline ILAW_KIT_LEVEL::detail {

// "state variable '...' is not what the law can have written", as static text.
template <class Law, std::size_t V>
struct range_reason {
  static constexpr auto make() {
    constexpr const char *head = "state variable '", *name = Law::state_variables[V].name,
                         *tail = "' has a value that the law cannot have written";
    constexpr auto size = [](const char* s) { return std::char_traits<char>::length(s); };
    std::array<char, size(head) + size(name) + size(tail) + 1> made{};
    std::size_t at = 0;
    for (const char* part : {head, name, tail})
      for (; *part; ++part) made[at++] = *part;
    return made;
  }
  static constexpr auto text = make();
};

// The first state variable that is not what it may be; null where all are.
template <class Law, std::size_t V = 0>
const char* out_of_range(const state_t<Law>& state) {
  if constexpr (has_state<Law>)
    if constexpr (V < std::size(Law::state_variables)) {
      constexpr const auto& v = Law::state_variables[V];
      const auto doubles = std::bit_cast<std::array<double, state_doubles<Law>>>(state);
      if (v.has_range() && !v.may_be(doubles[state_places<Law>[V]])) return range_reason<Law, V>::text.data();
      return out_of_range<Law, V + 1>(state);
    }
  return nullptr;
}

// Whether a number of an impulse is none, without another that has overflowed.
inline bool is_not_a_number(vector r) {
  const double sum = absolute(r.n) + absolute(r.t1) + absolute(r.t2);
  return sum != sum && absolute(r.n) != infinity && absolute(r.t1) != infinity && absolute(r.t2) != infinity;
}
inline bool is_not_a_number(projected_vector r) {
  const double tangential = absolute(r.x) + absolute(r.y) + absolute(r.z);
  return is_not_a_number(vector{r.n, tangential, 0.0});
}

// What is wrong with what a step gave.
template <class Law, class Node>
const char* result_reason(const Node& n, double impulse_guard) {
  if (n.refused == several_solutions)
    return "the law's equations have several solutions for this H and step: a smaller step is needed";
  if (n.refused == no_solution) return "the law's equations have no solution for this H";
  if (n.refused == impossible_state) return "the state is not one that the law can have written";
  if (n.refused == time_before_history) return "the time lies before what the state remembers";
  if (is_not_a_number(n.impulse)) return "the law gave an impulse that is not a number";
  if (overflow_defect(n.impulse, impulse_guard) + state_defect<Law>(n.state) != 0.0)
    return "the impulse or the state overflows";
  if (status_defect(n.status) != 0.0) return "the law gave a status that ilaw.h does not have";
  if (pull_defect<Law>(n) != 0.0) return "the law pulled, which needs ILAW_CAN_ADHERE in its card";
  return "the law acted out of reach, which needs acts_at_distance in its card";
}

// Why a node was refused, from the same checks as step_node, in their order.
template <class Law, class Delassus, class Frame, class Layout, scope Scope>
const char* refusal_reason(const Law& law, const block_of_one<Law>& b, int i, bool has_tangent) {
  const auto n = load_node<Law, Delassus, Frame, Layout, Scope>(b, i);
  if (defect(Frame::template at<Layout>(b.axes, i).unit_defect()) != 0.0)
    return "the normal is not a unit vector";
  bool framed = true;
  if constexpr (std::is_same_v<Frame, stored_frame>) framed = defect(columns::get(b.axes + 6, i)) == 0.0;
  if (!framed && has_tangent) return "the tangent is not a unit vector orthogonal to the normal";
  if (framed && defect(n.v_free) != 0.0) return "v_free is not finite";
  if (framed && n.delassus.positive_defect() != 0.0) return "H is not finite and positive definite";
  if constexpr ((Law::card.inputs & reads_gap) != 0)
    if (defect(n.gap) != 0.0) return "the gap is not finite";
  if constexpr (reads_previous<Law>)
    if (framed && defect(n.v_previous) != 0.0) return "v_previous is not finite";
  if constexpr ((Law::card.inputs & reads_area) != 0)
    if (!is_finite(n.area) || n.area < 0.0) return "the area is not a finite number >= 0";
  if (!framed) return "the state holds no frame: it is not one that the law can have written";
  if (state_defect<Law>(n.state) != 0.0) return "the state is not finite";
  if (const char* wrong = out_of_range<Law>(n.state)) return wrong;
  const auto stepped = step_node<Law, Delassus, Frame, Layout, Scope>(stepping_alone(law), b, i).result;
  return result_reason<Law>(stepped, b.impulse_guard);
}

}  // namespace ilaw::kit::detail
