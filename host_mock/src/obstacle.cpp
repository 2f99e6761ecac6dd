// SPDX-License-Identifier: BSD-3-Clause
#include "obstacle.hpp"

#include <utility>

namespace ilaw::host {

Plane::Plane(Eigen::VectorXd point, const Eigen::VectorXd& normal, Motion motion)
    : point_(std::move(point)), normal_(normal.normalized()), motion_(std::move(motion)) {}

double Plane::gap(const Point& x, double time) const {
  return (x - point_ - motion_.displacement(time)).dot(normal_);
}

}  // namespace ilaw::host
