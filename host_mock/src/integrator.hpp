// integrator.hpp - the CD-Lagrange scheme: central difference in which interfaces act by impulses.
//   U_{n+1} = U_n + h V_{n+1/2},  V_free = V_{n+1/2} + M^-1 (h f(t_{n+1}, U_{n+1}) + shocks),
//   V_{n+3/2} = V_free + M^-1 L^T r with r from the interface laws.
// Source: Fekak, Brun, Gravouil, Depale (2017); start and loads as in docs/scenes.md.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "energy.hpp"
#include "interface.hpp"
#include "load.hpp"

#include <memory>
#include <vector>

namespace ilaw::host {

// Wall-clock seconds spent in each phase.
struct PhaseSeconds {
  double internal_forces = 0.0, interfaces = 0.0;
};

class Integrator {
 public:
  Integrator(const Model& model, const Loads& loads, std::vector<std::unique_ptr<Interface>>& interfaces,
             double dt);

  // One step. Throws ilaw::error when a law refuses a node, std::runtime_error when the motion is not finite.
  void step();

  std::int64_t steps() const { return steps_; }
  double time() const { return static_cast<double>(steps_) * dt_; }
  const Dofs& displacement() const { return u_; }             // at time()
  const Dofs& velocity() const { return v_; }                 // at the half step after time()
  const Dofs& impulse() const { return interface_impulse_; }  // of the last step, per degree of freedom
  EnergyReport energy() const;
  const PhaseSeconds& seconds() const { return seconds_; }
  double penetration_max() const { return penetration_max_; }
  std::int64_t node_steps_asked() const { return asked_; }
  // Sweeps of the last step and residual of the worst step, where interfaces share nodes.
  int sweeps_max() const { return sweeps_max_; }
  double coupling_residual_max() const { return coupling_residual_max_; }
  const std::vector<std::int64_t>& status_counts() const { return status_counts_; }

 private:
  void free_velocity(StepTimes step);
  void solve_interfaces(double time);
  double sweep(double time);
  void add_impulse(const Interface& interface, int place, double sign);
  void account();

  const Model& model_;
  const Loads& loads_;
  std::vector<std::unique_ptr<Interface>>& interfaces_;
  double dt_;
  bool coupled_;  // a node belongs to two interfaces
  std::int64_t steps_ = 0, asked_ = 0;
  Dofs u_, v_, v_before_, v_free_, external_impulse_, interface_impulse_, others_, previous_;
  EnergyBalance energy_;
  PhaseSeconds seconds_;
  double penetration_max_ = 0.0, coupling_residual_max_ = 0.0;
  int sweeps_max_ = 0;
  std::vector<std::int64_t> status_counts_;
};

}  // namespace ilaw::host
