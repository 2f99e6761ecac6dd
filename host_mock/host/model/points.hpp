// points.hpp - any number of point masses (0D), free or each on a linear spring.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/vector.hpp"
#include "model/model.hpp"

namespace ilaw::host {

struct PointMass {
  double mass, area;
  Vector position, velocity;
  Vector stiffness;  // of a spring to where the point starts, per axis; empty: none
};

class Points : public Model {
 public:
  Points(int dimension, const std::vector<PointMass>& points);

  bool has_internal_forces() const override { return stiffness_.size() > 0; }
  void add_internal_forces(const Dofs& u, Dofs& force) const override;
  double potential(const Dofs& u) const override;
  double critical_step() const override;

 private:
  Dofs stiffness_;  // per degree of freedom; empty: no point has a spring
};

}  // namespace ilaw::host
