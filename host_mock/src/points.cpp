// SPDX-License-Identifier: BSD-3-Clause
#include "points.hpp"

#include <utility>

namespace ilaw::host {

Points::Points(int dimension, const Eigen::VectorXd& mass, Dofs position, Dofs velocity, Eigen::VectorXd area)
    : dimension_(dimension),
      mass_(mass.size() * dimension),
      position_(std::move(position)),
      velocity_(std::move(velocity)),
      area_(std::move(area)) {
  for (Eigen::Index i = 0; i < mass.size(); ++i) mass_.segment(i * dimension, dimension).setConstant(mass[i]);
}

}  // namespace ilaw::host
