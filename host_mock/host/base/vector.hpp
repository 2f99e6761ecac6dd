// vector.hpp - a vector of the scene's space: 1 to 3 components, no allocation.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

namespace ilaw::host {

using Vector = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, 3, 1>;

}  // namespace ilaw::host
