// coupled_step.hpp - the impulses of a step where contacts share nodes, by the solver of ilaw/coupled.h: the
// nodes that contacts have are its bodies, each interface is a group.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "contact/coupled_interface.hpp"

#include <ilaw/coupled.hpp>

#include <cstdint>
#include <iosfwd>
#include <string>
#include <vector>

namespace ilaw::host {

// Whether contacts must be solved together: an impulse of one may change the velocity of another, or nodes
// are driven along some axes.
bool share_nodes(const Model& model, const Interfaces& interfaces);

class CoupledStep {
 public:
  static constexpr double default_tolerance = 1e-10;
  static constexpr std::uint32_t most_sweeps = 1000;

  CoupledStep(const Model& model, Interfaces& interfaces);

  // Of the residual of coupled contacts, in the scale of the step's velocities.
  void set_tolerance(double tolerance) { tolerance_ = tolerance; }
  double tolerance() const { return tolerance_; }
  // Takes v from v_free to the velocities that fulfil all laws. Throws ilaw::error where a law refuses.
  const ilaw_coupled_report& solve(StepView step, const double* inverse_mass, Dofs& v);
  // Why contacts of the last solve have no solution, or it is not found; empty where they are many, and
  // merely not solved yet.
  std::string explain() const;
  // Of the contact that is farthest from its law; -1: none.
  std::int64_t worst_node() const;
  // Throws where a motion drives a node against a law that cannot give way, or a law's results are
  // impossible.
  void check_results(const StepView& step, const Dofs& v) const;
  // The step is done: states are accepted.
  void accept(const StepView& step, const Dofs& v);

  // The forces with which the next step begins.
  void save(std::ostream& out) const;
  void load(std::istream& in, const Dofs& u);

 private:
  void open(const StepView& step);
  void number_bodies();
  bool forget_forces();
  double rounding_of_gaps(const StepView& step) const;
  static void ILAW_CALL run_on_threads(void*, std::uint32_t threads, ilaw_work_function part, void* work);
  ilaw_coupled_options options_of(const StepView& step, double speed) const;
  ilaw_bodies gather(const StepView& step, const double* inverse_mass, const Dofs& v);
  void refuse(const ilaw::coupled_error& refused) const;
  void scatter(const StepView& step, Dofs& v);

  const Model& model_;
  double tolerance_ = default_tolerance;
  bool has_driven_nodes_ = false;
  std::vector<CoupledInterface> interfaces_;
  std::vector<const ilaw_contacts*> given_;
  std::vector<std::int32_t> nodes_;  // of the bodies, in ascending order
  std::vector<std::int32_t> body_;   // of each node of the model; -1: no contact has it
  std::vector<double> inverse_mass_, velocity_, previous_;  // of the bodies
  Dofs v_free_;                                             // of the step, for one more solve
  ilaw::coupled solver_;
  ilaw_coupled_report report_{};
};

}  // namespace ilaw::host
