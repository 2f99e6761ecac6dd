// solid_fields.hpp - displacements of a body, and the forces that they make, for tests of elements.
#pragma once

#include "model/model.hpp"

#include <random>

namespace ilaw::host::testing {

inline Dofs forces(const Model& model, const Dofs& u) {
  Dofs force = Dofs::Zero(u.size());
  model.add_internal_forces(u, force);
  return force;
}

// u = G x at all nodes.
inline Dofs linear_field(const Model& model, const Eigen::Matrix3d& gradient) {
  const Eigen::Map<const Eigen::Matrix3Xd> x(model.position().data(), 3, model.node_count());
  const Eigen::Matrix3Xd u = gradient * x;
  return Eigen::Map<const Dofs>(u.data(), u.size());
}

template <class Random>
Dofs random_field(const Model& model, double size, Random&& random) {
  std::uniform_real_distribution<double> part(-size, size);
  return Dofs::NullaryExpr(model.mass().size(), [&] { return part(random); });
}

}  // namespace ilaw::host::testing
