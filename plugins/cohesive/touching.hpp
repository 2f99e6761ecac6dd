// touching.hpp - what is left of a bond at a node whose H is diag(h_N, h_T, h_T), or at a pack of them:
// contact and friction, with the bits of coulomb. The equations are those of ilaw/kit/friction.hpp.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "gathered.hpp"

namespace cohesive_law {
inline namespace ILAW_KIT_LEVEL {

// Of power_scale_of in ilaw/kit/math.hpp.
template <class V>
struct scale_of {
  V down, up;

  explicit scale_of(V largest) {
    using bits = detail::bits_of<V>;
    constexpr std::uint64_t exponent_bits = 0x7FF0000000000000;
    const auto exponent =
        bits::in(larger(largest, V(std::numeric_limits<double>::min()))) & bits::of(exponent_bits);
    down = bits::number(bits::of(exponent_bits) - exponent);
    up = bits::number(exponent);
  }
};
template <class V>
V length_of(V a, V b) {
  const scale_of<V> scale(larger(absolute(a), absolute(b)));
  a = a * scale.down;
  b = b * scale.down;
  return 0.5 * square_root(a * a + b * b) * scale.up;
}

// A pressed node with tangential velocity q without friction, and v_previous, whose contact takes the normal
// velocity rest_n: friction gives it -factor q. See rub and stopping_part.
template <class V>
struct rubbing {
  V factor;
  mask_of<V> moves;
};
template <class V>
rubbing<V> rub(V h_t, V normal, V q1, V q2, V rest_n, const V* v_previous, V friction) {
  const V speed = length_of(q1, q2), down = scale_of<V>(speed).down;
  const V along = (down * q1) * (down * v_previous[1]) + (down * q2) * (down * v_previous[2]);
  const V square = (down * speed) * (down * speed), impact = h_t * (down * normal) * (down * rest_n);
  const fraction<V> root = root_of_work(square, -(square + along), impact);
  const auto gains = along < impact, far = root.under == infinity;
  const V over = select(gains, select(far, 0.0, root.over), 1.0),
          under = select(gains & !far, root.under, 1.0);
  const V limit = select(normal > 0.0, friction * normal, 0.0), stop = h_t * under;
  const auto slips = speed * over > limit * stop;
  const V factor = select(slips, limit, over) / select(slips, speed, stop);
  const mask_of<V> moves = slips | (over < sticking_part * under);
  return {factor, moves};
}

template <class V>
void touch_in_packs(const gathered<V>& g, double friction, mask_of<V> where, solved<V>& a) {
  const V *v = g.v_free, *u = g.v_previous;
  const V target = -positive_part(g.gap) * (1.0 / g.position_step);
  const V excess = larger(v[0] - target, v[0] + u[0]), rest_n = smaller(u[0] + target, 0.0);
  const V normal = positive_part(-excess / g.h[0]);
  const rubbing<V> found = rub(g.h[1], normal, v[1], v[2], rest_n, u, V(friction));
  const V closed = select(found.moves, V(status::slip), V(status::stick));
  const V impulse[] = {normal, -found.factor * v[1], -found.factor * v[2]};
  leave_bond(g, impulse, select(normal > 0.0, closed, V(status::free)), where, a);
}

}  // namespace ILAW_KIT_LEVEL
}  // namespace cohesive_law
