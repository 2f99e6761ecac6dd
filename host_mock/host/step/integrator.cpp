// The step from its top to its end, as docs/hosts tells it to owners of a solver.
// SPDX-License-Identifier: BSD-3-Clause
#include "step/integrator.hpp"

#include "base/words.hpp"
#include "model/elements.hpp"
#include "step/dof_loops.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace ilaw::host {
namespace {

// The vector that shows the divergence best, and its name.
struct WildMotion {
  const char* name;
  const Dofs& wild;
  const Model& model;
  const Dofs& u;
  double time, dt;
  std::int64_t step;
};

[[noreturn]] void explain_divergence(const WildMotion& motion) {
  const Dofs& wild = motion.wild;
  Eigen::Index dof = 0, largest = 0;
  wild.cwiseAbs().maxCoeff(&largest);
  while (dof < wild.size() && std::isfinite(wild[dof])) ++dof;
  if (dof == wild.size()) dof = largest;
  // With an exponent: it may have 300 digits.
  throw Diverged(motion.name + formatted(" %g", wild[dof]) + " at node " +
                 std::to_string(dof / motion.model.dimension()) + ", step " + std::to_string(motion.step) +
                 ", time " + std::to_string(motion.time) +
                 advice_on_divergence(motion.model, motion.u, motion.dt));
}

}  // namespace

void leave_driven_undamped(const Loads& loads, Eigen::Index d, const Dofs& undamped, Dofs& v, Dofs& impulse) {
  for (const auto& load : loads)
    for (const int node : load->prescribed_nodes())
      for (const int axis : load->prescribed_axes()) {
        v[node * d + axis] = undamped[node * d + axis];
        impulse[node * d + axis] = 0.0;
      }
}

void Integrator::step() {
  start();
  const StepTimes times = times_of(steps_ + 1);
  Laps laps(timed_steps());
  has_begun_step_ = true;
  v_before_.swap(v_);       // v is written anew from here on
  double speed_free = 0.0;  // the largest, of v_free
  if (forces_are_steady_) {
    speed_free = move_and_kick();  // as below: nothing lies between both
  } else {
    move();                    // u = u + h v
    sum_forces(times);         // f = f_ext - f_int(u), without any contact force
    speed_free = kick(times);  // v_free = v + (h/m) f
  }
  check_motion(speed_free, times.after);  // before the laws see it, too: they must not be blamed
  laps.add_to(seconds_.internal_forces);
  if (!transmits_steadily_ && !interfaces_.empty()) find_contact_mass(times);
  if (temperatures_) temperatures_->conduct(times);  // T_free = T + C^-1 h (q - K T)
  // r = law(v_free, H, gap, state, T_free), v = v_free + H r
  StepView view{u_, v_before_, times.after, dt_, speed_before_, speed_free, steps_ + 1};
  view.since = times.before;  // to the bit, so that obstacles come at the velocity that the last step saw
  view.until = times.until;
  add_reactions(view);
  if (contact_inverse_mass_.size() > 0) add_load_reactions(times);
  laps.add_to(seconds_.interfaces);
  const WorkAndSpeed external = work_and_speed(external_impulse_, v_before_, v_, model_.dimension());
  speed_before_ = external.speed;
  check_motion(speed_before_, times.after);
  if (temperatures_) take_heat();  // T = T_free + C^-1 Q
  ++steps_;
  has_begun_step_ = false;
  accounts_.add_step(model_, interfaces_,
                     {external.work, damping_impulse_.size() == 0 ? nullptr : &damping_impulse_,
                      internal_impulse_, v_before_, v_, std::max(speed_free, speed_before_), times.after});
  check_energy(false);
}

// A failed run reports its last complete step.
void Integrator::take_back_step() {
  if (!has_begun_step_) return;
  v_ = v_before_;
  u_ -= dt_ * v_;
  has_begun_step_ = false;
}

// Reading the clock takes a good part of a step with few nodes: after the first steps, one in a period is
// timed for all of them.
int Integrator::timed_steps() const {
  constexpr int period = 16;
  constexpr Eigen::Index most_timed_always = 100;
  if (u_.size() > most_timed_always || steps_ < period) return 1;
  return steps_ % period == 0 ? period : 0;
}

void Integrator::move() {
  for_each_part(u_.size(),
                [u = u_.data(), v = v_before_.data(), h = dt_](Eigen::Index first, Eigen::Index end) {
#pragma omp simd
                  for (Eigen::Index i = first; i < end; ++i) u[i] += h * v[i];
                });
}

// Each node at once, where forces are the same in all steps: memory gives and takes it once.
double Integrator::move_and_kick() {
  return std::sqrt(largest_of_parts(v_.size(), [&](Eigen::Index first, Eigen::Index end) {
    double *const u = u_.data(), *const v = v_.data();
    const double *const before = v_before_.data(), *const gain = gain_.data(), h = dt_;
    const bool pushed = !loads_.empty();
#pragma omp simd
    for (Eigen::Index i = first; i < end; ++i) {
      u[i] += h * before[i];
      v[i] = pushed ? before[i] + gain[i] : before[i];
    }
    return largest_square(v_, model_.dimension(), first, end);
  }));
}

// As impulses: shocks have no force. Impulses that no load changes are summed once.
void Integrator::sum_forces(StepTimes step) {
  if (!loads_are_steady_) {
    const auto each = [&](auto change) {
      for_each_part(external_impulse_.size(), [&](Eigen::Index first, Eigen::Index end) {
        for (Eigen::Index i = first; i < end; ++i) change(external_impulse_[i]);
      });
    };
    each([](double& impulse) { impulse = 0.0; });
    for (const auto& load : loads_) load->add_force(step.after, u_, external_impulse_);
    each([h = dt_](double& impulse) { impulse *= h; });
    for (const auto& load : loads_) load->add_impulse(step, external_impulse_);
  }
  if (model_.has_internal_forces()) {
    internal_impulse_.setZero();
    model_.add_internal_forces(u_, internal_impulse_);
  }
}

// Returns the largest speed.
double Integrator::kick(StepTimes step) {
  const bool pushed = !loads_.empty(), deformed = model_.has_internal_forces();
  const Eigen::Index d = model_.dimension();
  const double speed = std::sqrt(largest_of_parts(v_.size(), [&](Eigen::Index first, Eigen::Index end) {
    for (Eigen::Index i = first; deformed && i < end; ++i) internal_impulse_[i] *= dt_;
    if (pushed && deformed)
      for (Eigen::Index i = first; i < end; ++i)
        v_[i] = v_before_[i] + (external_impulse_[i] + internal_impulse_[i]) * inverse_mass_[i];
    else {
      double* const v = v_.data();
      const double* const before = v_before_.data();
      const double* const impulse = (pushed ? external_impulse_ : internal_impulse_).data();
      const double* const inverse = inverse_mass_.data();
#pragma omp simd
      for (Eigen::Index i = first; i < end; ++i) v[i] = before[i] + impulse[i] * inverse[i];
    }
    return largest_square(v_, d, first, end);
  }));
  if (correcting_.empty()) return speed;
  correct(step);
  return largest_speed(v_, d);
}

// Damping works apart from the other loads. Damping by mass comes after dampers and does not act along driven
// axes. A motion comes last, so that the holder of a node takes the whole reaction.
void Integrator::correct(StepTimes step) {
  damping_impulse_.setZero();
  Dofs alone;
  for (const std::size_t k : correcting_) {
    const bool spares_driven = !loads_[k]->acts_on_driven();
    Dofs& sum = loads_[k]->damps() ? damping_impulse_ : external_impulse_;
    Dofs& own = kept_load_impulses_[k].size() != 0 ? kept_load_impulses_[k] : spares_driven ? alone : sum;
    if (&own != &sum) own.setZero(v_.size());
    const Dofs undamped = spares_driven ? v_ : Dofs();
    loads_[k]->correct(step, {u_, v_before_}, v_, own);
    if (spares_driven) leave_driven_undamped(loads_, model_.dimension(), undamped, v_, own);
    if (&own != &sum) sum += own;
  }
  if (const double step_limit = critical_step(model_, loads_, {u_, v_before_});
      step_limit < model_.critical_step())
    accounts_.note_viscous_step(step_limit);
}

// An impulse after a load. Damping by mass leaves all of it along driven axes, where a motion takes it.
Dofs Integrator::transmitted(std::size_t load, StepTimes step, const Dofs& impulse) const {
  Dofs left = impulse;
  loads_[load]->transmit(step, left);
  if (loads_[load]->acts_on_driven()) return left;
  Dofs none = Dofs::Zero(impulse.size());
  leave_driven_undamped(loads_, model_.dimension(), impulse, left, none);
  return left;
}

// Interfaces act after the loads that correct velocities: H is 1/m times what those leave of a unit impulse,
// 1/(m (1 + a)) with damping, a = rate h/2, and 0 where a motion drives.
void Integrator::find_contact_mass(StepTimes step) {
  Dofs left = Dofs::Constant(u_.size(), 1.0 / (1.0 + relaxation_));
  for (const std::size_t k : correcting_) left = transmitted(k, step, left);
  if (contact_inverse_mass_.size() == 0 && (left.array() == 1.0).all()) return;
  contact_inverse_mass_ = left.cwiseProduct(inverse_mass_);
  for (const auto& interface : interfaces_) interface->set_inverse_mass(contact_inverse_mass_.data());
}

// Loads that correct velocities take their part of the impulses of interfaces: the damper's force follows
// from the final velocity, and the holder of a driven node bears what acts on it.
void Integrator::add_load_reactions(StepTimes step) {
  Dofs impulse = interface_impulse();
  for (const std::size_t k : correcting_) {
    const Dofs left = transmitted(k, step, impulse), taken = left - impulse;
    (loads_[k]->damps() ? damping_impulse_ : external_impulse_) += taken;
    if (Dofs& kept = kept_load_impulses_[k]; kept.size() != 0) kept += taken;
    impulse = left;
  }
}

// Where no two contacts share a node, each law is evaluated once: for blocks of contacts the
// interface finds gaps, normals and H, passes v_free and v_before relative to the obstacle, takes
// impulses, states and energies, and adds H r. Where some do, laws are evaluated until all agree. A
// law that is given no gap or normal, as bodies are gone too far, is not to be blamed.
void Integrator::add_reactions(const StepView& step) try {
  if (coupled_)
    accept_solution(step, coupled_->solve(step, contact_inverse_mass(), v_));
  else
    for (const auto& interface : interfaces_) interface->solve(step, v_);
} catch (const ilaw::error&) {
  for (const auto& interface : interfaces_)
    if (interface->has_lost_a_node(u_, step.time))
      explain_divergence({"displacement", u_, model_, u_, step.time, dt_, step.number});
  throw;
}

// What ends the run does so before states are accepted.
void Integrator::accept_solution(const StepView& step, const ilaw_coupled_report& solution) {
  coupled_->check_results(step, v_);
  if (solution.other_law || accounts_.is_wrong(model_, solution, v_before_))
    if (const std::string why = coupled_->explain(); !why.empty()) throw std::runtime_error(why);
  check_motion(largest_speed(v_, model_.dimension()), step.time);
  coupled_->accept(step, v_);
  accounts_.add_solution(solution, coupled_->tolerance(), coupled_->worst_node());
}

void Integrator::take_heat() {
  if (temperatures_->take(interfaces_)) return;
  throw Diverged("a temperature is not finite, step " + std::to_string(steps_ + 1));
}

// An unstable step closes its energy balance, too: what the bodies gain in motion they lose in stored energy.
void Integrator::check_energy(bool is_end) const {
  if (!accounts_.has_diverged(model_, v_, speed_before_, dt_, steps_, is_end)) return;
  throw Diverged(formatted("the kinetic energy is %.3g, where %.3g was put in, step %lld, time %g",
                           kinetic_energy(model_, v_), accounts_.energy().put_in(),
                           static_cast<long long>(steps_), time()) +
                 advice_on_divergence(model_, u_, dt_));
}

// A speed whose square is infinite has no kinetic energy, either.
void Integrator::check_motion(double speed, double time) const {
  if (!std::isfinite(speed)) explain_divergence({"velocity", v_, model_, u_, time, dt_, steps_ + 1});
}

}  // namespace ilaw::host
