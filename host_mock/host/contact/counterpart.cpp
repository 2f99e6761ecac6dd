// SPDX-License-Identifier: BSD-3-Clause
#include "contact/counterpart.hpp"

#include <algorithm>
#include <optional>
#include <utility>

namespace ilaw::host {
namespace {

Vector position_of(const Model& model, int node, const Dofs& u) {
  const Eigen::Index d = model.dimension();
  return model.position().segment(node * d, d) + u.segment(node * d, d);
}

}  // namespace

double ContactPoint::delassus(const double* inverse_mass, int dimension, int node, int axis) const {
  double sum = 0.0;
  for_each_node(node, [&](int one, double weight) {
    sum += weight * weight * inverse_mass[std::ptrdiff_t{dimension} * one + axis];
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

void Counterpart::gap_bounds(int first, int count, const Dofs& u, double time, double* bounds) const {
  for (int i = 0; i < count; ++i) bounds[i] = gap_bound(first + i, u, time);
}

RigidCounterpart::RigidCounterpart(const Model& model, std::vector<int> nodes,
                                   std::unique_ptr<const Obstacle> obstacle)
    : model_(model), nodes_(std::move(nodes)), obstacle_(std::move(obstacle)) {}

Vector RigidCounterpart::position(int node_index, const Dofs& u) const {
  return position_of(model_, nodes_[static_cast<std::size_t>(node_index)], u);
}

double RigidCounterpart::tilting_speed(double from, double to, const Dofs& u) const {
  double fastest = 0.0;
  if (!obstacle_->tilts()) return fastest;
  for (std::size_t k = 0; k < nodes_.size(); ++k)
    fastest = std::max(fastest, obstacle_->tilting_speed(position(static_cast<int>(k), u), from, to));
  return fastest;
}

ContactPoint RigidCounterpart::contact_point(int node_index, const Dofs& u, double time) const {
  const RigidSurface surface = obstacle_->at(position(node_index, u), time);
  return {surface.gap, surface.normal, 0, {}, {}, false};
}

double RigidCounterpart::gap_bound(int node_index, const Dofs& u, double time) const {
  return obstacle_->at(position(node_index, u), time).gap;
}

void RigidCounterpart::locate(const std::int32_t* node_indices, std::ptrdiff_t count, const Dofs& u,
                              double time, Located found) const {
  const std::optional<FlatSurface> flat = obstacle_->flat_at(time);
  if (!flat) return Counterpart::locate(node_indices, count, u, time, found);
  const Eigen::Index d = model_.dimension();
  for (std::ptrdiff_t i = 0; i < count; ++i) {
    const int node = nodes_[static_cast<std::size_t>(node_indices[i])];
    gaps_to(*flat, &node, 1, u, found.gaps + i);
    std::copy_n(flat->normal.data(), d, found.normals + d * i);
  }
}

void RigidCounterpart::gap_bounds(int first, int count, const Dofs& u, double time, double* bounds) const {
  const std::optional<FlatSurface> flat = obstacle_->flat_at(time);
  if (!flat) return Counterpart::gap_bounds(first, count, u, time, bounds);
  gaps_to(*flat, &nodes_[static_cast<std::size_t>(first)], count, u, bounds);
}

void RigidCounterpart::gaps_to(const FlatSurface& flat, const std::int32_t* nodes, std::ptrdiff_t count,
                               const Dofs& u, double* gaps) const {
  const int d = model_.dimension();
  if (d == 1) return flat_gaps<1>(model_, nodes, count, u, flat, gaps);
  return d == 2 ? flat_gaps<2>(model_, nodes, count, u, flat, gaps)
                : flat_gaps<3>(model_, nodes, count, u, flat, gaps);
}

NodeCounterpart::NodeCounterpart(const Model& model, std::vector<int> nodes, std::vector<int> partners,
                                 Vector normal)
    : model_(model), nodes_(std::move(nodes)), partners_(std::move(partners)), normal_(std::move(normal)) {}

ContactPoint NodeCounterpart::contact_point(int node_index, const Dofs& u, double /*time*/) const {
  const auto k = static_cast<std::size_t>(node_index);
  const Vector apart = position_of(model_, nodes_[k], u) - position_of(model_, partners_[k], u);
  return {apart.dot(normal_), normal_, 1, {partners_[k]}, {1.0}, false};
}

}  // namespace ilaw::host
