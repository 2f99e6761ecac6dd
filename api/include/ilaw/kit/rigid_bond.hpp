// rigid_bond.hpp - the impulse of a bond without elasticity, which stops the node, and the contact that is
// left of it.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit/friction.hpp>

namespace ilaw::kit::inline ILAW_KIT_LEVEL {

// The part of v_free that rounding may leave: v_free + H r, which is 0, is the velocity before of a node that
// is held from step to step.
inline constexpr double left_by_rounding = 0x1p-48;
// v^- beyond that. The work r.v^-/2 that is left then grows from 0 as v^- does, with no jump.
template <class V>
ILAW_KIT_INLINE vector<V> velocity_before(vector<V> v_previous, vector<V> v_free) {
  return v_previous + V(left_by_rounding) * v_free;
}
template <class V>
ILAW_KIT_INLINE V product(vector<V> a, vector<V> b) {
  return normal_product(a, b) + tangential_product(a, b);
}

// The impulse that stops the node, r = -H^-1 v_free, less what would be positive work: only where the node
// turned round within the step.
template <class V, class Delassus>
ILAW_KIT_INLINE vector<V> stopping_impulse(const Delassus& h, vector<V> v_free, vector<V> v_previous) {
  vector<V> r = -h.solve(v_free);
  const vector<V> before = velocity_before(v_previous, v_free);
  if (any(product(r, before) > 0.0)) [[unlikely]] {
    friction_problem<V> problem;
    fill(problem, h, {0.0, v_free, before}, 0.0, 0.0);
    friction_answer<V> a{{r.n, r.t1, r.t2}, status::stick.code, 0.0};
    take_off_positive_work(problem, a);
    r = {a.r[0], a.r[1], a.r[2]};
  }
  return r;
}

// The largest part up to 1 of r that may join what is held, so that the work of both, which is
// (held + r).(motion + H (held + r))/2 with motion = v^- + v_free, is not positive; that of what is held
// alone counts as none.
template <class V, class Delassus>
ILAW_KIT_INLINE V joining_part(const Delassus& h, vector<V> motion, vector<V> held, vector<V> r) {
  const vector<V> of_held = h.times(held), moved = motion + of_held;
  const V c2 = product(r, h.times(r)), c1 = product(r, moved + of_held);
  const fraction<V> root = root_of_work(c2, c1, smaller(product(held, moved), V(0.0)));
  return select(root.numerator < root.denominator, root.numerator / root.denominator, 1.0);
}
// Neither the bond nor contact with friction does positive work, and yet both together may: friction is
// scaled first, as where there is no bond, and then contact with it, if that was not enough.
template <class Node, class V>
ILAW_KIT_INLINE vector<V> joined(const Node& node, vector<V> held, vector<V> r) {
  const vector<V> motion = node.v_previous + node.v_free, normal{r.n}, rubs{0.0, r.t1, r.t2};
  r = normal + joining_part(node.delassus, motion, held + normal, rubs) * rubs;
  return held + joining_part(node.delassus, motion, held, r) * r;
}

// Where a bond holds: as the host says, or within(), what the law says of its load.
template <class Node, class Mask, class Within>
ILAW_KIT_INLINE Mask bond_holds(const Node& node, Mask bonded, Within within) {
  if (node.of_bonds == bonds::hold) return bonded;
  if (node.of_bonds == bonds::break_all) return bonded & !bonded;
  return bonded & within();
}

// Contact where the gap is closed and nothing rebounds, for v_free as given.
template <class Node, class V>
ILAW_KIT_INLINE contact_problem<vector<V>> contact_without_bond(const Node& node, vector<V> v_free) {
  const contact_condition<V> condition = contact_leaving_at<V>(0.0, node.gap, v_free.n, node.v_previous.n);
  return contact_problem_of(condition, v_free, node.v_previous);
}

}  // namespace ilaw::kit
