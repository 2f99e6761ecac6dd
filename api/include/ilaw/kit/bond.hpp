// bond.hpp - what laws with bonds share: the impulse that stops a node, and the contact that is left of a
// bond.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit/friction.hpp>

namespace ilaw::kit::inline ILAW_KIT_LEVEL {

// The impulse that stops the node, r = -H^-1 v_free, and its work: as it is, and without positive work, all
// of it unless the node was moving before, and turned round within the step.
template <class Node>
vector whole_stopping_impulse(const Node& node) {
  return -node.delassus.solve(node.v_free);
}
// The part of v_free that may be left of it by rounding: v_free + H r, which is 0, is the velocity before of
// a node that is held from step to step.
inline constexpr double left_by_rounding = 0x1p-48;
// v^- beyond that, and twice the work r.v^- that is left then: it grows from 0 as v^- does, with no jump.
template <class V>
V velocity_before(V v_previous, V v_free) {
  return v_previous + left_by_rounding * v_free;
}
template <class Node>
double doubled_work(const Node& node, vector r) {
  const vector before = velocity_before(node.v_previous, node.v_free);
  return normal_product(r, before) + tangential_product(r, before);
}
template <class Node>
vector stopping_impulse(const Node& node) {
  const vector r = whole_stopping_impulse(node);
  friction_answer<double> answer{{r.n, r.t1, r.t2}, status::stick, not_refused};
  friction_problem<double> problem;
  fill(problem, node.delassus, {0.0, node.v_free, velocity_before(node.v_previous, node.v_free)}, 0.0, 0.0);
  take_off_positive_work(problem, answer);
  return {answer.r[0], answer.r[1], answer.r[2]};
}

// Contact and friction where the gap is closed and nothing rebounds: what is left of a bond.
template <class Node, class Vector>
contact_problem<Vector> plain_contact(const Node& node, Vector v_free) {
  const contact_condition condition = contact_leaving_at(0.0, node.gap, v_free.n, node.v_previous.n);
  return contact_problem_of(condition, v_free, node.v_previous);
}
template <class Node, class Vector>
void apply_plain_contact(Node& node, Vector v_free, double friction) {
  apply_contact_friction(node, plain_contact(node, v_free), friction);
}

}  // namespace ilaw::kit
