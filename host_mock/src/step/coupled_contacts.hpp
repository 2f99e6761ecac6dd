// coupled_contacts.hpp - the impulses of a step where contacts share nodes, so that each law
// depends on the impulses of the others: block Gauss-Seidel over the contacts, accelerated.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "contact/interface.hpp"
#include "step/anderson.hpp"
#include "step/colours.hpp"

#include <vector>

namespace ilaw::host {

// Whether an impulse of one contact may change the velocity of another.
bool share_nodes(const Model& model, const Interfaces& interfaces);

class CoupledContacts {
 public:
  // Sweeps stop at this residual. They are fast where contacts share few nodes; along a column of n
  // of them it takes n^2 sweeps, which are accelerated where there were some already.
  static constexpr double tolerance = 1e-14;
  static constexpr int most_sweeps = 1000;

  CoupledContacts(const Model& model, Interfaces& interfaces);

  struct Outcome {
    int sweeps;
    double residual;
  };
  // Opens the step in all interfaces, and takes v from v_free to the velocities that fulfil all
  // laws.
  Outcome solve(StepView step, Dofs& v);

 private:
  static constexpr int patience = 20;  // sweeps without acceleration

  void open(const StepView& step);
  double iterate(const StepView& step, double speed, Dofs& v, Outcome& outcome);
  double sweep(const StepView& step, Dofs& v);
  double residual(double speed, const Dofs& v) const;
  std::vector<double> scaled_impulses() const;
  double accelerate(Anderson& anderson, std::vector<double>& impulses_before, Dofs& v);
  template <class Visit>
  void for_each_acting(Visit visit) const;

  Interfaces& interfaces_;
  std::vector<Colours> colours_;  // one per interface
};

}  // namespace ilaw::host
