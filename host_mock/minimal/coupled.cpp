// coupled.cpp - contacts that share nodes: all laws hold at once, by the solver of ilaw/coupled.h.
// SPDX-License-Identifier: BSD-3-Clause
#include "minimal.hpp"

#include <ilaw/arrays.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <stdexcept>

namespace minimal {

bool CoupledContacts::is_needed(const Scene& scene) {
  std::vector<int> uses(scene.points.mass.size());
  for (const Contacts& contacts : scene.contacts)
    for (const auto* nodes : {&contacts.nodes, &contacts.partners})
      for (const std::int32_t node : *nodes) ++uses[static_cast<std::size_t>(node)];
  return std::any_of(scene.contacts.begin(), scene.contacts.end(),
                     [](const Contacts& contacts) { return !contacts.partners.empty(); }) ||
         std::any_of(uses.begin(), uses.end(), [](int count) { return count > 1; });
}

namespace {

double largest(const Values& values) {
  double found = 0.0;
  for (const double value : values) found = std::max(found, std::abs(value));
  return found;
}

// The contacts of one law as the solver takes them, with the arrays that they need.
struct Group {
  ilaw_batch batch;
  Values next_state;
  std::vector<std::int32_t> counterpart;
  ilaw_contacts contacts;

  Group(Contacts& own, const Step& step, std::size_t d, double impulse_scale)
      : batch(batch_of(own, d, step)), next_state(own.state), counterpart(own.partners) {
    batch.v_free = batch.v_previous = batch.delassus = {};  // the solver's own
    // The solver evaluates laws many times from state_in, which stays as it is until the step is accepted.
    batch.state_out = ilaw::output(next_state.data(), static_cast<std::int64_t>(own.info.state_size), 1);
    for (double& r : own.impulse) r *= impulse_scale;  // iterations begin with the forces of the last step
    if (counterpart.empty()) counterpart.assign(own.nodes.size(), -1);  // a wall
    contacts = ilaw::contacts_of(own.law, ILAW_DELASSUS_SCALAR, batch, own.nodes.data(), counterpart.data());
    contacts.wall_velocity = ilaw::input(own.obstacle.velocity.data(), 0, 1);
  }
};

ilaw_bodies bodies_of(const Points& points, const Values& inverse_mass, const Values& v_before, Values& v) {
  const auto stride = static_cast<std::int64_t>(points.d);
  ilaw_bodies bodies{};
  bodies.struct_size = sizeof bodies;
  bodies.dimension = static_cast<std::uint32_t>(points.d);
  bodies.count = bodies.owned_count = static_cast<std::int64_t>(points.mass.size());
  bodies.inverse_mass = ilaw::input(inverse_mass.data(), 1, 0);
  bodies.v_free = ilaw::input(v.data(), stride, 1);
  bodies.v_previous = ilaw::input(v_before.data(), stride, 1);
  bodies.velocity = ilaw::output(v.data(), stride, 1);
  return bodies;
}

}  // namespace

void CoupledContacts::solve(Scene& scene, const Step& step, const Values& u, const Values& v_before,
                            Values& v) {
  const Points& points = scene.points;
  const double impulse_scale = velocity_step_ > 0.0 ? step.velocity_step / velocity_step_ : 0.0;
  std::vector<std::unique_ptr<Group>> groups;
  std::vector<const ilaw_contacts*> given;
  for (Contacts& contacts : scene.contacts) {
    groups.push_back(std::make_unique<Group>(contacts, step, points.d, impulse_scale));
    given.push_back(&groups.back()->contacts);
  }
  Values inverse_mass;
  for (const double mass : points.mass) inverse_mass.push_back(1.0 / mass);
  ilaw_coupled_options options{};
  options.tolerance = 1e-14;
  options.speed = largest(v_before);
  options.rounding = 16.0 * std::numeric_limits<double>::epsilon() * (largest(points.position) + largest(u)) /
                     step.position_step;
  const ilaw_coupled_report report =
      solver_.solve(bodies_of(points, inverse_mass, v_before, v), given, options);
  if (report.bad_count > 0)
    throw std::runtime_error("time " + std::to_string(step.time) + ": interface '" +
                             scene.contacts[static_cast<std::size_t>(report.bad_group)].name +
                             "': " + (report.reason ? report.reason : "bad input"));
  if (report.message) throw std::runtime_error("time " + std::to_string(step.time) + ": " + report.message);
  for (std::size_t i = 0; i < groups.size(); ++i)
    scene.contacts[i].state = groups[i]->next_state;  // accepted
  velocity_step_ = step.velocity_step;
}

}  // namespace minimal
