// SPDX-License-Identifier: BSD-3-Clause
#include "points.hpp"

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

Points::Points(int dimension, const std::vector<PointMass>& points) : Model(nodes_of(dimension, points)) {}

}  // namespace ilaw::host
