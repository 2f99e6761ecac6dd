// SPDX-License-Identifier: BSD-3-Clause
#include "contact/obstacle_motion.hpp"

#include <algorithm>

namespace ilaw::host {

ObstacleMotion::ObstacleMotion(const InterfaceSetup& setup, int dimension)
    : setup_(setup),
      velocity_(Vector::Zero(dimension)),
      velocity_before_(velocity_),
      tangent_(setup.tangent) {}

// How fast a plane that tilts nears any of the nodes at most, between two times, beside its velocity.
double ObstacleMotion::tilting_speed(double from, double to, const Dofs& u) const {
  const Counterpart& counterpart = *setup_.counterpart;
  double fastest = 0.0;
  for (std::size_t k = 0; counterpart.obstacle()->tilts() && k < setup_.nodes.size(); ++k)
    fastest = std::max(fastest, counterpart.obstacle()->tilting_speed(
                                    counterpart.position(static_cast<int>(k), u), from, to));
  return fastest;
}

// An obstacle that stands still is asked once: a few virtual calls take as long as a law that has one node.
void ObstacleMotion::follow(const StepView& step) {
  const Obstacle* const obstacle = setup_.counterpart->obstacle();
  if (!obstacle || is_known_) return;
  velocity_before_ = obstacle->velocity(step.since, step.time);
  velocity_ = obstacle->velocity(step.time, step.until);
  if (step.number == 0) velocity_before_ = velocity_;  // the start is no impact of the obstacle
  speed_before_ = velocity_before_.norm() + tilting_speed(step.since, step.time, step.u);
  speed_ = velocity_.norm() + tilting_speed(step.time, step.until, step.u);
  if (obstacle->turns()) rates_ = obstacle->rates(step.since, step.time, step.until);
  if (step.number == 0) rates_.before = rates_.after;
  flat_ = obstacle->flat_at(step.time);
  tangent_ = obstacle->turned(setup_.tangent, 0.0, step.time);
  is_known_ = obstacle->stands_still();
}

}  // namespace ilaw::host
