// zone.hpp - the problem of one bonded node in one step. See cohesive.md for its derivation.
//
// With jump^- and jump the openings one step before and at the time of the impulse, and jump^+ the one that
// the step makes, the bond's impulse is r = -h A k (jump^+ + jump^-)/2. Its unknown is the mean secant
// stiffness k, by way of share in [0, 1], the part of the free motion that the bond takes away:
// share = c k/(1 + c k), c = h_pos h_vel A h_N/2. A rigid bond is share = 1, a broken one share = 0.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "root.hpp"
#include "softening.hpp"

namespace cohesive_law {
inline namespace ILAW_KIT_LEVEL {

using namespace ilaw::kit;

// Openings of a node, tangential parts multiplied by their weight where an effective opening is asked for.
inline double effective(vector jump, double weight) {
  return length(jump.n, weight * jump.t1, weight * jump.t2);
}

// What a share makes of the node.
struct motion {
  vector jump;      // at the end of the step
  vector friction;  // impulse; normal part: of the contact
  double size;      // effective opening
};

struct zone {
  vector before, now;  // openings one step before, and at the time of the impulse
  vector v_free;
  double normal_delassus, tangential_delassus, position_step;
  double weight;            // of tangential openings in the effective one
  double friction;          // coefficient, already reduced to the broken part
  double compliance_scale;  // c

  double stiffness_ratio() const { return weight * weight * tangential_delassus / normal_delassus; }
  double tangential_share(double share) const {
    const double q = stiffness_ratio();
    return q * share / ((1.0 - share) + q * share);
  }
  // Free velocity of the mean opening: what the bond acts against.
  vector drive() const { return v_free + (1.0 / position_step) * (now + before); }

  motion at(double share) const {
    const vector w = drive();
    const double normal = position_step * (1.0 - share) * w.n - before.n;
    const double kept = 1.0 - tangential_share(share);
    motion result{{positive_part(normal), position_step * kept * w.t1 - before.t1,
                   position_step * kept * w.t2 - before.t2},
                  {},
                  0.0};
    if (normal < 0.0) close(share, kept, result);
    result.size = effective(result.jump, weight);
    return result;
  }

  // Impulse of bond and contact together that makes this motion.
  vector impulse(double share, const motion& m) const {
    const double tangential = tangential_share(share);
    const vector w = drive();
    const double normal = m.jump.n > 0.0 || m.friction.n == 0.0
                              ? -share * w.n / normal_delassus
                              : -(v_free.n + now.n / position_step) / normal_delassus;
    return {normal, (1.0 - tangential) * m.friction.t1 - tangential * w.t1 / tangential_delassus,
            (1.0 - tangential) * m.friction.t2 - tangential * w.t2 / tangential_delassus};
  }

 private:
  // Contact keeps the opening from being negative; it is then pressed by what it takes from the bond as well,
  // and what is broken of the bond rubs.
  void close(double share, double kept, motion& m) const {
    const double bond = before.n > 0.0 ? share / (1.0 - share) * before.n / position_step : 0.0;
    m.friction.n = positive_part((bond - v_free.n - now.n / position_step) / normal_delassus);
    const double limit = friction_limit(friction, m.friction.n);
    if (!(limit > 0.0)) return;
    const double rate = 1.0 / position_step, compliance = kept * tangential_delassus;
    const double u1 = rate * (m.jump.t1 - now.t1), u2 = rate * (m.jump.t2 - now.t2), speed = length(u1, u2);
    const bool slips = speed > limit * compliance;
    const double factor = (slips ? limit : 1.0) / (slips ? speed : compliance);
    m.friction.t1 = -factor * u1;
    m.friction.t2 = -factor * u2;
    m.jump.t1 = slips ? m.jump.t1 + position_step * compliance * m.friction.t1 : now.t1;
    m.jump.t2 = slips ? m.jump.t2 + position_step * compliance * m.friction.t2 : now.t2;
  }
};

}  // namespace ILAW_KIT_LEVEL
}  // namespace cohesive_law
