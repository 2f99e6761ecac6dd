// SPDX-License-Identifier: BSD-3-Clause
#include "model/points.hpp"

#include <cmath>

namespace ilaw::host {
namespace {

Nodes nodes_of(int dimension, const std::vector<PointMass>& points) {
  const auto size = static_cast<Eigen::Index>(points.size()) * dimension;
  Nodes nodes{dimension, Dofs(size), Dofs(size), Dofs(size), {}};
  NodeSet& all = nodes.sets["all"];
  for (std::size_t k = 0; k < points.size(); ++k) {
    const Eigen::Index first = static_cast<Eigen::Index>(k) * dimension;
    nodes.mass.segment(first, dimension).setConstant(points[k].mass);
    nodes.position.segment(first, dimension) = points[k].position;
    nodes.velocity.segment(first, dimension) = points[k].velocity;
    all.nodes.push_back(static_cast<int>(k));
    all.areas.push_back(points[k].area);
  }
  return nodes;
}

}  // namespace

Points::Points(int dimension, const std::vector<PointMass>& points) : Model(nodes_of(dimension, points)) {
  for (std::size_t k = 0; k < points.size(); ++k) {
    if (points[k].stiffness.size() == 0) continue;
    if (stiffness_.size() == 0) stiffness_ = Dofs::Zero(mass().size());
    stiffness_.segment(static_cast<Eigen::Index>(k) * dimension, dimension) = points[k].stiffness;
  }
}

void Points::add_internal_forces(const Dofs& u, Dofs& force) const {
  if (stiffness_.size() > 0) force -= stiffness_.cwiseProduct(u);
}

double Points::potential(const Dofs& u) const {
  return stiffness_.size() > 0 ? 0.5 * u.dot(stiffness_.cwiseProduct(u)) : 0.0;
}

double Points::critical_step() const {
  if (stiffness_.size() == 0) return Model::critical_step();
  return 2.0 / std::sqrt(stiffness_.cwiseQuotient(mass()).maxCoeff());
}

}  // namespace ilaw::host
