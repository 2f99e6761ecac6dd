// Dynamic relaxation: steps of the scheme with loads and obstacles of time 0, and with a damping by mass that
// is critical for the motion that there is (P. Underwood, Dynamic relaxation, 1983). Its frequency is the
// Rayleigh quotient of the last increment of displacements, to which stiff interfaces contribute, too. The
// step is the relaxation's own, so that the step of the run does not matter. Bodies at rest tell how far they
// are from equilibrium: the forces that remain.
// SPDX-License-Identifier: BSD-3-Clause
#include "base/stop_request.hpp"
#include "base/words.hpp"
#include "step/dof_loops.hpp"
#include "step/integrator.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace ilaw::host {

// Impulses of the last relaxation step that no other balances. Driven nodes have the reaction of their
// motion. Half steps from rest count as whole ones. Without loads and contact they are relative to those at
// the beginning.
Dofs Integrator::open_impulse(bool from_rest) {
  const Dofs contact = interface_impulse();
  const double whole = from_rest ? 2.0 : 1.0, of_loads = loads_are_steady_ ? 1.0 : whole;
  Dofs open = whole * contact;
  double largest = open.norm();
  if (internal_impulse_.size() > 0) open += whole * internal_impulse_;
  if (external_impulse_.size() > 0) {
    open += of_loads * external_impulse_;
    largest = std::max(largest, of_loads * external_impulse_.norm());
  }
  if (first_residual_ == 0.0) first_residual_ = open.norm() / dt_;
  if (largest == 0.0) largest = first_residual_ * dt_;
  prestressed_->residual = largest > 0.0 ? open.norm() / largest : 0.0;
  return open;
}

// A step of the relaxation: obstacles and motions stand still where times.until is times.after. From rest it
// has half a step of the velocity, like the start of a run: a whole one would make fast vibrations grow.
void Integrator::relax(StepTimes times, bool from_rest) {
  if (stop_requested()) {
    stop();  // the speed of a relaxation is no motion of the run
    throw Interrupted("the prestress was interrupted");
  }
  has_begun_step_ = true;
  v_before_.swap(v_);
  move();
  sum_forces(times);
  if (from_rest) {
    internal_impulse_ *= 0.5;
    if (!loads_are_steady_) external_impulse_ *= 0.5;
  }
  kick(times);
  if (from_rest && loads_are_steady_ && !loads_.empty())
    v_ -= 0.5 * external_impulse_.cwiseProduct(inverse_mass_);
  if (relaxation_ > 0.0) {
    const Dofs undamped = v_;
    Dofs none = Dofs::Zero(v_.size());
    v_ = (v_ - relaxation_ * v_before_) / (1.0 + relaxation_);
    leave_driven_undamped(loads_, model_.dimension(), undamped, v_, none);
  }
  const double speed_free = largest_speed(v_, model_.dimension());
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
  ++prestressed_->steps;
}

// 0.97 of the critical step, of bodies and of the interfaces that were met, as if all were at one node.
double Integrator::relaxation_step() const {
  const auto inverse_square = [](double step) { return 1.0 / (step * step); };
  double squares = inverse_square(critical_step(model_, loads_, {u_, v_})) +
                   inverse_square(accounts_.tally().stable_step);  // of coupled contacts
  for (const auto& interface : interfaces_) squares += inverse_square(interface->sums().stable_step);
  return squares > 0.0 ? 0.97 / std::sqrt(squares) : dt_;
}

void Integrator::set_step(double dt) {
  dt_ = dt;
  if (loads_are_steady_ && !loads_.empty()) external_impulse_ = dt_ * force_at_start();
}

// The frequency of the last increment, times the step; change: of the open impulses.
double Integrator::relative_frequency(const Dofs& change) const {
  const double inertia = v_before_.dot(model_.mass().cwiseProduct(v_before_));
  return inertia > 0.0 ? std::sqrt(std::max(0.0, -v_before_.dot(change) / inertia)) : 0.0;
}

// Damped steps from rest until the open impulses are well below the tolerance.
void Integrator::settle(std::int64_t most_steps, const std::function<void(const PrestressReport&)>& told) {
  constexpr double below_tolerance = 0.9, most_relative_frequency = 1.99;  // 2 is unstable
  Dofs before;
  bool from_rest = true;
  set_step(relaxation_step());
  while (prestressed_->steps < most_steps) {
    if (from_rest) stop();
    relax({-dt_, 0.0, 0.0}, from_rest);
    const Dofs open = open_impulse(from_rest);
    if (told) told(*prestressed_);
    if (!from_rest && prestressed_->residual <= below_tolerance * prestress_->tolerance) break;
    const double relative = from_rest ? 0.0 : relative_frequency(open - before);
    double step = std::min(dt_, relaxation_step());
    if (relative > most_relative_frequency) step = std::min(step, 0.7 * dt_);
    from_rest = step < 0.999 * dt_;
    if (from_rest) set_step(step);
    relaxation_ = from_rest ? 0.0 : std::min(relative, 1.0);
    before = open;
  }
  stop();
}

void Integrator::find_equilibrium(const std::function<void(const PrestressReport&)>& told) {
  if (!prestress_ || prestressed_) return;
  const double dt = dt_;
  const auto ramp_steps = static_cast<std::int64_t>(std::ceil(prestress_->ramp / dt * (1.0 - 1e-12)));
  const std::int64_t most_steps = ramp_steps + prestress_->steps;
  PrestressReport& found = prestressed_.emplace();
  stop();
  const auto time_at = [&](std::int64_t step) {
    return -dt * static_cast<double>(std::max<std::int64_t>(ramp_steps - step, 0));
  };
  while (ramp_steps > 0 && found.steps <= ramp_steps) {  // the last step moves what moves to its place
    const std::int64_t step = found.steps;
    relax({time_at(step - 1), time_at(step), time_at(step + 1)}, step == 0);
    if (told) told(found);
  }
  const std::vector<std::size_t> correcting = correcting_;
  std::erase_if(correcting_,
                [this](std::size_t k) { return loads_[k]->damps(); });  // the relaxation has its own
  while (true) {
    stop();
    relax({-dt, 0.0, 0.0}, true);  // with the step of the run, which goes on from it
    open_impulse(true);
    if (found.residual <= prestress_->tolerance || found.steps > most_steps) break;
    settle(most_steps, told);
    set_step(dt);
  }
  correcting_ = correcting;
  if (found.residual <= prestress_->tolerance) return begin_anew();
  throw std::runtime_error(
      formatted("no static equilibrium after %lld steps of 'prestress': residual %.3g, expected at most %g",
                static_cast<long long>(found.steps), found.residual, prestress_->tolerance));
}

void Integrator::stop() {
  v_.setZero();
  speed_before_ = 0.0;
  relaxation_ = 0.0;
}

// The clock is at 0, bodies have the velocities of the scene, and the accounts begin. The energy that
// interfaces store by then was put in before.
void Integrator::begin_anew() {
  v_ = v_before_ = model_.initial_velocity();
  double stored = 0.0;
  for (const auto& interface : interfaces_) {
    stored += interface->sums().energy[ILAW_ENERGY_STORED];
    interface->clear_amounts();
    interface->set_inverse_mass(inverse_mass_.data());
  }
  contact_inverse_mass_.resize(0);  // the damping is gone
  accounts_ = Accounts(interfaces_.size());
  accounts_.begin_with_stored(stored);
  damping_impulse_.setZero();
  speed_before_ = largest_speed(v_, model_.dimension());
}

}  // namespace ilaw::host
