// accounts.hpp - what a run adds up step by step: the energy balance, and counts of what happened.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "contact/interface.hpp"
#include "step/energy.hpp"

#include <ilaw/coupled.h>

#include <array>
#include <cstdint>
#include <iosfwd>
#include <limits>
#include <string>
#include <vector>

namespace ilaw::host {

// Counts and extremes so far.
struct Tally {
  std::int64_t active = 0, skipped = 0;  // node-steps
  std::int64_t sweeps = 0;               // over all steps
  std::int64_t unconverged = 0;          // steps that ended above the tolerance
  int sweeps_max = 0;
  std::int64_t worst_node = -1;        // of the contact with the largest residual of such a step
  double coupling_residual_max = 0.0;  // at the end of any step
  double coupling_tolerance = 0.0;     // of that; 0: no contacts are coupled
  double coupling_energy = 0.0;        // that laws may account for wrongly, over all steps
  double penetration_max = 0.0;
  std::int64_t left_surface = 0;  // nodes that went over the border of a surface while they touched it
  double stable_step = std::numeric_limits<double>::infinity();   // the least that a law asked for
  double viscous_step = std::numeric_limits<double>::infinity();  // the least that bulk viscosity allowed
  std::array<std::int64_t, ILAW_STATUS_COUNT> status_counts{};
};

// A step that is done: its impulses per degree of freedom, and the velocities at its ends.
struct StepRecord {
  long double external_work;
  const Dofs* damping_impulse;  // null: none
  const Dofs &internal_impulse, &v_before, &v;
  double speed;  // the largest of v_free and v
  double time;
};

class Accounts {
 public:
  // The state (U_0, V_{1/2}) and U_1 that follows from it.
  explicit Accounts(std::size_t interface_count = 0)
      : first_contact_(interface_count, std::numeric_limits<double>::infinity()) {}
  void start(const Model& model, const Dofs& u, const Dofs& u_next, const Dofs& v);
  // Energy that interfaces stored before: they do not put it in later.
  void begin_with_stored(double energy) { energy_.begin_with_stored(energy); }
  // The work of interfaces at the start is part of that state already. speed: the largest then.
  void add_start(const Interfaces& interfaces, double speed);
  // worst_node: of the contact that is farthest from its law.
  void add_solution(const ilaw_coupled_report& solution, double tolerance, std::int64_t worst_node);
  void note_viscous_step(double step) { tally_.viscous_step = std::min(tally_.viscous_step, step); }
  // Whether contacts that do not agree change the energy by more than a small part of it.
  bool is_wrong(const Model& model, const ilaw_coupled_report& solution, const Dofs& v_before) const;
  void add_step(const Model& model, const Interfaces& interfaces, const StepRecord& step);

  // Whether the kinetic energy is far above all that was put in; speed: the largest. Less is allowed at the
  // end of a run.
  bool has_diverged(const Model& model, const Dofs& v, double speed, double dt, std::int64_t steps,
                    bool is_end) const;

  const EnergyBalance& energy() const { return energy_; }
  const Tally& tally() const { return tally_; }
  // Time of the first step in which a contact of an interface was not free; infinite: none yet.
  double first_contact(std::size_t interface) const { return first_contact_[interface]; }
  std::string step_warning(double dt) const;
  // Warnings for readers of the results.
  std::vector<std::string> warnings(std::int64_t steps, double dt, const EnergyReport& energy) const;

  void save(std::ostream& out) const;
  void load(std::istream& in);

 private:
  void add_energies(const Interfaces& interfaces);
  void add_counts(const Interface& interface);
  void note_rounding(double speed);
  void note_contacts(const Interfaces& interfaces, double time);

  EnergyBalance energy_;
  double total_mass_ = 0.0;
  double rounding_energy_ = 0.0;  // that reactions may leave, over all steps
  Tally tally_;
  std::vector<double> first_contact_;  // by interface
};

}  // namespace ilaw::host
