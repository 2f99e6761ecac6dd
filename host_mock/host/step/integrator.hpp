// integrator.hpp - the CD-Lagrange scheme: central difference in which interfaces act by impulses.
//   U_{n+1} = U_n + h V_{n+1/2},  V_free = V_{n+1/2} + M^-1 (h f(t_{n+1}, U_{n+1}) + shocks),
//   V_{n+3/2} = V_free + M^-1 L^T r with r from the interface laws.
// Source: Fekak, Brun, Gravouil, Depale (2017); start and loads as in docs/scenes.md.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/clock.hpp"
#include "contact/interface.hpp"
#include "model/load.hpp"
#include "step/accounts.hpp"
#include "step/coupled_step.hpp"
#include "step/prestress.hpp"
#include "step/temperatures.hpp"

#include <functional>
#include <iosfwd>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

namespace ilaw::host {

// The motion, or what follows from it, is not finite, or has gone too far to tell who touches whom.
class Diverged : public std::runtime_error {
 public:
  explicit Diverged(const std::string& what) : std::runtime_error("the motion diverged: " + what) {}
};

// Wall-clock seconds spent in each phase.
struct PhaseSeconds {
  double internal_forces = 0.0, interfaces = 0.0;
};

class Integrator {
 public:
  // With a prestress the start finds the static equilibrium first. Throws std::runtime_error where it is not
  // found. begin: the time of the start.
  Integrator(const Model& model, const Loads& loads, Interfaces& interfaces, double dt,
             std::optional<PrestressSetup> prestress = {}, double begin = 0.0);

  // Residual to which coupled contacts are solved. A run that goes on from a checkpoint keeps the one it had.
  void set_tolerance(double tolerance);

  // The half step that a run starts with, from V_0 to V_{1/2}, as interfaces let it: what rests or is bonded
  // carries its load from time 0 on. The first step does it where nobody has; later calls do nothing. Throws
  // as step().
  void start();
  bool has_started() const { return has_started_; }
  // The equilibrium that a run with a prestress starts from; start() finds it where nobody has. told: of each
  // step of the search.
  void find_equilibrium(const std::function<void(const PrestressReport&)>& told = {});
  // One step. Throws ilaw::error when a law refuses a node, Diverged when the motion is not finite.
  void step();
  // Throws Diverged where the kinetic energy is far above what was put in. Each step does it, with more room.
  void check_energy(bool is_end = true) const;
  // Where step() threw: the bodies as they were before it. Nothing otherwise.
  void take_back_step();

  std::int64_t steps() const { return steps_; }
  double time() const { return time_of(steps_); }
  double time_of(std::int64_t step) const { return begin_ + static_cast<double>(step) * dt_; }
  StepTimes times_of(std::int64_t step) const {  // 0: the half step of the start
    return {step == 0 ? begin_ - 0.5 * dt_ : time_of(step - 1), time_of(step), time_of(step + 1)};
  }
  const Dofs& displacement() const { return u_; }  // at time()
  const Dofs& velocity() const { return v_; }      // at the half step after time()
  // At the half step before time(), once a step has been made.
  const Dofs& velocity_before() const { return v_before_; }
  // Impulse of the interfaces in the last step, per degree of freedom; before any, in the half step of the
  // start.
  Dofs interface_impulse() const;
  // The same of one load, added to those per degree of freedom. For a load that corrects velocities (a
  // motion, damping) it is kept from when it is first asked for.
  void keep_load_impulse(std::size_t load);
  void add_load_impulse(std::size_t load, Dofs& impulse) const;
  EnergyReport energy() const { return accounts_.energy().report(model_, u_, u_ + dt_ * v_, v_); }
  double interface_work() const { return accounts_.energy().interface_work(); }
  // At the half step after time(); components as in energy.hpp.
  Vector angular_momentum() const { return host::angular_momentum(model_, u_, v_); }
  // Null where no body has a temperature.
  const Temperatures* temperatures() const { return temperatures_ ? &*temperatures_ : nullptr; }
  // Where the start has found an equilibrium, or sought one in vain.
  const std::optional<PrestressReport>& prestressed() const { return prestressed_; }
  const PhaseSeconds& seconds() const { return seconds_; }
  const Tally& tally() const { return accounts_.tally(); }
  // By interface, when a contact of it first was not free; infinite: not yet.
  double first_contact(std::size_t interface) const { return accounts_.first_contact(interface); }
  // Where a law asked for a smaller step; empty where none did.
  std::string step_warning() const { return accounts_.step_warning(dt_); }
  // Warnings for readers of the results.
  std::vector<std::string> warnings() const { return accounts_.warnings(steps_, dt_, energy()); }

  // Everything that the next step depends on; a run that goes on from it gives the same bits.
  void save(std::ostream& out) const;
  void load(std::istream& in);

 private:
  // How many steps the time of the coming one stands for.
  int timed_steps() const;
  double move_and_kick();
  void move();
  void sum_forces(StepTimes step);
  double kick(StepTimes step);
  void correct(StepTimes step);
  Dofs transmitted(std::size_t load, StepTimes step, const Dofs& impulse) const;
  void find_contact_mass(StepTimes step);
  void add_load_reactions(StepTimes step);
  Dofs force_at_start() const;
  void add_start_kick();
  void relax(StepTimes times, bool from_rest);
  void settle(std::int64_t most_steps, const std::function<void(const PrestressReport&)>& told);
  Dofs open_impulse(bool from_rest);
  double relaxation_step() const;
  double relative_frequency(const Dofs& change) const;
  void set_step(double dt);
  void stop();
  void begin_anew();
  void hold_driven_before();
  void add_reactions(const StepView& step);
  void accept_solution(const StepView& step, const ilaw_coupled_report& solution);
  const double* contact_inverse_mass() const {
    return contact_inverse_mass_.size() > 0 ? contact_inverse_mass_.data() : inverse_mass_.data();
  }
  void check_motion(double speed, double time) const;
  void take_heat();

  const Model& model_;
  const Loads& loads_;
  Interfaces& interfaces_;
  std::optional<CoupledStep> coupled_;  // where contacts share nodes
  std::optional<Temperatures> temperatures_;
  double dt_, begin_;
  std::optional<PrestressSetup> prestress_;
  std::optional<PrestressReport> prestressed_;
  double first_residual_ = 0.0;  // of the prestress
  double relaxation_ = 0.0;      // its damping: rate times half its step; 0 in a run
  bool loads_are_steady_;
  bool transmits_steadily_;               // H is the same in all steps
  bool forces_are_steady_;                // loads are, and there are no others
  bool was_held_ = true;                  // obstacles stood still in the last step of the prestress
  std::vector<std::size_t> correcting_;   // loads in the order in which they correct velocities
  std::vector<Dofs> kept_load_impulses_;  // by load; empty where nobody asks
  std::int64_t steps_ = 0;
  bool has_started_ = false, has_begun_step_ = false;
  double speed_before_ = 0.0;  // the largest of v_
  Dofs u_, v_, v_before_, external_impulse_, damping_impulse_, internal_impulse_;
  Dofs inverse_mass_;
  // Velocity that a unit impulse of an interface makes, per degree of freedom; empty where that is
  // inverse_mass_.
  Dofs contact_inverse_mass_;
  Dofs gain_;  // of the velocities in a step, where they do not; empty without loads
  Accounts accounts_;
  PhaseSeconds seconds_;
};

}  // namespace ilaw::host
