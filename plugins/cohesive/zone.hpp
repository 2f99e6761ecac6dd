// zone.hpp - the problem of one bonded node in one step. See cohesive.md for its derivation.
//
// The bond sees openings at half steps, the means of two positions: w^- before the impulse, w^+ after it. Its
// impulse is r = -h A k (w^+ + w^-)/2. The unknown is the mean secant stiffness k, by way of the parts of the
// free motion that the bond takes and leaves, c k/(1 + c k) and 1/(1 + c k), c = h_pos h_vel A h_N/4.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "root.hpp"
#include "softening.hpp"

namespace cohesive_law {
inline namespace ILAW_KIT_LEVEL {

using namespace ilaw::kit;

// Parts of the free motion; their sum is 1. Both are kept, since either may be tiny.
struct share {
  double taken, left;  // rigid: 1 and 0, broken: 0 and 1

  double stiffness() const { return taken / left; }  // c k
};

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
  vector opening;   // w^+
  double size;      // its effective length
  vector friction;  // impulse; normal part: of the contact
};

struct zone {
  vector position, opening;  // relative position at the time of the impulse; w^-
  vector v_free;
  double normal_delassus, tangential_delassus, position_step;
  double weight;            // of tangential openings in the effective one
  double friction;          // coefficient, already reduced to the broken part
  double compliance_scale;  // c
  vector drive;             // of w^+ + w^- without bond and contact, as a velocity
  double ratio;             // of tangential to normal compliance

  // Opening along which work is done in each direction, as one number.
  double size(vector w) const { return length(w.n, weight * w.t1, weight * w.t2); }

  share of(secant k) const {
    const double sum = k.soft + compliance_scale * k.stiff;
    return {compliance_scale * k.stiff / sum, k.soft / sum};
  }
  // The same bond as the tangential motion feels it.
  share tangential(share s) const {
    const double sum = s.left + ratio * s.taken;
    return {ratio * s.taken / sum, s.left / sum};
  }

  // Mean traction that stops the motion: what a rigid bond bears.
  vector rigid_traction() const {
    const double scale = 0.5 * position_step / compliance_scale;
    const double tangential_scale = scale * normal_delassus / tangential_delassus;
    return {scale * drive.n, tangential_scale * drive.t1, tangential_scale * drive.t2};
  }

  motion at(share s) const {
    const double left = tangential(s).left;
    const vector d = position_step * drive;
    motion m{{s.left * d.n - opening.n, left * d.t1 - opening.t1, left * d.t2 - opening.t2}, 0.0, {}};
    if (next_position(m).n < 0.0) close(s, left, m);
    m.size = size(m.opening);
    return m;
  }

  vector next_position(const motion& m) const { return 2.0 * m.opening - position; }

  // Impulse of bond, contact and friction together.
  vector impulse(share s, const motion& m) const {
    const share t = tangential(s);
    const double normal =
        m.friction.n > 0.0 ? -arrival() / normal_delassus : -2.0 * s.taken * drive.n / normal_delassus;
    return {normal, t.left * m.friction.t1 - 2.0 * t.taken * drive.t1 / tangential_delassus,
            t.left * m.friction.t2 - 2.0 * t.taken * drive.t2 / tangential_delassus};
  }

 private:
  // Velocity to be taken off where contact closes at the end of the step.
  double arrival() const { return v_free.n + position.n / position_step; }

  // Contact keeps the position from being negative; it is then pressed by what it takes from the bond as
  // well, and what is broken of the bond rubs.
  void close(share s, double left, motion& m) const {
    m.opening.n = 0.5 * position.n;
    const double sum = m.opening.n + opening.n;
    const double pull = sum > 0.0 ? 2.0 * s.stiffness() * sum / position_step : 0.0;
    m.friction.n = positive_part((pull - arrival()) / normal_delassus);
    const double limit = friction_limit(friction, m.friction.n);
    if (limit > 0.0) rub(limit, left * tangential_delassus, m);
  }

  void rub(double limit, double compliance, motion& m) const {
    const double rate = 2.0 / position_step;
    const double u1 = rate * (m.opening.t1 - position.t1), u2 = rate * (m.opening.t2 - position.t2);
    const double speed = length(u1, u2);
    const bool slips = speed > limit * compliance;
    const double factor = (slips ? limit : 1.0) / (slips ? speed : compliance);
    m.friction.t1 = -factor * u1;
    m.friction.t2 = -factor * u2;
    const double reach = 0.5 * position_step * compliance;
    m.opening.t1 = slips ? m.opening.t1 + reach * m.friction.t1 : position.t1;
    m.opening.t2 = slips ? m.opening.t2 + reach * m.friction.t2 : position.t2;
  }
};

}  // namespace ILAW_KIT_LEVEL
}  // namespace cohesive_law
