// SPDX-License-Identifier: BSD-3-Clause
#include "model/obstacle.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace ilaw::host {
Vector across(const Vector& axis) {
  Eigen::Index least = 0;
  axis.cwiseAbs().minCoeff(&least);
  const Vector unit = Vector::Unit(axis.size(), least);
  return (unit - unit.dot(axis) * axis).normalized();
}

Vector Turning::at_angle(const Vector& direction, double angle) const {
  Eigen::Vector3d in_space = Eigen::Vector3d::Zero();
  in_space.head(direction.size()) = direction;
  return (Eigen::AngleAxisd(angle, axis_) * in_space).head(direction.size());
}

Vector Turning::turned(const Vector& direction, double from, double to) const {
  return at_angle(direction, angles_ ? angles_->at(to)[0] - angles_->at(from)[0] : rate_ * (to - from));
}

Vector Obstacle::turned(const Vector& direction, double from, double to) const {
  const bool turns_with_it = turning_ && (direction.size() == 3 || tilts());
  return turns_with_it ? turning_->turned(direction, from, to) : direction;
}

// |(x - p) . (n' - n)| is at most |x - p| times the angle.
double Obstacle::tilting_speed(const Vector& x, double from, double to) const {
  if (!tilts() || from == to) return 0.0;
  return std::abs(turning_->rate(from, to)) * std::max((x - motion_.displacement(from) - pivot()).norm(),
                                                       (x - motion_.displacement(to) - pivot()).norm());
}

SurfaceTurn Turning::unit_velocity(const Vector& arm) const {
  Eigen::Vector3d r = Eigen::Vector3d::Zero();
  r.head(arm.size()) = arm;
  const Eigen::Vector3d along = axis_.cross(r);
  return {along.head(arm.size()), axis_.cross(along).head(arm.size())};
}

// On a plane a point that is held goes round a circle: its way in a step is a chord, which leads to where the
// plane carries it. On a round surface that would lead below it.
TurningRate Obstacle::rate(double from, double to, double side) const {
  if (from == to) return {};  // it stands still
  const double rate = turning_->rate(from, to), dt = to - from, angle = rate * dt;
  if (!is_flat()) return {rate, 0.0};
  const double half = std::sin(0.5 * angle);
  return {std::sin(angle) / dt, side * 2.0 * half * half / dt};
}

SurfaceTurn Obstacle::unit_velocity(const Vector& x, const RigidSurface& there, double time) const {
  const Vector touched = x - there.gap * there.normal;
  return turning_->unit_velocity(touched - motion_.displacement(time) - pivot());
}

Plane::Plane(Vector point, const Vector& normal, Motion motion, std::optional<Turning> turning, bool tilts)
    : Obstacle(std::move(motion), std::move(turning)),
      point_(std::move(point)),
      normal_(normal.normalized()),
      tilts_(tilts) {}

RigidSurface Plane::shape_at(const Vector& x, double time) const {
  const Vector normal = normal_at(time);
  return {(x - point_).dot(normal), normal};
}

Round::Round(Vector center, const std::optional<Vector>& axis, double radius, Motion motion,
             std::optional<Turning> turning)
    : Obstacle(std::move(motion), std::move(turning)), center_(std::move(center)), radius_(radius) {
  if (axis) axis_ = axis->normalized();
}

// A point in the middle is pushed out along any direction.
RigidSurface Round::shape_at(const Vector& x, double /*time*/) const {
  Vector offset = x - center_;
  if (axis_) offset -= offset.dot(*axis_) * *axis_;
  const double distance = offset.norm();
  if (distance == 0.0) return {-radius_, axis_ ? across(*axis_) : Vector(Vector::Unit(x.size(), 0))};
  return {distance - radius_, offset / distance};
}

}  // namespace ilaw::host
