// obstacle.hpp - rigid surfaces that interfaces meet.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "table.hpp"

#include <Eigen/Core>

#include <optional>

namespace ilaw::host {

using Point = Eigen::Ref<const Eigen::VectorXd>;

class Obstacle {
 public:
  virtual ~Obstacle() = default;
  virtual double gap(const Point& x, double time) const = 0;              // signed distance, > 0 outside
  virtual Eigen::VectorXd normal(const Point& x, double time) const = 0;  // unit, from obstacle to body
  virtual Eigen::VectorXd velocity(double from, double to) const = 0;     // mean, between two times
};

// How an obstacle moves: it stands still, at constant velocity, or along a piecewise-linear path.
class Motion {
 public:
  explicit Motion(Eigen::VectorXd velocity) : velocity_(std::move(velocity)) {}
  explicit Motion(Table path) : path_(std::move(path)) {}

  Eigen::VectorXd displacement(double time) const { return path_ ? path_->at(time) : time * velocity_; }
  // The mean velocity makes predicted gaps exact.
  Eigen::VectorXd velocity(double from, double to) const {
    if (!path_) return velocity_;
    return (displacement(to) - displacement(from)) / (to - from);
  }

 private:
  Eigen::VectorXd velocity_;
  std::optional<Table> path_;
};

class Plane : public Obstacle {
 public:
  Plane(Eigen::VectorXd point, const Eigen::VectorXd& normal, Motion motion);
  double gap(const Point& x, double time) const override;
  Eigen::VectorXd normal(const Point& /*x*/, double /*time*/) const override { return normal_; }
  Eigen::VectorXd velocity(double from, double to) const override { return motion_.velocity(from, to); }

 private:
  Eigen::VectorXd point_, normal_;
  Motion motion_;
};

}  // namespace ilaw::host
