// SPDX-License-Identifier: BSD-3-Clause
#include "bodies.hpp"

#include "doubles.hpp"
#include "ranks.hpp"
#include "sizes.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace ilaw::coupled {

const char* Bodies::complaint(const ilaw_bodies* given) {
  if (!sized::is_complete(given)) return "bodies are missing, or their struct_size is wrong";
  const ilaw_bodies bodies = sized::read(given);
  if (bodies.dimension < 1 || bodies.dimension > 3) return "dimension is not 1, 2 or 3";
  if (bodies.owned_count < 0 || bodies.count < bodies.owned_count) return "counts of bodies are wrong";
  if (bodies.count >= INT32_MAX) return "count is above 2^31 - 2";
  if (const char* reason = complaint_of_floats(bodies)) return reason;
  for (const ilaw_output* a : {&bodies.velocity, &bodies.spin, &bodies.impulse, &bodies.angular_impulse})
    if (collides(*a, bodies.count, bodies.dimension)) return "an output of bodies overlaps itself";
  if (bodies.count == 0) return nullptr;
  if (!bodies.inverse_mass.values || !bodies.v_free.values) return "inverse_mass or v_free is missing";
  if (is_flat(bodies.v_free, bodies.dimension) || is_flat(bodies.v_previous, bodies.dimension))
    return "v_free or v_previous has one component per body (component stride 0), expected a (d,n) array";
  if (!bodies.inverse_inertia.values) return nullptr;
  if (bodies.dimension != 3) return "bodies rotate in dimension 3 alone";
  if (!bodies.spin_free.values) return "spin_free is missing";
  if (is_flat(bodies.spin_free, 3) || is_flat(bodies.spin_previous, 3))
    return "spin_free or spin_previous has one component per body (component stride 0), expected a (3,n) array";
  return bodies.v_previous.values && !bodies.spin_previous.values ? "spin_previous is missing" : nullptr;
}

const char* Bodies::read(const ilaw_bodies& given) {
  const auto is_inverse = [](double x) { return x >= 0.0 && std::isfinite(x); };
  bool are_masses = true, are_inertias = true;
  given_ = given;
  split_.clear();
  const auto count = static_cast<std::size_t>(given.count);
  const bool mass_per_axis = given.inverse_mass.component_stride != 0 && given.dimension > 1;
  free_.resize(count + 1);
  previous_.resize(count + 1);
  movable_.resize(count + 1);
  inertia_.resize(mass_per_axis || (rotate() && !are_spheres()) ? count + 1 : 0);
  for (std::size_t b = 0; b < count; ++b) {
    const auto i = static_cast<std::int64_t>(b);
    Body& body = free_[b];
    body.velocity = vector(given.v_free, i, given.dimension);
    body.inverse_mass = value(given.inverse_mass, i);
    if (rotate()) {
      body.spin = vector(given.spin_free, i, 3);
      body.inverse_inertia = value(given.inverse_inertia, i);
    } else {
      body.spin = {};
      body.inverse_inertia = 0.0;
    }
    are_masses = are_masses && is_inverse(body.inverse_mass);
    are_inertias = are_inertias && is_inverse(body.inverse_inertia);
    previous_[b].velocity = vector(given.v_previous, i, given.dimension);
    previous_[b].spin = rotate() ? vector(given.spin_previous, i, 3) : Vector{};
    movable_[b] = moves(body);
    if (inertia_.empty()) continue;
    Inertia& inertia = inertia_[b];
    inertia.inverse_mass = vector(given.inverse_mass, i, given.dimension);
    inertia.inverse_inertia = {};
    const std::int64_t stride = given.inverse_inertia.component_stride;
    for (std::size_t c = 0; rotate() && c < (stride == 0 ? 3 : 6); ++c)
      inertia.inverse_inertia[c] = value(given.inverse_inertia, i, static_cast<std::int64_t>(c));
    for (std::size_t c = 0; c < 3; ++c) {
      are_masses = are_masses && is_inverse(inertia.inverse_mass[c]);
      are_inertias = are_inertias && is_inverse(inertia.inverse_inertia[c]) &&
                     std::isfinite(inertia.inverse_inertia[c + 3]);
    }
    const auto is_nonzero = [](double x) { return x != 0.0; };
    movable_[b] = std::any_of(inertia.inverse_mass.begin(), inertia.inverse_mass.end(), is_nonzero) ||
                  std::any_of(inertia.inverse_inertia.begin(), inertia.inverse_inertia.end(), is_nonzero);
  }
  free_[count] = previous_[count] = {};
  if (!inertia_.empty()) inertia_[count] = {};
  movable_[count] = 0;
  now_ = free_;
  rank_by_id();
  if (!are_masses) return "an inverse_mass of bodies is below 0 or not finite";
  return are_inertias ? nullptr : "an inverse_inertia of bodies is below 0 or not finite";
}

void Bodies::rank_by_id() {
  const std::int64_t* id = given_.id;
  const auto count = static_cast<std::size_t>(given_.count);
  ranks_.clear();
  if (!id || std::is_sorted(id, id + count)) return;
  order_.resize(count);
  std::iota(order_.begin(), order_.end(), 0);
  std::stable_sort(order_.begin(), order_.end(),
                   [id](std::int32_t a, std::int32_t b) { return id[a] < id[b]; });
  ranks_.resize(count + 1);
  for (std::size_t place = 0; place < count; ++place)
    ranks_[static_cast<std::size_t>(order_[place])] = static_cast<std::int32_t>(place);
  ranks_[count] = static_cast<std::int32_t>(count);
}

void Bodies::split(const std::vector<double>& copies) {
  split_.assign(now_.size(), 1.0);
  for (std::size_t b = 0; b < copies.size(); ++b) {
    const double share = std::max(1.0, copies[b]);
    split_[b] = share;
    free_[b].inverse_mass *= share;
    free_[b].inverse_inertia *= share;
    if (inertia_.empty()) continue;
    inertia_[b].inverse_mass = share * inertia_[b].inverse_mass;
    inertia_[b].inverse_inertia = share * inertia_[b].inverse_inertia;
  }
  now_ = free_;
}

Inertia Bodies::inertia_of(std::int32_t body) const {
  const auto b = static_cast<std::size_t>(body);
  if (!inertia_.empty()) return inertia_[b];
  const double m = free_[b].inverse_mass, j = free_[b].inverse_inertia;
  return {{m, m, m}, {j, j, j, 0.0, 0.0, 0.0}};
}

double Bodies::free_speed() const {
  double most = 0.0;
  for (const Body& body : free_) {
    const double speed = largest(body.velocity);
    most = speed > most && std::isfinite(speed) ? speed : most;
  }
  return most;
}

Motion Bodies::change(std::size_t body, const Motion& impulse) const {
  const double whole = split_.empty() ? 1.0 : 1.0 / split_[body];
  if (inertia_.empty()) {
    const Body& of = free_[body];
    return {(whole * of.inverse_mass) * impulse.velocity, (whole * of.inverse_inertia) * impulse.spin};
  }
  const Inertia& of = inertia_[body];
  return {whole * scaled(of.inverse_mass, impulse.velocity), whole * (of.inverse_inertia * impulse.spin)};
}

double Bodies::set(const std::vector<Motion>& impulses) {
  double most = 0.0;
  for (std::size_t b = 0; b < impulses.size(); ++b) {
    const Motion by = change(b, impulses[b]);
    const Vector velocity = free_[b].velocity + by.velocity;
    const Vector spin = free_[b].spin + by.spin;
    const double moved = largest(velocity - now_[b].velocity), turned = largest(spin - now_[b].spin);
    most = moved > most ? moved : most;
    if (turned > 0.0) {  // as a velocity of the same energy
      const double mass = free_[b].inverse_mass, inertia = free_[b].inverse_inertia;
      const double length = inertia > 0.0 ? std::sqrt(mass / inertia) : 1.0;
      most = length * turned > most ? length * turned : most;
    }
    now_[b].velocity = velocity;
    now_[b].spin = spin;
  }
  return most;
}

void Bodies::exchange(const std::vector<Motion>& start, Ranks& ranks) {
  changes_.resize(start.size());
  for (std::size_t b = 0; b < start.size(); ++b) {
    const double part = split_.empty() ? 1.0 : 1.0 / split_[b];
    changes_[b] = {part * (now_[b].velocity - start[b].velocity), part * (now_[b].spin - start[b].spin)};
  }
  ranks.sum_bodies(changes_, rotate());
  for (std::size_t b = 0; b < start.size(); ++b) {
    now_[b].velocity = start[b].velocity + changes_[b].velocity;
    now_[b].spin = start[b].spin + changes_[b].spin;
  }
}

void Bodies::write(const std::vector<Motion>& impulses) const {
  for (std::int64_t i = 0; i < given_.count; ++i) {
    const auto b = static_cast<std::size_t>(i);
    store(given_.velocity, i, given_.dimension, now_[b].velocity);
    store(given_.impulse, i, given_.dimension, impulses[b].velocity);
    if (!rotate()) continue;
    store(given_.spin, i, 3, now_[b].spin);
    store(given_.angular_impulse, i, 3, impulses[b].spin);
  }
}

// A body without impulse may have a velocity that is not a number: its contacts have bad input.
double Bodies::work(const std::vector<Motion>& impulses) const {
  double twice = 0.0;
  for (std::size_t b = 0; b < static_cast<std::size_t>(given_.count); ++b) {
    const auto& [impulse, moment] = impulses[b];
    if (is_zero(impulse) && is_zero(moment)) continue;
    const Body& before = previous_[b];
    twice += dot(impulse, before.velocity + now_[b].velocity) + dot(moment, before.spin + now_[b].spin);
  }
  return 0.5 * twice;
}

}  // namespace ilaw::coupled
