// points.hpp - any number of free point masses (0D).
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "model.hpp"

namespace ilaw::host {

class Points : public Model {
 public:
  // (d,n) position and velocity; mass and area per point.
  Points(int dimension, const Eigen::VectorXd& mass, Dofs position, Dofs velocity, Eigen::VectorXd area);

  int dimension() const override { return dimension_; }
  const Dofs& mass() const override { return mass_; }
  const Dofs& position() const override { return position_; }
  const Dofs& initial_velocity() const override { return velocity_; }
  const Eigen::VectorXd& tributary_area() const override { return area_; }

 private:
  int dimension_;
  Dofs mass_, position_, velocity_;
  Eigen::VectorXd area_;
};

}  // namespace ilaw::host
