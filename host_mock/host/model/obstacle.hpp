// obstacle.hpp - rigid surfaces that nodes touch. They may move along, turn so that their shape stays, and
// planes may tilt.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/table.hpp"
#include "base/vector.hpp"

#include <optional>
#include <utility>

namespace ilaw::host {

// How something rigid moves: it stands still, at constant velocity, or along a piecewise-linear
// path.
class Motion {
 public:
  explicit Motion(Vector velocity) : velocity_(std::move(velocity)) {}
  explicit Motion(Table path) : path_(std::move(path)) {}

  Vector displacement(double time) const { return path_ ? path_->at(time) : time * velocity_; }
  // The mean velocity makes predicted gaps exact.
  Vector velocity(double from, double to) const {
    if (from == to) return Vector::Zero(displacement(to).size());  // it stands still
    if (!path_) return velocity_;
    return (displacement(to) - displacement(from)) / (to - from);
  }
  bool stands_still() const { return !path_ && velocity_.isZero(0.0); }

 private:
  Vector velocity_;
  std::optional<Table> path_;
};

// How fast a turning surface moves in a step, in parts of what SurfaceTurn has.
struct TurningRate {
  double along = 0.0, inward = 0.0;
};
// In the steps before and after a time.
struct TurningRates {
  TurningRate before, after;
};
// Velocities of a place at rate 1: around the axis, and that once more, which points at the axis.
struct SurfaceTurn {
  Vector along, inward;

  Vector at(TurningRate rate) const { return rate.along * along + rate.inward * inward; }
};

// How something rigid turns about an axis: at a constant rate, or through angles that are piecewise
// linear in time.
class Turning {
 public:
  Turning(const Eigen::Vector3d& axis, double rate) : axis_(axis.normalized()), rate_(rate) {}
  Turning(const Eigen::Vector3d& axis, Table angles) : axis_(axis.normalized()), angles_(std::move(angles)) {}

  // Mean, between two times.
  double rate(double from, double to) const {
    return angles_ ? (angles_->at(to)[0] - angles_->at(from)[0]) / (to - from) : rate_;
  }
  double angle(double time) const { return angles_ ? angles_->at(time)[0] : rate_ * time; }
  // A direction that is given for the angle 0, in 2D or 3D.
  Vector at_angle(const Vector& direction, double angle) const;
  // A direction in space, as it turns between two times.
  Vector turned(const Vector& direction, double from, double to) const;
  // Velocities at rate 1 of a point at `arm` from the axis; in 2D the axis is across the plane.
  SurfaceTurn unit_velocity(const Vector& arm) const;

 private:
  Eigen::Vector3d axis_;
  double rate_ = 0.0;
  std::optional<Table> angles_;
};

// A unit vector across another one: that of the coordinate least along it.
Vector across(const Vector& axis);

struct RigidSurface {
  double gap;     // signed distance, > 0 outside
  Vector normal;  // unit, from obstacle to body
};

// A plane, moved by a displacement.
struct FlatSurface {
  Vector displacement, point, normal;
};

// An obstacle at a time, to look at: a plane without radius, a sphere without direction, else a cylinder.
struct ObstacleShape {
  Vector point, direction;  // direction: normal or axis
  double radius = 0.0;
};

class Obstacle {
 public:
  explicit Obstacle(Motion motion, std::optional<Turning> turning = {})
      : motion_(std::move(motion)), turning_(std::move(turning)) {}
  virtual ~Obstacle() = default;
  Obstacle(const Obstacle&) = delete;
  Obstacle& operator=(const Obstacle&) = delete;

  RigidSurface at(const Vector& x, double time) const {
    return shape_at(x - motion_.displacement(time), time);
  }
  // Mean, between two times.
  Vector velocity(double from, double to) const { return motion_.velocity(from, to); }
  // Whether its surface moves along itself, beside that, and how fast; mean, between two times.
  bool turns() const { return turning_.has_value(); }
  TurningRates rates(double since, double time, double until) const {
    return {rate(since, time, -1.0), rate(time, until, 1.0)};
  }
  bool stands_still() const { return !turns() && motion_.stands_still(); }
  // Whether its normal turns, too. Then how fast it nears a place at most, between two times.
  virtual bool tilts() const { return false; }
  double tilting_speed(const Vector& x, double from, double to) const;
  // A direction in space, as it turns between two times; the same where nothing turns, or for a disc in 2D.
  Vector turned(const Vector& direction, double from, double to) const;
  // Velocities at rate 1 of the surface, at the place with that gap and normal.
  SurfaceTurn unit_velocity(const Vector& x, const RigidSurface& there, double time) const;
  // Whether the normal is the same everywhere.
  virtual bool is_flat() const { return false; }
  // Where it is flat.
  virtual std::optional<FlatSurface> flat_at(double /*time*/) const { return {}; }
  virtual ObstacleShape shape(double time) const = 0;
  // Whether it looks the same at all times.
  bool looks_the_same() const { return motion_.stands_still() && !tilts(); }

 protected:
  const Motion& motion() const { return motion_; }
  const std::optional<Turning>& turning() const { return turning_; }

 private:
  TurningRate rate(double from, double to, double side) const;
  // The obstacle at a time, without its displacement.
  virtual RigidSurface shape_at(const Vector& x, double time) const = 0;
  // A point of the axis that it turns about, at time 0.
  virtual const Vector& pivot() const = 0;

  Motion motion_;
  std::optional<Turning> turning_;
};

class Plane : public Obstacle {
 public:
  // Turns about its normal, or tilts about another axis; the normal is then that of the angle 0.
  Plane(Vector point, const Vector& normal, Motion motion, std::optional<Turning> turning = {},
        bool tilts = false);
  bool is_flat() const override { return true; }
  bool tilts() const override { return tilts_; }
  std::optional<FlatSurface> flat_at(double time) const override {
    return FlatSurface{motion().displacement(time), point_, normal_at(time)};
  }
  ObstacleShape shape(double time) const override {
    return {point_ + motion().displacement(time), normal_at(time)};
  }

 private:
  RigidSurface shape_at(const Vector& x, double time) const override;
  Vector normal_at(double time) const {
    return tilts_ ? turning()->at_angle(normal_, turning()->angle(time)) : normal_;
  }
  const Vector& pivot() const override { return point_; }
  Vector point_, normal_;
  bool tilts_;
};

// A sphere, which is a disc in 2D; with an axis an infinite cylinder, which turns about it.
class Round : public Obstacle {
 public:
  Round(Vector center, const std::optional<Vector>& axis, double radius, Motion motion,
        std::optional<Turning> turning = {});
  ObstacleShape shape(double time) const override {
    return {center_ + motion().displacement(time), axis_.value_or(Vector()), radius_};
  }

 private:
  RigidSurface shape_at(const Vector& x, double time) const override;
  const Vector& pivot() const override { return center_; }
  Vector center_;
  std::optional<Vector> axis_;
  double radius_;
};

}  // namespace ilaw::host
