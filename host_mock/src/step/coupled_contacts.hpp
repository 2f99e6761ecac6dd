// coupled_contacts.hpp - the impulses of a step where contacts share nodes, so that each law
// depends on the impulses of the others: block Gauss-Seidel over the contacts, accelerated.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "contact/interface.hpp"
#include "step/anderson.hpp"
#include "step/colours.hpp"
#include "step/islands.hpp"

#include <string>
#include <vector>

namespace ilaw::host {

// Whether contacts must be solved together: an impulse of one may change the velocity of another, or nodes
// are driven along some axes.
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
    double energy;         // that laws may account for wrongly, as they do not agree on velocities
    double largest = 0.0;  // velocity that an impulse made on the way
  };
  // Opens the step in all interfaces, and takes v from v_free to the velocities that fulfil all
  // laws.
  Outcome solve(StepView step, Dofs& v);
  // Of the last solution: where laws agree least.
  std::string explain(const Dofs& v, const Outcome& outcome) const;

 private:
  static constexpr int patience = 20;        // sweeps without acceleration
  static constexpr int long_patience = 300;  // sweeps until the acceleration is given up

  // Steps of Newton's method after all sweeps, and how many impulses its matrix may have: with more of them a
  // step takes longer than the sweeps did.
  static constexpr int most_tangents = 30;
  static constexpr Eigen::Index most_unknowns = 300;

  // No impulse may make a speed larger than that many times the first: it would be all rounding.
  static constexpr double most_growth = 0x1p50;
  // From so many times the first speed, times the mass ratio, laws push each other up.
  static constexpr double run_away = 1e6;

  // Where no more contacts than that are not solved, laws are said to contradict each other or not to be.
  static constexpr Eigen::Index few = 50;

  struct Residual {
    double change, size;
    double relative() const { return size > 0.0 ? change / size : 0.0; }
  };
  // What sweeps go over, and the velocities that they change.
  struct Sweeping {
    const ContactGroup& group;
    const StepView& step;
    double speed;
    Dofs& v;
  };
  struct Disagreement {
    double energy;               // of all contacts
    const Interface* interface;  // of the worst; null: there is none
    int node;
    double velocity;
  };

  void open(const StepView& step);
  void iterate(const StepView& step, double speed, Dofs& v, Outcome& outcome);
  void accelerate(const Sweeping& on, Outcome& outcome);
  void search(const Sweeping& on, Outcome& outcome);
  void solve_by_tangents(const Sweeping& on, Outcome& outcome);
  void round_anew(const Sweeping& on, Outcome& outcome);
  // Evaluates every contact once, each against the impulses of the others.
  static Residual sweep(const Sweeping& on, Outcome& outcome);
  bool try_from(const Sweeping& on, const Dofs& scaled, Outcome& outcome);
  static void answer(Interface& interface, const ContactList& contacts, const StepView& step, Dofs& v);
  static Residual residual(const ContactGroup& group, double speed, const Dofs& v);
  double largest_made(const ContactGroup& group, const Dofs& scaled) const;
  static Vector since_answer(const Interface& interface, std::int32_t contact, const Dofs& v);
  Disagreement disagreement(const Dofs& v) const;
  ContactGroup island_at(int node) const;
  void move_to(const ContactGroup& group, const Dofs& scaled, Dofs& v) const;

  const Model& model_;
  Interfaces& interfaces_;
  int dimension_;
  std::vector<Colours> colours_;  // one per interface
  ContactGroup acting_;           // of the step, all of them
  Dofs v_free_;
  double out_of_reach_ = 0.0;
};

}  // namespace ilaw::host
