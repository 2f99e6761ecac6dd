// Dynamic relaxation: the steps of the scheme with loads and obstacles of time 0, at which the bodies are
// stopped whenever their kinetic energy has passed a maximum (kinetic damping: Cundall 1976; Barnes 1999). It
// has no parameter, and also finds its way where stiffness comes from interfaces. Bodies at rest tell how far
// they are from equilibrium: the forces that remain.
// SPDX-License-Identifier: BSD-3-Clause
#include "base/stop_request.hpp"
#include "base/words.hpp"
#include "step/dof_loops.hpp"
#include "step/integrator.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace ilaw::host {

// The forces of a step from rest that no other balances, relative. Driven nodes have the reaction of their
// motion. Without loads and contact: relative to those at the beginning.
double Integrator::residual() {
  const Dofs contact = interface_impulse();
  Dofs open = contact;
  double largest = contact.norm();
  if (internal_impulse_.size() > 0) open += internal_impulse_;
  if (external_impulse_.size() > 0) {
    const double part = loads_are_steady_ ? 0.5 : 1.0;  // what is steady was not halved
    open += part * external_impulse_;
    largest = std::max(largest, part * external_impulse_.norm());
  }
  if (first_residual_ == 0.0) first_residual_ = open.norm();
  if (largest == 0.0) largest = first_residual_;
  return largest > 0.0 ? open.norm() / largest : 0.0;
}

// A step of the relaxation: obstacles and motions stand still where times.until is times.after. From rest it
// has half a step of the velocity, like the start of a run: a whole one would make fast vibrations grow.
void Integrator::relax(StepTimes times, bool from_rest) {
  has_begun_step_ = true;
  v_before_.swap(v_);
  move();
  sum_forces(times);
  if (from_rest) {
    internal_impulse_ *= 0.5;
    if (!loads_are_steady_) external_impulse_ *= 0.5;
  }
  double speed_free = kick(times);
  if (from_rest && loads_are_steady_ && !loads_.empty()) {
    v_ -= 0.5 * external_impulse_.cwiseProduct(inverse_mass_);
    speed_free = largest_speed(v_, model_.dimension());
  }
  check_motion(speed_free, times.after);
  find_contact_mass(times);
  StepView view{u_, v_before_, times.after, dt_, speed_before_, speed_free, from_rest ? 0 : 1};
  view.until = times.until;
  if (was_held_) view.since = times.after;
  add_reactions(view);
  if (contact_inverse_mass_.size() > 0) add_load_reactions(times);
  speed_before_ = largest_speed(v_, model_.dimension());
  check_motion(speed_before_, times.after);
  was_held_ = times.until == times.after;
  has_begun_step_ = false;
}

void Integrator::find_equilibrium(const std::function<void(const PrestressReport&)>& told) {
  if (!prestress_ || prestressed_) return;
  const auto ramp_steps = static_cast<std::int64_t>(std::ceil(prestress_->ramp / dt_ * (1.0 - 1e-12)));
  const auto time_at = [&](std::int64_t number) {
    return -dt_ * static_cast<double>(std::max<std::int64_t>(ramp_steps - number, 0));
  };
  PrestressReport& found = prestressed_.emplace();
  stop();
  double energy_before = 0.0;
  bool at_rest = true;
  for (std::int64_t number = 0; number <= ramp_steps + prestress_->steps; ++number) {
    const double time = time_at(number);
    if (stop_requested()) throw Interrupted("the prestress was interrupted");
    relax({time - dt_, time, time_at(number + 1)}, at_rest);
    found.steps = number + 1;
    if (told) told(found);
    if (number < ramp_steps) {
      at_rest = false;
      continue;
    }
    if (at_rest && (found.residual = residual()) <= prestress_->tolerance) return begin_anew();
    const double energy = kinetic_energy(model_, v_);
    at_rest = energy < energy_before;
    energy_before = at_rest ? 0.0 : energy;
    if (at_rest) stop();
  }
  throw std::runtime_error(
      formatted("no static equilibrium after %lld steps of 'prestress': residual %.3g, expected at most %g",
                static_cast<long long>(found.steps), found.residual, prestress_->tolerance));
}

void Integrator::stop() {
  v_.setZero();
  speed_before_ = 0.0;
}

// The clock is at 0, bodies have the velocities of the scene, and the accounts begin. The energy that
// interfaces store by then was put in before.
void Integrator::begin_anew() {
  v_ = v_before_ = model_.initial_velocity();
  double stored = 0.0;
  for (const auto& interface : interfaces_) {
    stored += interface->sums().energy[ILAW_ENERGY_STORED];
    interface->clear_amounts();
  }
  accounts_ = Accounts(interfaces_.size());
  accounts_.begin_with_stored(stored);
  damping_impulse_.setZero();
  speed_before_ = largest_speed(v_, model_.dimension());
}

}  // namespace ilaw::host
