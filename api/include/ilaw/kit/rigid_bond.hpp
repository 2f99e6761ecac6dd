// rigid_bond.hpp - the impulse of a bond without elasticity, which stops the node, and the contact that is
// left of it.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit/friction.hpp>

namespace ilaw::kit::inline ILAW_KIT_LEVEL {

// The part of v_free that rounding may leave of it: v_free + H r, which is 0, is the velocity before of a
// node that is held from step to step.
inline constexpr double left_by_rounding = 0x1p-48;
// v^- beyond that. The work r.v^-/2 that is left then grows from 0 as v^- does, with no jump.
template <class Vector>
ILAW_KIT_INLINE Vector velocity_before(Vector v_previous, Vector v_free) {
  return v_previous + left_by_rounding * v_free;
}

// r = -H^-1 v_free, which stops the node, without positive work: all of it unless the node was moving before
// and turned round within the step.
template <class Node>
ILAW_KIT_INLINE auto stopping_impulse(const Node& node) {
  using V = number_of<Node>;
  vector<V> r = -node.delassus.solve(node.v_free);
  const vector<V> before = velocity_before(node.v_previous, node.v_free);
  if (any(normal_product(r, before) + tangential_product(r, before) > 0.0)) [[unlikely]] {
    friction_answer<V> answer{{r.n, r.t1, r.t2}, V(status::stick.code), 0.0};
    friction_problem<V> problem;
    fill(problem, node.delassus, {0.0, node.v_free, before}, 0.0, 0.0);
    take_off_positive_work(problem, answer);
    r = {answer.r[0], answer.r[1], answer.r[2]};
  }
  return r;
}

// Contact where the gap is closed and nothing rebounds, for v_free as given.
template <class Node, class V>
ILAW_KIT_INLINE contact_problem<vector<V>> contact_without_bond(const Node& node, vector<V> v_free) {
  const contact_condition<V> condition = contact_leaving_at<V>(0.0, node.gap, v_free.n, node.v_previous.n);
  return contact_problem_of(condition, v_free, node.v_previous);
}

}  // namespace ilaw::kit
