// Start of a run, its results for readers, and the state from which it can go on.
// SPDX-License-Identifier: BSD-3-Clause
#include "base/bytes.hpp"
#include "base/large_pages.hpp"
#include "step/dof_loops.hpp"
#include "step/integrator.hpp"

#include <algorithm>

namespace ilaw::host {

namespace {

// Damping by mass takes its part of what dampers have done. Prescribed motions have the last word, so that
// positions follow them whatever else acts.
std::vector<std::size_t> order_of_corrections(const Loads& loads) {
  const auto rank = [](const Load& load) {
    return load.acts_on_driven() ? (load.prescribed_nodes().empty() ? 0 : 2) : 1;
  };
  std::vector<std::size_t> order;
  for (const int wanted : {0, 1, 2})
    for (std::size_t k = 0; k < loads.size(); ++k)
      if (loads[k]->corrects() && rank(*loads[k]) == wanted) order.push_back(k);
  return order;
}

}  // namespace

Integrator::Integrator(const Model& model, const Loads& loads, Interfaces& interfaces, double dt,
                       std::optional<PrestressSetup> prestress, double begin)
    : model_(model),
      loads_(loads),
      interfaces_(interfaces),
      dt_(dt),
      begin_(begin),
      prestress_(prestress),
      loads_are_steady_(
          std::all_of(loads.begin(), loads.end(), [](const auto& load) { return load->is_steady(); })),
      transmits_steadily_(std::all_of(loads.begin(), loads.end(),
                                      [](const auto& load) { return load->transmits_steadily(); })),
      forces_are_steady_(loads_are_steady_ && !model.has_internal_forces()),
      correcting_(order_of_corrections(loads)),
      kept_load_impulses_(loads.size()),
      u_(model.initial_displacement()),
      v_(model.initial_velocity()),
      v_before_(v_),
      external_impulse_(Dofs::Zero(loads.empty() ? 0 : u_.size())),
      internal_impulse_(Dofs::Zero(model.has_internal_forces() ? u_.size() : 0)),
      inverse_mass_(model.mass().cwiseInverse()),
      accounts_(interfaces.size()) {
  if (share_nodes(model_, interfaces_)) coupled_.emplace(model_, interfaces_);
  if (model_.thermal()) temperatures_.emplace(*model_.thermal(), loads_, interfaces_);
  if (loads_are_steady_ && !loads_.empty()) external_impulse_ = dt_ * force_at_start();
  if (forces_are_steady_ && !loads_.empty()) gain_ = external_impulse_.cwiseProduct(inverse_mass_);
  const bool damped =
      std::any_of(loads_.begin(), loads_.end(), [](const auto& load) { return load->damps(); });
  damping_impulse_ = Dofs::Zero(damped ? u_.size() : 0);
  for (const auto& interface : interfaces_) interface->set_inverse_mass(inverse_mass_.data());
  add_start_kick();
  accounts_.start(model_, u_, u_ + dt_ * v_, v_);
  speed_before_ = largest_speed(v_, model_.dimension());
  keep_in_large_pages(model_.position());
  for (const Dofs* dofs : {&u_, &v_, &v_before_, &external_impulse_, &damping_impulse_, &internal_impulse_,
                           &inverse_mass_, &gain_})
    keep_in_large_pages(*dofs);
}

Dofs Integrator::force_at_start() const {
  Dofs force = Dofs::Zero(u_.size());
  for (const auto& load : loads_) load->add_force(begin_, u_, force);
  return force;
}

// Half a kick takes V_0 to V_{1/2}, without interfaces.
void Integrator::add_start_kick() {
  hold_driven_before();  // dampers read that velocity
  Dofs force = force_at_start();
  model_.add_internal_forces(u_, force);
  v_ = model_.initial_velocity() + 0.5 * dt_ * force.cwiseProduct(inverse_mass_);
  if (!correcting_.empty()) correct(times_of(0));
}

// Driven nodes have no velocity before the start but the one that drives them: the start is no impact.
void Integrator::hold_driven_before() {
  Dofs ignored = Dofs::Zero(u_.size());
  for (const auto& load : loads_)
    if (!load->prescribed_nodes().empty()) load->correct(times_of(0), {u_, v_before_}, v_before_, ignored);
}

// m (V_{1/2} - V_0) = h/2 f_0 + r_0: laws are asked at time 0, with half a step of the velocity. Bodies then
// move a whole step, so that a predicted gap takes a whole step of the position.
void Integrator::start() {
  if (has_started_) return;
  has_started_ = true;
  find_equilibrium();
  add_start_kick();  // once more: by now it is known whose impulses are kept
  if (prestress_) {
    accounts_.start(model_, u_, u_ + dt_ * v_, v_);
    speed_before_ = largest_speed(v_, model_.dimension());
  }
  if (temperatures_) temperatures_->conduct(times_of(0));
  if (interfaces_.empty()) {
    if (temperatures_) take_heat();
    return;
  }
  const Eigen::Index d = model_.dimension();
  const Dofs v_free = v_;
  find_contact_mass(times_of(0));
  try {
    add_reactions({u_, v_before_, begin_, dt_, largest_speed(v_before_, d), speed_before_, 0});
  } catch (...) {
    v_ = v_free;
    throw;
  }
  if (contact_inverse_mass_.size() > 0) add_load_reactions(times_of(0));
  find_contact_mass(times_of(1));
  if (temperatures_) take_heat();
  speed_before_ = largest_speed(v_, d);
  accounts_.start(model_, u_, u_ + dt_ * v_, v_);
  accounts_.add_start(interfaces_, std::max(largest_speed(v_free, d), speed_before_));
}

Dofs Integrator::interface_impulse() const {
  Dofs impulse = Dofs::Zero(u_.size());
  for (const auto& interface : interfaces_)
    for (const std::int32_t contact_index : interface->active())
      interface->add_impulse(contact_index, impulse);
  return impulse;
}

void Integrator::keep_load_impulse(std::size_t load) {
  if (loads_[load]->corrects() && kept_load_impulses_[load].size() == 0)
    kept_load_impulses_[load] = Dofs::Zero(u_.size());
}

void Integrator::add_load_impulse(std::size_t load, Dofs& impulse) const {
  if (const Dofs& kept = kept_load_impulses_[load]; kept.size() != 0) {
    impulse += kept;
    return;
  }
  Dofs force = Dofs::Zero(u_.size());
  loads_[load]->add_force(time(), u_, force);
  impulse += (steps_ == 0 ? 0.5 * dt_ : dt_) * force;
  if (steps_ > 0) loads_[load]->add_impulse(times_of(steps_), impulse);
}

void Integrator::set_tolerance(double tolerance) {
  if (coupled_) coupled_->set_tolerance(tolerance);
}

void Integrator::save(std::ostream& out) const {
  write_value(out, steps_);
  write_value(out, has_started_);
  if (prestress_) {
    const PrestressReport found = prestressed_.value_or(PrestressReport{});
    write_value(out, found.steps);
    write_value(out, found.residual);
  }
  for (const Dofs* dofs : {&u_, &v_}) write_array(out, dofs->data(), static_cast<std::size_t>(dofs->size()));
  accounts_.save(out);
  for (const auto& interface : interfaces_) interface->save(out);
  if (coupled_) coupled_->save(out);
  if (temperatures_) temperatures_->save(out);
}

void Integrator::load(std::istream& in) {
  read_value(in, steps_);
  read_value(in, has_started_);
  if (prestress_) {
    read_value(in, prestressed_.emplace().steps);
    read_value(in, prestressed_->residual);
  }
  for (Dofs* dofs : {&u_, &v_}) read_array(in, dofs->data(), static_cast<std::size_t>(dofs->size()));
  accounts_.load(in);
  if (has_started_ && !interfaces_.empty()) find_contact_mass(times_of(1));
  speed_before_ = largest_speed(v_, model_.dimension());
  for (const auto& interface : interfaces_) interface->load(in, u_);
  if (coupled_) coupled_->load(in, u_);
  if (temperatures_) temperatures_->load(in);
}

}  // namespace ilaw::host
