// points.hpp - any number of free point masses (0D).
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "model.hpp"

namespace ilaw::host {

struct PointMass {
  double mass, area;
  Eigen::VectorXd position, velocity;
};

class Points : public Model {
 public:
  Points(int dimension, const std::vector<PointMass>& points);
};

}  // namespace ilaw::host
