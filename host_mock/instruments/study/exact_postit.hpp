// exact_postit.hpp - a point on a plane under the Post-it law, solved from one event to the next.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "study/exact.hpp"

#include <vector>

namespace ilaw::host {

// In one dimension, from rest on the plane, moved by a force that never pushes and by shocks of
// either sign. Rupture is brittle.
struct PostitPoint {
  struct Knot {
    double time, force;  // linear between knots, constant outside
  };
  struct Shock {
    double time, impulse;
  };
  double mass;
  std::vector<Knot> knots;    // at least one, in the order of time
  std::vector<Shock> shocks;  // in the order of time
  double initial_adhesion, adhesion_limit, efficiency_decrease, memory;
  double end;
};

ExactNode postit_motion(const PostitPoint& point);

}  // namespace ilaw::host
