// rotating_spring.hpp - a mass on a linear spring that turns freely about the origin: two degrees
// of freedom, large rotations.
//   f_int(x) = k (|x| - L) x/|x|
// The force is central, so that central difference keeps the angular momentum x_n x m v_{n+1/2} to
// rounding.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "model/model.hpp"

namespace ilaw::host {

struct SpringSetup {
  double mass, stiffness, length, area;
  Eigen::Vector2d position, velocity;
};

class RotatingSpring : public Model {
 public:
  explicit RotatingSpring(const SpringSetup& setup);

  bool has_internal_forces() const override { return true; }
  bool is_linear() const override { return false; }
  void add_internal_forces(const Dofs& u, Dofs& force) const override;
  double potential(const Dofs& u) const override;
  double critical_step() const override;

 private:
  double stiffness_, length_;
};

}  // namespace ilaw::host
