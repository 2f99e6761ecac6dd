// zone.hpp - the problem of one bonded node in one step. See cohesive.md for its derivation.
//
// The bond sees openings at half steps, the means of two positions: w^- before the impulse, w^+ after it. Its
// impulse is r = -h A k W (w^+ + w^-)/2. The unknown is the mean secant stiffness k, by way of the parts of
// the free motion that the bond takes and leaves, c k/(1 + c k) and 1/(1 + c k), c = h_pos h_vel A h_N/4.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "gathered.hpp"
#include "modes.hpp"
#include "root.hpp"
#include "softening.hpp"

namespace cohesive_law {
inline namespace ILAW_KIT_LEVEL {

using namespace ilaw::kit;

// The share at which an excess of the bond's stiffness over what its law gives changes from <= 0, for all
// left, to >= 0, for the stiffest.
template <class Excess>
share balance(share stiffest, Excess excess) {
  if (stiffest.taken <= 0.5 || excess(share{0.5, 0.5}) >= 0.0) {
    const double taken = sign_change(0.0, smaller(stiffest.taken, 0.5), [&](double t) {
      return excess(share{t, 1.0 - t});
    });
    return {taken, 1.0 - taken};
  }
  const double left = sign_change(stiffest.left, 0.5, [&](double l) { return -excess(share{1.0 - l, l}); });
  return {1.0 - left, left};
}

// What a share makes of the node.
struct motion {
  vector opening;     // w^+
  double size = 0.0;  // its effective length
  vector contact;     // impulse of contact and friction
  double refused = not_refused;
};

// What contact and friction see of a bonded node.
template <class Delassus>
struct pressed_node {
  Delassus delassus;
  vector impulse;
  double status, refused;
};

// What of a next position is below the ground and not rounding of it: a stiff bond would take the difference
// for an opening, and store what nobody has put in.
template <class V>
V below(V position, V ground) {
  return ground - 0x1p-49 * (absolute(position) + absolute(ground));
}

// The lowest next position: where the bond was made, or as deep as the node is. A node that was leaving turns
// round at most at the speed with which it left (see contact_leaving_at): else contact would do work on a
// bond, which may be so stiff that rounding is enough to store some.
template <class V>
[[gnu::always_inline]] inline V ground_below(V position, V v_previous, V position_step) {
  return smaller(smaller(position, V(0.0)), position - position_step * v_previous);
}

// Whether the bond has not been moved: then it is made in this step.
template <class V>
mask_of<V> is_made_now(const gathered<V>& g) {
  V moved = 0.0;
  for (int k = 0; k < 3; ++k) moved = moved + (absolute(g.position[k]) + absolute(g.opening[k]));
  return moved == 0.0;
}

// Where the bond is at the time of the impulse, and its ground, as if both steps were that of the velocity:
// so that the opening grows as the work does, whatever the steps and the axes of the step before. See
// cohesive.md.
template <class V>
[[gnu::always_inline]] inline void place_bond(const gathered<V>& g, mask_of<V> is_new, V (&place)[3],
                                              V& ground) {
  const V *p = g.position, *u = g.v_previous, step = g.velocity_step;
  for (int k = 0; k < 3; ++k) place[k] = select(is_new, p[k], g.opening[k] + 0.5 * step * u[k]);
  const auto uneven = step != g.position_step;
  const V from = select(uneven, p[0], place[0]);
  ground = ground_below(from, u[0], g.position_step);
  if (!any(uneven)) return;
  ground = select(uneven, place[0] + step / g.position_step * (ground - p[0]), ground);
}

// Where the node is next, where the steps differ: from its opening on by half a step of the position.
template <class V, class T>
T uneven_position(T opening, T place, const gathered<V>& g) {
  return opening + (g.position_step / g.velocity_step) * (opening - place);
}

template <class Modes>
struct zone {
  vector position, opening;  // relative position at the time of the impulse; w^-
  vector v_free, v_previous;
  double step;              // over which the opening grows with the velocity
  double weight;            // of tangential openings in the effective one
  double friction;          // coefficient, already reduced to the broken part
  double compliance_scale;  // c
  Modes modes;
  vector drive{};       // of w^+ + w^- without bond and contact, as a velocity
  double ground = 0.0;  // contact keeps the next position above it

  void place(vector where, double lowest) {
    position = where;
    ground = lowest;
    drive = 0.5 * v_free + (1.0 / step) * (where + opening);
  }

  // Opening along which work is done in each direction, as one number.
  double size(vector w) const { return length(w.n, weight * w.t1, weight * w.t2); }

  share of(secant<double> k) const {
    const double sum = k.soft + compliance_scale * k.stiff;
    return {compliance_scale * k.stiff / sum, k.soft / sum};
  }

  motion at(share s) const {
    motion m{.opening = step * modes.left(s, drive) - opening, .contact = {}};
    if (next_position(m).n < below(position.n, ground)) close(s, m);
    m.size = size(m.opening);
    return m;
  }

  vector next_position(const motion& m) const { return 2.0 * m.opening - position; }

  // Impulse of bond, contact and friction together.
  vector impulse(share s, const motion& m) const { return modes.impulse(s, drive, m.contact); }

 private:
  // Contact is pressed by what it takes from the bond as well, and what is broken of the bond rubs. Like
  // every contact it does no positive work.
  void close(share s, motion& m) const {
    const double target = (ground - position.n) / step;
    vector q = (2.0 / step) * (m.opening - position);
    q.n -= target;
    const vector rest{smaller(v_previous.n + target, 0.0), v_previous.t1, v_previous.t2};
    pressed_node<decltype(modes.delassus(s))> node{modes.delassus(s), {}, status::free, not_refused};
    apply_contact_friction(node, contact_problem<vector>{0.0, q, rest}, friction);
    // Where friction couples with the normal and would do work, that may leave no push at all.
    const double left = q.n + node.delassus.times(node.impulse).n;
    if (left < -0x1p-30 * absolute(q.n)) node.impulse = {-q.n / node.delassus.normal(), 0.0, 0.0};
    m.contact = node.impulse;
    m.refused = node.refused;
    m.opening = m.opening + (0.5 * step) * node.delassus.times(node.impulse);
    if (!Modes::along_axes || node.impulse.n == 0.0) return;
    m.opening.n = 0.5 * (position.n + ground);
    if (node.status != status::stick || friction == 0.0) return;
    m.opening.t1 = position.t1;
    m.opening.t2 = position.t2;
  }
};

// What the impulse of a bond that is made in this step works on v^-, against its sign. A node that is held
// has of v^- what rounding left, as at stopping_impulse.
template <class V>
V taken_from_before(const gathered<V>& g, const V (&opening)[3], V square_of_weight) {
  V along[3];
  for (int k = 0; k < 3; ++k) along[k] = velocity_before(g.v_previous[k], g.v_free[k]) * opening[k];
  return along[0] + square_of_weight * (along[1] + along[2]);
}

}  // namespace ILAW_KIT_LEVEL
}  // namespace cohesive_law
