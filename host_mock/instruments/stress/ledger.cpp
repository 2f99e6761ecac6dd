// SPDX-License-Identifier: BSD-3-Clause
#include "stress/ledger.hpp"

#include "audit/audited_interface.hpp"
#include "step/dof_loops.hpp"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <vector>

namespace ilaw::host {
namespace {

// The largest length in the state of a contact.
double largest_place(const Interface& interface, int contact, const Dofs& u) {
  const ilaw_instance_info& info = interface.info();
  const std::vector<double> state = interface.state_at(interface.node_index_of(contact), u);
  double largest = 0.0;
  std::size_t at = 0;
  for (std::uint32_t i = 0; i < info.state_variable_count; ++i) {
    const ilaw_state_variable& variable = *info.state_variables[i];
    for (const std::size_t end = at + variable.count; at < end; ++at)
      if (variable.unit == std::string_view("m")) largest = std::max(largest, std::abs(state[at]));
  }
  return largest;
}

}  // namespace

Ledger::Ledger(const Scene& scene) : scene_(scene), start_depth_(scene.interfaces.size()) {
  const Dofs u = Dofs::Zero(scene.model->mass().size());
  for (std::size_t i = 0; i < scene.interfaces.size(); ++i) {
    const Interface& interface = *scene.interfaces[i];
    if (interface.setup().counterpart->shares_partners() ||
        !AuditedInterface(interface, *scene.model, false).stops())
      continue;
    start_depth_[i] = Dofs::Zero(scene.model->node_count());
    for (std::size_t k = 0; k < interface.nodes().size(); ++k)
      start_depth_[i][interface.nodes()[k]] = std::max(0.0, -interface.gap_at(static_cast<int>(k), u, 0.0));
  }
}

void Ledger::close(const Integrator& integrator) {
  ++steps_;
  const int dimension = scene_.model->dimension();
  const double speed =
      std::max(largest_speed(v_before_, dimension), largest_speed(integrator.velocity(), dimension));
  for (std::size_t i = 0; i < scene_.interfaces.size(); ++i) add(i, integrator, speed);
  const double kinetic = scene_.model->mass().dot(integrator.velocity().cwiseAbs2());
  const bool is_due = steps_ % every == 1;
  if (is_due || kinetic > most_kinetic_) size_ = std::max(size_, size_now(integrator));
  most_kinetic_ = std::max(most_kinetic_, kinetic);
  if (is_due) sample(integrator);
}

// Stored energies are known in sum alone, which is no less than that of a node.
void Ledger::add(std::size_t number, const Integrator& integrator, double speed) {
  const Interface& interface = *scene_.interfaces[number];
  const bool is_alone = interface.setup().counterpart->partners().empty();
  const double obstacle =
      std::max(interface.obstacle().velocity_before().norm(), interface.obstacle().velocity().norm());
  fastest_ = std::max(fastest_, (is_alone ? 1.0 : 2.0) * speed + obstacle);
  if (interface.sums().penetration > penetration_.value) measure_depth(number, integrator);
  const double stored = interface.sums().energy[ILAW_ENERGY_STORED];
  stored_ += stored;
  rounded_most_ = std::max(rounded_most_, stored);
  for (const std::int32_t contact : interface.active()) {
    const Vector impulse = interface.impulse(contact);
    if (impulse.isZero(0.0)) continue;
    const Ends ends = ends_of(interface, contact, integrator);
    work_.note(0.5 * impulse.dot(ends.before + ends.after), integrator.steps(), interface.node_of(contact));
    const Vector change = interface.delassus(contact) * impulse;
    const double from_places = largest_place(interface, contact, integrator.displacement()) / scene_.dt;
    const double rounded = impulse.norm() * (ends.before.norm() + (ends.after - change).norm() +
                                             change.norm() + ends.carried + from_places);
    rounded_ += rounded;
    solved_ += 0.5 * impulse.norm() * speed;
    rounded_most_ = std::max(rounded_most_, rounded + stored);
  }
}

Ledger::Ends Ledger::ends_of(const Interface& interface, int contact, const Integrator& integrator) const {
  const Counterpart& counterpart = *interface.setup().counterpart;
  const Dofs& v = integrator.velocity();
  Vector before = interface.obstacle().velocity_before(), after = interface.obstacle().velocity();
  if (counterpart.turns()) {
    const int k = interface.node_index_of(contact);
    const double time = integrator.time();
    const ContactPoint point = counterpart.contact_point(k, integrator.displacement(), time);
    const SurfaceVelocities turn =
        surface_velocities(counterpart, k, integrator.displacement(), time, {point.gap, point.normal},
                           counterpart.obstacle()->rates(time - scene_.dt, time, time + scene_.dt));
    before += turn.before;
    after += turn.after;
  }
  double carried = before.norm() + after.norm();
  if (!counterpart.partners().empty()) {
    const Eigen::Index d = scene_.model->dimension();
    interface.point(contact).for_each_node(interface.node_of(contact), [&](int node, double weight) {
      carried += std::abs(weight) * (v_before_.segment(node * d, d).norm() + v.segment(node * d, d).norm());
    });
  }
  return {interface.relative(contact, v_before_) - before, interface.relative(contact, v) - after, carried};
}

void Ledger::measure_depth(std::size_t number, const Integrator& integrator) {
  const Interface& interface = *scene_.interfaces[number];
  const Dofs& start_depth = start_depth_[number];
  if (start_depth.size() == 0) return;
  for (const std::int32_t contact : interface.active()) {
    const double gap =
        interface.gap_at(interface.node_index_of(contact), integrator.displacement(), integrator.time());
    const int node = interface.node_of(contact);
    penetration_.note(-gap - start_depth[node], integrator.steps(), node);
  }
}

double Ledger::size_now(const Integrator& integrator) const {
  const Dofs &u = integrator.displacement(), &v = integrator.velocity(), &mass = scene_.model->mass();
  const double critical = scene_.model->critical_step();
  // |p| <= m |change of v|, twice: outer and inner impulses may cancel.
  double size = mass.dot(v.cwiseAbs2()) + mass.dot(v_before_.cwiseAbs2());
  if (std::isfinite(critical)) size += 4.0 / (critical * critical) * mass.dot(u.cwiseAbs2());
  return size;
}

void Ledger::sample(const Integrator& integrator) {
  const Dofs& u = integrator.displacement();
  const double dt = scene_.dt, critical = scene_.model->critical_step();
  farthest_ = std::max(farthest_, u.cwiseAbs().maxCoeff() + scene_.model->position().cwiseAbs().maxCoeff());
  if (!scene_.model->is_linear() || !(dt < critical)) return;
  const EnergyReport energy = integrator.energy();
  const double courant = std::isfinite(critical) ? dt / critical : 0.0;
  const double most = energy.kinetic + energy.internal + rounding * size_now(integrator);
  if (energy.kinetic > 0.0)
    worst_velocity_ = std::max(worst_velocity_, energy.kinetic * (1.0 - courant * courant) / most);
}

double Ledger::balance_bound() const {
  return rounding * (static_cast<double>(steps_ + 1) * size_ + rounded_);
}

double Ledger::added_bound(const Tally& tally) const {
  return rounding * (rounded_ + stored_) + tally.coupling_energy + tally.coupling_tolerance * solved_;
}

double Ledger::dissipation_bound() const { return rounding * rounded_most_; }

double Ledger::penetration_bound() const {
  const double a_step = scene_.dt * fastest_;
  const double rounded = rounding * static_cast<double>(steps_) * (a_step + farthest_);
  return a_step + rounded;
}

}  // namespace ilaw::host
