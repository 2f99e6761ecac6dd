// energy.hpp - the discrete energy balance of central difference, which closes to rounding for any law.
//   E_n = 1/2 V_{n+1/2}^T M V_{n+1/2} + internal(U_n, U_{n+1}),   E_{n+1} - E_n = (W_ext + W_int) of the
//   step, with the work of an impulse p over a step p . (V_{n+1/2} + V_{n+3/2})/2.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "model.hpp"

#include <ilaw/ilaw.h>

#include <array>

namespace ilaw::host {

struct EnergyReport {
  double kinetic, internal, external_work, interface_work, balance_error;
  std::array<double, ILAW_ENERGY_COUNT> by_law;  // friction, impact, rupture dissipated; stored now
  double least_dissipation;                      // smallest dissipation of one node in one step, >= 0
  double reaction_work;                          // interface_work + dissipated + stored: see docs/host.md
};

class EnergyBalance {
 public:
  // The state (U_0, V_{1/2}) and U_1 that follows from it.
  void start(const Model& model, const Dofs& u, const Dofs& u_next, const Dofs& v);

  // One step: velocities at its ends; external and interface impulses.
  void add_step(const Dofs& v_before, const Dofs& v_after, const Dofs& external, const Dofs& interface);
  void add_dissipation(int part, double energy);
  void set_stored(double energy) { by_law_[ILAW_ENERGY_STORED] = energy; }
  // Work done by the laws on the bodies relative to moving obstacles, to compare with what the laws
  // dissipated.
  void add_relative_work(double work) { relative_work_ += work; }

  EnergyReport report(const Model& model, const Dofs& u, const Dofs& u_next, const Dofs& v) const;

 private:
  // Extended precision: the sums run over millions of steps and must close to 1e-12.
  using Sum = long double;
  Sum initial_ = 0, external_work_ = 0, interface_work_ = 0, relative_work_ = 0;
  std::array<Sum, ILAW_ENERGY_COUNT> by_law_{};
  double least_dissipation_ = 0.0;
  double largest_ = 0.0;  // of the energies and works met so far
};

}  // namespace ilaw::host
