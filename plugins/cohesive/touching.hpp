// touching.hpp - what is left of a bond at a node whose H is diag(h_N, h_T, h_T), or at a pack of them:
// contact and friction, with the bits of coulomb.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "gathered.hpp"

namespace cohesive_law {
inline namespace ILAW_KIT_LEVEL {

// Friction of a node without bond whose slip is q and whose contact takes the normal velocity rest_n.
template <class V>
rubbing_factor<V> rub_from(V h_t, V normal, V q1, V q2, V rest_n, const V* v_previous, V friction) {
  const scaled_length<V> speed = scaled_length_of(q1, q2);
  const V down = speed.down;
  const V along = (down * q1) * (down * v_previous[1]) + (down * q2) * (down * v_previous[2]);
  return rub(h_t, normal, speed.length(), stopping_part(h_t, normal, speed, along, rest_n), friction);
}

template <class V>
void touch_in_packs(const gathered<V>& g, double friction, mask_of<V> where, solved<V>& a) {
  const V *v = g.v_free, *u = g.v_previous;
  const V target = -positive_part(g.gap) * (1.0 / g.position_step);
  const V excess = larger(v[0] - target, v[0] + u[0]), rest_n = smaller(u[0] + target, 0.0);
  const V normal = positive_part(-excess / g.h[0]);
  const rubbing_factor<V> found = rub_from(g.h[1], normal, v[1], v[2], rest_n, u, V(friction));
  const V impulse[] = {normal, -found.factor * v[1], -found.factor * v[2]};
  leave_bond(g, impulse, select(normal > 0.0, found.status, V(status::free)), where, a);
}

}  // namespace ILAW_KIT_LEVEL
}  // namespace cohesive_law
