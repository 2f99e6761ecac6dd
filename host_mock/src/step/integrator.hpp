// integrator.hpp - the CD-Lagrange scheme: central difference in which interfaces act by impulses.
//   U_{n+1} = U_n + h V_{n+1/2},  V_free = V_{n+1/2} + M^-1 (h f(t_{n+1}, U_{n+1}) + shocks),
//   V_{n+3/2} = V_free + M^-1 L^T r with r from the interface laws.
// Source: Fekak, Brun, Gravouil, Depale (2017); start and loads as in docs/scenes.md.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "contact/interface.hpp"
#include "model/load.hpp"
#include "step/anderson.hpp"
#include "step/energy.hpp"

#include <iosfwd>
#include <memory>
#include <string>
#include <vector>

namespace ilaw::host {

// Wall-clock seconds spent in each phase.
struct PhaseSeconds {
  double internal_forces = 0.0, interfaces = 0.0;
};

// What happened so far.
struct Tally {
  std::int64_t active = 0, skipped = 0;  // node-steps
  std::int64_t sweeps = 0;               // over all steps
  std::int64_t unconverged = 0;          // steps that ended above the tolerance
  int sweeps_max = 0;
  double coupling_residual_max = 0.0;  // at the end of any step: see Integrator::residual
  double penetration_max = 0.0;
  std::array<std::int64_t, ILAW_STATUS_COUNT> status_counts{};
};

class Integrator {
 public:
  Integrator(const Model& model, const Loads& loads, std::vector<std::unique_ptr<Interface>>& interfaces,
             double dt);

  // One step. Throws ilaw::error when a law refuses a node, std::runtime_error when the motion is not finite.
  void step();

  std::int64_t steps() const { return steps_; }
  double time() const { return static_cast<double>(steps_) * dt_; }
  const Dofs& displacement() const { return u_; }  // at time()
  const Dofs& velocity() const { return v_; }      // at the half step after time()
  // Impulse of the interfaces in the last step, per degree of freedom.
  Dofs interface_impulse() const;
  EnergyReport energy() const;
  // About the origin, at the half step after time(): one component in 2D, three in 3D, none in 1D.
  Vector angular_momentum() const;
  const PhaseSeconds& seconds() const { return seconds_; }
  const Tally& tally() const { return tally_; }
  // What a reader of the results must know.
  std::vector<std::string> warnings() const;

  // Everything that the next step depends on; a run that goes on from it gives the same bits.
  void save(std::ostream& out) const;
  void load(std::istream& in);

 private:
  void free_velocity(StepTimes step);
  void correct(StepTimes step);
  void solve_interfaces(double time);
  void solve_coupled(StepView step);
  void open_interfaces(const StepView& step);
  double sweep(const StepView& step);
  double residual(double speed) const;
  std::vector<double> impulses() const;
  double accelerate(Anderson& anderson, std::vector<double>& impulses_before);
  void account();
  void account(const Interface& interface);
  void check_motion(double time) const;

  const Model& model_;
  const Loads& loads_;
  std::vector<std::unique_ptr<Interface>>& interfaces_;
  double dt_;
  bool coupled_, corrects_;
  std::int64_t steps_ = 0;
  Dofs u_, v_, v_before_, external_impulse_, internal_impulse_;
  Dofs inverse_mass_;
  EnergyBalance energy_;
  PhaseSeconds seconds_;
  Tally tally_;
};

}  // namespace ilaw::host
