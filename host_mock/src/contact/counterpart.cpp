// SPDX-License-Identifier: BSD-3-Clause
#include "contact/counterpart.hpp"

#include <utility>

namespace ilaw::host {
namespace {

Vector position_of(const Model& model, int node, const Dofs& u) {
  const Eigen::Index d = model.dimension();
  return model.position().segment(node * d, d) + u.segment(node * d, d);
}

}  // namespace

RigidCounterpart::RigidCounterpart(const Model& model, std::vector<int> nodes,
                                   std::unique_ptr<const Obstacle> obstacle)
    : model_(model), nodes_(std::move(nodes)), obstacle_(std::move(obstacle)) {}

Vector RigidCounterpart::position(int node_index, const Dofs& u) const {
  return position_of(model_, nodes_[static_cast<std::size_t>(node_index)], u);
}

ContactPoint RigidCounterpart::contact_point(int node_index, const Dofs& u, double time) const {
  const RigidSurface surface = obstacle_->at(position(node_index, u), time);
  return {surface.gap, surface.normal, 0, {}, {}};
}

double RigidCounterpart::gap_bound(int node_index, const Dofs& u, double time) const {
  return obstacle_->at(position(node_index, u), time).gap;
}

NodeCounterpart::NodeCounterpart(const Model& model, std::vector<int> nodes, std::vector<int> partners,
                                 Vector normal)
    : model_(model), nodes_(std::move(nodes)), partners_(std::move(partners)), normal_(std::move(normal)) {}

ContactPoint NodeCounterpart::contact_point(int node_index, const Dofs& u, double /*time*/) const {
  const auto k = static_cast<std::size_t>(node_index);
  const Vector apart = position_of(model_, nodes_[k], u) - position_of(model_, partners_[k], u);
  return {apart.dot(normal_), normal_, 1, {partners_[k]}, {1.0}};
}

}  // namespace ilaw::host
