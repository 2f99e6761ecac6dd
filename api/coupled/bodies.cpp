// SPDX-License-Identifier: BSD-3-Clause
#include "bodies.hpp"

namespace ilaw::coupled {

Vector vector(const ilaw_input& array, std::int64_t i, std::uint32_t dimension) {
  Vector read{};
  for (std::uint32_t c = 0; c < dimension; ++c) read[c] = value(array, i, c);
  return read;
}

void store(const ilaw_output& array, std::int64_t i, std::uint32_t dimension, const Vector& values) {
  if (!array.values) return;
  for (std::uint32_t c = 0; c < dimension; ++c)
    array.values[i * array.node_stride + c * array.component_stride] = values[c];
}

void Bodies::read(const ilaw_bodies& given) {
  given_ = given;
  free_.resize(static_cast<std::size_t>(given.count));
  for (std::int64_t i = 0; i < given.count; ++i)
    free_[static_cast<std::size_t>(i)] = {vector(given.v_free, i, given.dimension),
                                          rotate() ? vector(given.spin_free, i, 3) : Vector{}};
}

Motion Bodies::previous(std::int64_t body) const {
  return {vector(given_.v_previous, body, given_.dimension),
          rotate() ? vector(given_.spin_previous, body, 3) : Vector{}};
}

Symmetric Bodies::inverse_inertia(std::int64_t body) const {
  const ilaw_input& array = given_.inverse_inertia;
  Symmetric read{};
  if (array.component_stride == 0)
    read[0] = read[1] = read[2] = value(array, body);
  else
    for (std::size_t c = 0; c < read.size(); ++c) read[c] = value(array, body, static_cast<std::int64_t>(c));
  return read;
}

// I/m - [l] J^-1 [l], column by column: the velocity (J^-1 (l x e)) x l that a unit impulse e makes at l.
Symmetric Bodies::delassus(std::int64_t body, const Vector& arm) const {
  const double w = value(given_.inverse_mass, body);
  Symmetric h{w, w, w, 0.0, 0.0, 0.0};
  if (!rotate()) return h;
  const Symmetric inertia = inverse_inertia(body);
  const auto turned = [&](const Vector& unit) { return cross(inertia * cross(arm, unit), arm); };
  const Vector x = turned({1, 0, 0}), y = turned({0, 1, 0}), z = turned({0, 0, 1});
  return h + Symmetric{x[0], y[1], z[2], y[0], z[0], z[1]};
}

Motion Bodies::change(const std::vector<double>& sums, std::int64_t body) const {
  const double* of_body = &sums[static_cast<std::size_t>(body * components())];
  Motion change;
  change.velocity = value(given_.inverse_mass, body) * Vector{of_body[1], of_body[2], of_body[3]};
  if (rotate()) change.spin = inverse_inertia(body) * Vector{of_body[4], of_body[5], of_body[6]};
  return change;
}

double Bodies::product(const std::vector<double>& sums, const std::vector<Motion>& difference) const {
  double total = 0.0;
  for (std::int64_t i = 0; i < given_.owned_count; ++i) {
    const double* of_body = &sums[static_cast<std::size_t>(i * components())];
    const Motion& by = difference[static_cast<std::size_t>(i)];
    total += dot({of_body[1], of_body[2], of_body[3]}, by.velocity);
    if (rotate()) total += dot({of_body[4], of_body[5], of_body[6]}, by.spin);
  }
  return total;
}

void Bodies::write(const std::vector<Motion>& velocities, const std::vector<double>& sums) const {
  for (std::int64_t i = 0; i < given_.count; ++i) {
    const Motion& motion = velocities[static_cast<std::size_t>(i)];
    const double* of_body = &sums[static_cast<std::size_t>(i * components())];
    store(given_.velocity, i, given_.dimension, motion.velocity);
    store(given_.impulse, i, given_.dimension, {of_body[1], of_body[2], of_body[3]});
    if (!rotate()) continue;
    store(given_.spin, i, 3, motion.spin);
    store(given_.angular_impulse, i, 3, {of_body[4], of_body[5], of_body[6]});
  }
}

}  // namespace ilaw::coupled
