// The step from its top to its end, as docs/hosts.md tells it to owners of a solver.
// SPDX-License-Identifier: BSD-3-Clause
#include "step/integrator.hpp"

#include "base/stopwatch.hpp"
#include "step/dof_loops.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace ilaw::host {

void Integrator::step() {
  const StepTimes times{time(), static_cast<double>(steps_ + 1) * dt_};
  v_before_ = v_;
  for_each_dof(u_.size(), [&](Eigen::Index i) { u_[i] += dt_ * v_[i]; });  // u = u + h v
  {
    const Stopwatch watch(seconds_.internal_forces);
    sum_forces(times);  // f = f_ext - f_int(u), without any contact force
    kick(times);        // v_free = v + (h/m) f
  }
  check_motion(times.after);  // before the laws see it, too: they must not be blamed
  {
    const Stopwatch watch(seconds_.interfaces);
    add_reactions(times.after);  // r = law(v_free, 1/m, gap, state), v = v_free + r/m
  }
  check_motion(times.after);
  ++steps_;
  accounts_.add_step(model_, interfaces_,
                     {loads_.empty() ? nullptr : &external_impulse_, internal_impulse_, v_before_, v_});
}

// As impulses: shocks have no force.
void Integrator::sum_forces(StepTimes step) {
  if (!loads_.empty()) {
    external_impulse_.setZero();
    for (const auto& load : loads_) load->add_force(step.after, external_impulse_);
    external_impulse_ *= dt_;
    for (const auto& load : loads_) load->add_impulse(step, external_impulse_);
  }
  if (model_.has_internal_forces()) {
    internal_impulse_.setZero();
    model_.add_internal_forces(u_, internal_impulse_);
  }
}

void Integrator::kick(StepTimes step) {
  for_each_dof(v_.size(), [&](Eigen::Index i) {
    internal_impulse_[i] *= dt_;
    v_[i] += (external_impulse_[i] + internal_impulse_[i]) * inverse_mass_[i];
  });
  if (std::any_of(loads_.begin(), loads_.end(), [](const auto& load) { return load->corrects(); }))
    correct(step);
}

// What a load takes off or adds, times the mass, is its impulse.
void Integrator::correct(StepTimes step) {
  const Dofs uncorrected = v_;
  for (const auto& load : loads_) load->correct(step, v_before_, v_);
  external_impulse_ += model_.mass().cwiseProduct(v_ - uncorrected);
}

// Each law is evaluated once, for all its contacts together. Where contacts share nodes it is
// evaluated until all laws agree on the velocities.
void Integrator::add_reactions(double time) {
  const Eigen::Index d = model_.dimension();
  const StepView step{u_, v_before_, time, dt_, largest_speed(v_before_, d), largest_speed(v_, d)};
  if (coupled_) {
    accounts_.add_solution(coupled_->solve(step, v_));
  } else {
    for (const auto& interface : interfaces_) {
      interface->open_step(step);                        // gap, normal, delassus
      interface->gather(interface->active(), v_, step);  // v_free, v_previous: relative to the obstacle
      interface->evaluate(interface->active(), step);    // the law: impulse, state, energies, status
      interface->apply(interface->active(), v_);         // v = v_free + r/m
    }
  }
  for (const auto& interface : interfaces_) interface->accept(dt_);  // its state is that before the next step
}

void Integrator::check_motion(double time) const {
  if (v_.allFinite()) return;
  Eigen::Index dof = 0;
  while (std::isfinite(v_[dof])) ++dof;
  throw std::runtime_error("the motion diverged: velocity " + std::to_string(v_[dof]) + " at node " +
                           std::to_string(dof / model_.dimension()) + ", step " + std::to_string(steps_ + 1) +
                           ", time " + std::to_string(time));
}

}  // namespace ilaw::host
