// proximity_filter.hpp - which contacts may touch in the coming steps, so that the law leaves out
// the others.
//
// At a refresh, contacts with a gap bound of at most a horizon D are near. Since then nodes and
// obstacles have approached each other by no more than the sum of (step x largest closing speed),
// whatever happened to them, so that the gap of any other contact is still larger than D minus that
// sum. Within the next step it can close by no more than step x (largest closing speed while
// impulses are sought): where other contacts may make nodes faster, the coupled solve checks the
// bound it gave and repeats with a larger one. While the sum of both stays below D, a contact that
// is not near has gap > 0 and gap + h v_N > 0: a law that does not act at a distance gives it
// r = 0, and leaves the state it was initialised with (ilaw.h, ILAW_CAN_ACT_AT_DISTANCE).
// Evaluating it would change nothing, to the bit.
//
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <limits>

namespace ilaw::host {

// The least gap bound of some nodes that were all far, and the way (below) when it was taken.
struct FarNodes {
  double gap_bound = -std::numeric_limits<double>::infinity(), way = 0.0;
};

class ProximityFilter {
 public:
  // Whether the near contacts must be found anew. Speeds bound the closing speeds of the step that
  // led here and of the coming one.
  bool refresh_due(double dt, double speed_before, double speed_after) {
    approached_ += rounding * dt * speed_before;
    way_ += rounding * dt * speed_before;
    const double ahead = rounding * dt * speed_after;
    if (valid_ && approached_ + ahead < horizon_) return false;
    approached_ = 0.0;
    horizon_ = std::max(steps_ahead * dt * speed_before, 2.0 * ahead);  // never shorter than the step itself
    valid_ = true;
    return true;
  }
  // An upper bound of a distance that is computed in a few operations.
  static double rounded_up(double distance) { return rounding * distance; }
  // Whether a contact may touch before the next refresh.
  bool may_touch(double gap_bound) const { return !(gap_bound > horizon_); }
  // How far nodes and counterpart have approached since the start, at most. Half of a bound is kept
  // for the rounding of long sums.
  double way() const { return way_; }
  bool may_touch(const FarNodes& nodes) const {
    return !(nodes.gap_bound > 2.0 * (way_ - nodes.way + horizon_));
  }
  // The next step needs a refresh, whatever moved.
  void invalidate() { valid_ = false; }

 private:
  static constexpr double steps_ahead = 16.0;
  static constexpr double rounding = 1.0 + 1e-9;  // sums and gaps are rounded: a bound must not be

  bool valid_ = false;
  double approached_ = 0.0, horizon_ = 0.0, way_ = 0.0;
};

}  // namespace ilaw::host
