// obstacle.hpp - rigid surfaces that nodes touch. They may move along, but do not turn.
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
    if (!path_) return velocity_;
    return (displacement(to) - displacement(from)) / (to - from);
  }

 private:
  Vector velocity_;
  std::optional<Table> path_;
};

struct RigidSurface {
  double gap;     // signed distance, > 0 outside
  Vector normal;  // unit, from obstacle to body
};

// A plane, moved by a displacement.
struct FlatSurface {
  Vector displacement, point, normal;
};

class Obstacle {
 public:
  explicit Obstacle(Motion motion) : motion_(std::move(motion)) {}
  virtual ~Obstacle() = default;
  Obstacle(const Obstacle&) = delete;
  Obstacle& operator=(const Obstacle&) = delete;

  RigidSurface at(const Vector& x, double time) const { return shape_at(x - motion_.displacement(time)); }
  // Mean, between two times.
  Vector velocity(double from, double to) const { return motion_.velocity(from, to); }
  // Whether the normal is the same everywhere.
  virtual bool is_flat() const { return false; }
  // Where it is flat.
  virtual std::optional<FlatSurface> flat_at(double /*time*/) const { return {}; }

 protected:
  const Motion& motion() const { return motion_; }

 private:
  // The obstacle where it is at time 0.
  virtual RigidSurface shape_at(const Vector& x) const = 0;

  Motion motion_;
};

class Plane : public Obstacle {
 public:
  Plane(Vector point, const Vector& normal, Motion motion);
  bool is_flat() const override { return true; }
  std::optional<FlatSurface> flat_at(double time) const override {
    return FlatSurface{motion().displacement(time), point_, normal_};
  }

 private:
  RigidSurface shape_at(const Vector& x) const override;
  Vector point_, normal_;
};

// A sphere in 3D, a disc in 2D.
class Sphere : public Obstacle {
 public:
  Sphere(Vector center, double radius, Motion motion);

 private:
  RigidSurface shape_at(const Vector& x) const override;
  Vector center_;
  double radius_;
};

// An infinite cylinder (3D).
class Cylinder : public Obstacle {
 public:
  Cylinder(Vector point, const Vector& axis, double radius, Motion motion);

 private:
  RigidSurface shape_at(const Vector& x) const override;
  Vector point_, axis_;
  double radius_;
};

}  // namespace ilaw::host
