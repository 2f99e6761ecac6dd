// touching.hpp - nodes without an equation of a bond: what stops them, and, at a node whose H is diag(h_N,
// h_T, h_T), or a pack of them, what is left of a bond: contact and friction, with the bits of coulomb.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "gathered.hpp"

namespace cohesive_law {
inline namespace ILAW_KIT_LEVEL {

// H^-1 v_free, and what it takes off v^-, times a scale: with a transverse H without a division, which who
// only asks can do without.
struct stopped_bond {
  double scale = 1.0;
  vector pull;
  double work;

  template <class Node>
  explicit stopped_bond(const Node& node) {
    if constexpr (has_transverse_delassus<Node>) {
      const double n = node.delassus.normal(), t = node.delassus.tangential();
      scale = n * t;
      pull = {t * node.v_free.n, n * node.v_free.t1, n * node.v_free.t2};
    } else {
      pull = node.delassus.solve(node.v_free);
    }
    work = -doubled_work(node, -pull);
  }
};

// stopping_impulse for a transverse H.
template <class V>
friction_answer<V> stopping(const gathered<V>& p) {
  friction_problem<V> stop{};
  friction_answer<V> a{};
  for (int k = 0; k < 3; ++k) {
    stop.contact.h[k] = p.h[k];
    stop.contact.q[k] = p.v_free[k];
    stop.rest[k] = velocity_before(p.v_previous[k], p.v_free[k]);
    a.r[k] = -(p.v_free[k] / p.h[k]);
  }
  a.status = status::stick;
  take_off_positive_work(stop, a);
  return a;
}

template <class V>
void touch_in_packs(const gathered<V>& g, double friction, mask_of<V> where, solved<V>& a) {
  const V *v = g.v_free, *u = g.v_previous;
  const V target = -positive_part(g.gap) * (1.0 / g.position_step);
  const V excess = larger(v[0] - target, v[0] + u[0]), rest_n = smaller(u[0] + target, 0.0);
  const V normal = positive_part(-excess / g.h[0]);
  const V rest[] = {rest_n, u[1], u[2]};
  const rubbing_factor<V> found = rub_from(g.h[1], normal, v, rest, V(friction));
  const V impulse[] = {normal, 0.0 - found.factor * v[1], 0.0 - found.factor * v[2]};
  leave_bond(g, impulse, select(normal > 0.0, found.status, V(status::free)), where, a);
}

}  // namespace ILAW_KIT_LEVEL
}  // namespace cohesive_law
