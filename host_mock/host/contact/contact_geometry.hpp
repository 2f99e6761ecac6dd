// contact_geometry.hpp - where a node meets its counterpart in a step.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "contact/interface_setup.hpp"

#include <cstddef>
#include <vector>

namespace ilaw::host {

struct ContactGeometry {
  ContactPoint point;         // its gap less the gap offset
  SurfaceVelocities surface;  // velocities of a surface that turns, beside those of the obstacle
};

inline void locate_contact(const InterfaceSetup& setup, int node_index, const StepView& step,
                           const TurningRates& rates, ContactGeometry& found) {
  const Counterpart& counterpart = *setup.counterpart;
  counterpart.find_contact(node_index, step.u, step.time, found.point);
  const Vector& normal = found.point.normal;
  found.surface = {Vector::Zero(normal.size()), Vector::Zero(normal.size())};
  if (counterpart.turns())
    found.surface =
        surface_velocities(counterpart, node_index, step.u, step.time, {found.point.gap, normal}, rates);
  found.point.gap = counterpart.known_gap(node_index, step.u, found.point.gap - setup.gap_offset(node_index));
}

// The velocity of a node relative to its partners.
inline Vector relative_velocity(const ContactPoint& point, int node, Eigen::Index dimension, const Dofs& v) {
  Vector relative = point.own_weight * v.segment(node * dimension, dimension);
  for (const Partner& partner : point.partners)
    relative -= partner.weight * v.segment(partner.node * dimension, dimension);
  return relative;
}

// The memory of a law is that of the surface, which has turned since the last step. axes: where they begin
// in the state; number(c): entry c of the state.
template <class Number>
void turn_axes(const InterfaceSetup& setup, const std::vector<std::size_t>& axes, Eigen::Index dimension,
               const StepView& step, Number number) {
  if (!setup.counterpart->turns()) return;
  for (const std::size_t first : axes)
    turn_axis(*setup.counterpart, dimension, step.since, step.time,
              [&](std::size_t c) -> double& { return number(first + c); });
}

}  // namespace ilaw::host
