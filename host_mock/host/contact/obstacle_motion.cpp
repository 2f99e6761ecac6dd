// SPDX-License-Identifier: BSD-3-Clause
#include "contact/obstacle_motion.hpp"

namespace ilaw::host {

ObstacleMotion::ObstacleMotion(const InterfaceSetup& setup, int dimension)
    : setup_(setup),
      velocity_(Vector::Zero(dimension)),
      velocity_before_(velocity_),
      tangent_(setup.tangent) {}

// An obstacle that stands still is asked once: a few virtual calls take as long as a law that has one node.
void ObstacleMotion::follow(const StepView& step) {
  if (is_known_) return;
  const Counterpart& counterpart = *setup_.counterpart;
  velocity_before_ = counterpart.velocity(step.since, step.time);
  velocity_ = counterpart.velocity(step.time, step.until);
  if (step.number == 0) velocity_before_ = velocity_;  // the start is no impact of the obstacle
  speed_before_ = velocity_before_.norm() + counterpart.tilting_speed(step.since, step.time, step.u);
  speed_ = velocity_.norm() + counterpart.tilting_speed(step.time, step.until, step.u);
  if (counterpart.turns()) rates_ = counterpart.rates({step.since, step.time, step.until});
  if (step.number == 0) rates_.before = rates_.after;
  flat_ = counterpart.flat_at(step.time);
  tangent_ = counterpart.turned(setup_.tangent, 0.0, step.time);
  is_known_ = counterpart.stands_still();
}

}  // namespace ilaw::host
