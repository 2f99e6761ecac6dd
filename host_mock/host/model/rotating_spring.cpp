// SPDX-License-Identifier: BSD-3-Clause
#include "model/rotating_spring.hpp"

#include <cmath>

namespace ilaw::host {
namespace {

Nodes nodes_of(const SpringSetup& setup) {
  return {2,
          Eigen::Vector2d::Constant(setup.mass),
          setup.position,
          setup.velocity,
          {{"all", {{0}, {setup.area}, {}}}}};
}

}  // namespace

RotatingSpring::RotatingSpring(const SpringSetup& setup)
    : Model(nodes_of(setup)), stiffness_(setup.stiffness), length_(setup.length) {}

void RotatingSpring::add_internal_forces(const Dofs& u, Dofs& force) const {
  const Eigen::Vector2d x = position() + u;
  const double length = x.norm();
  if (length > 0.0) force -= stiffness_ * (1.0 - length_ / length) * x;  // no direction at the pivot itself
}

double RotatingSpring::potential(const Dofs& u) const {
  const double stretch = (position() + u).norm() - length_;
  return 0.5 * stiffness_ * stretch * stretch;
}

double RotatingSpring::critical_step() const { return 2.0 * std::sqrt(mass()[0] / stiffness_); }

}  // namespace ilaw::host
