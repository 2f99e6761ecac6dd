// SPDX-License-Identifier: BSD-3-Clause
#include "contact/counterpart.hpp"

#include <algorithm>
#include <optional>
#include <type_traits>
#include <utility>

namespace ilaw::host {
namespace {

Vector position_of(const Model& model, int node, const Dofs& u) {
  const Eigen::Index d = model.dimension();
  return model.position().segment(node * d, d) + u.segment(node * d, d);
}

}  // namespace

double ContactPoint::delassus(const Model& model, int node) const {
  double sum = 0.0;
  for_each_node(node, [&](int one, double weight) {
    sum += weight * weight / model.mass()[static_cast<Eigen::Index>(one) * model.dimension()];
  });
  return sum;
}

void Counterpart::locate(const std::int32_t* node_indices, std::ptrdiff_t count, const Dofs& u, double time,
                         Located found) const {
  for (std::ptrdiff_t i = 0; i < count; ++i) {
    const ContactPoint point = contact_point(node_indices[i], u, time);
    found.gaps[i] = point.gap;
    std::copy_n(point.normal.data(), point.normal.size(), found.normals + i * point.normal.size());
  }
}

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

void RigidCounterpart::locate(const std::int32_t* node_indices, std::ptrdiff_t count, const Dofs& u,
                              double time, Located found) const {
  const std::optional<FlatSurface> flat = obstacle_->flat_at(time);
  if (!flat) return Counterpart::locate(node_indices, count, u, time, found);
  const auto in = [&]<int D>(std::integral_constant<int, D>) {
    for (std::ptrdiff_t i = 0; i < count; ++i) {
      const Eigen::Index first = Eigen::Index{D} * nodes_[static_cast<std::size_t>(node_indices[i])];
      double gap = 0.0;
      for (int c = 0; c < D; ++c) {
        const double x = model_.position()[first + c] + u[first + c];
        gap += (x - flat->displacement[c] - flat->point[c]) * flat->normal[c];
        found.normals[D * i + c] = flat->normal[c];
      }
      found.gaps[i] = gap;
    }
  };
  const int d = model_.dimension();
  if (d == 1) return in(std::integral_constant<int, 1>());
  return d == 2 ? in(std::integral_constant<int, 2>()) : in(std::integral_constant<int, 3>());
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
