// obstacle_motion.hpp - how the obstacle of an interface moves in a step and in the one before.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "contact/interface_setup.hpp"

#include <optional>

namespace ilaw::host {

class ObstacleMotion {
 public:
  ObstacleMotion(const InterfaceSetup& setup, int dimension);

  void follow(const StepView& step);

  // Zero where the counterpart is no obstacle.
  const Vector& velocity() const { return velocity_; }
  const Vector& velocity_before() const { return velocity_before_; }
  // Bounds on how fast its surface nears a node.
  double speed() const { return speed_; }
  double speed_before() const { return speed_before_; }
  const TurningRates& rates() const { return rates_; }
  // The obstacle, where it is a plane; else null.
  const FlatSurface* flat() const { return flat_ ? &*flat_ : nullptr; }
  // First tangent of all nodes, turned with the obstacle; empty where none was given.
  const Vector& tangent() const { return tangent_; }

 private:
  double tilting_speed(double from, double to, const Dofs& u) const;

  const InterfaceSetup& setup_;
  Vector velocity_, velocity_before_, tangent_;
  double speed_ = 0.0, speed_before_ = 0.0;
  TurningRates rates_;
  std::optional<FlatSurface> flat_;
  bool is_known_ = false;  // it stands still, and all of it is above
};

}  // namespace ilaw::host
