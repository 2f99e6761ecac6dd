// SPDX-License-Identifier: BSD-3-Clause
#include "surface/counterpart.hpp"

#include <optional>

namespace ilaw::host {
double ContactPoint::delassus(const double* inverse_mass, int dimension, int node, int axis) const {
  double sum = 0.0;
  for_each_node(node, [&](int one, double weight) {
    sum += weight * weight * inverse_mass[std::ptrdiff_t{dimension} * one + axis];
  });
  return sum;
}

Vector Counterpart::position(int node_index, const Dofs& u) const {
  return model_.position(nodes_[static_cast<std::size_t>(node_index)], u);
}

void Counterpart::gap_bounds(int first, int count, const Dofs& u, double time, double* bounds) const {
  for (int i = 0; i < count; ++i) bounds[i] = gap_bound(first + i, u, time);
}

void RigidCounterpart::find_contact(int node_index, const Dofs& u, double time, ContactPoint& found) const {
  const RigidSurface surface = obstacle_->at(position(node_index, u), time);
  found = {surface.gap, surface.normal, {}};
}

void RigidCounterpart::gap_bounds(int first, int count, const Dofs& u, double time, double* bounds) const {
  const std::optional<FlatSurface> flat = obstacle_->flat_at(time);
  if (!flat) return Counterpart::gap_bounds(first, count, u, time, bounds);
  const int* const nodes = &nodes_[static_cast<std::size_t>(first)];
  const int d = model_.dimension();
  if (d == 1) return flat_gaps<1>(model_, nodes, count, u, *flat, bounds);
  return d == 2 ? flat_gaps<2>(model_, nodes, count, u, *flat, bounds)
                : flat_gaps<3>(model_, nodes, count, u, *flat, bounds);
}

void NodeCounterpart::find_contact(int node_index, const Dofs& u, double /*time*/,
                                   ContactPoint& found) const {
  const int partner = partners_[static_cast<std::size_t>(node_index)];
  const Vector apart = position(node_index, u) - model_.position(partner, u);
  found = {apart.dot(normal_), normal_, {{partner, 1.0}}};
}

}  // namespace ilaw::host
