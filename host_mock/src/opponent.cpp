// SPDX-License-Identifier: BSD-3-Clause
#include "opponent.hpp"

#include <utility>

namespace ilaw::host {
namespace {

Vector position_of(const Model& model, int node, const Dofs& u) {
  const Eigen::Index d = model.dimension();
  return model.position().segment(node * d, d) + u.segment(node * d, d);
}

}  // namespace

RigidOpponent::RigidOpponent(const Model& model, std::vector<int> nodes,
                             std::unique_ptr<const Obstacle> obstacle)
    : model_(model), nodes_(std::move(nodes)), obstacle_(std::move(obstacle)) {}

Vector RigidOpponent::position(int place, const Dofs& u) const {
  return position_of(model_, nodes_[static_cast<std::size_t>(place)], u);
}

Meeting RigidOpponent::meet(int place, const Dofs& u, double time) const {
  const Surface surface = obstacle_->at(position(place, u), time);
  return {surface.gap, surface.normal, 0, {}, {}};
}

double RigidOpponent::gap_bound(int place, const Dofs& u, double time) const {
  return obstacle_->at(position(place, u), time).gap;
}

NodeOpponent::NodeOpponent(const Model& model, std::vector<int> nodes, std::vector<int> partners,
                           Vector normal)
    : model_(model), nodes_(std::move(nodes)), partners_(std::move(partners)), normal_(std::move(normal)) {}

Meeting NodeOpponent::meet(int place, const Dofs& u, double /*time*/) const {
  const auto k = static_cast<std::size_t>(place);
  const Vector apart = position_of(model_, nodes_[k], u) - position_of(model_, partners_[k], u);
  return {apart.dot(normal_), normal_, 1, {partners_[k]}, {1.0}};
}

}  // namespace ilaw::host
