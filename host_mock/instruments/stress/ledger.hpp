// ledger.hpp - what a run must be held to, collected step by step.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "scene/scene.hpp"
#include "step/integrator.hpp"

#include <cstdint>
#include <limits>
#include <vector>

namespace ilaw::host {

// The few operations of each term of a bound, times what one of them rounds.
inline constexpr double rounding = 16.0 * std::numeric_limits<double>::epsilon();

// The worst of a run.
struct Worst {
  double value = 0.0;
  std::int64_t step = 0;
  int node = -1;

  void note(double found, std::int64_t at_step, int at_node) {
    if (found > value) *this = {found, at_step, at_node};
  }
};

class Ledger {
 public:
  explicit Ledger(const Scene& scene);

  // Before and after each step.
  void open(const Integrator& integrator) { v_before_ = integrator.velocity(); }
  void close(const Integrator& integrator);

  // The balance adds p.(v^- + v)/2 of all impulses to the kinetic and internal energies: per step
  // each of them is rounded, and so are the displacements that the forces come from.
  double balance_bound() const;
  // Work of impulses r and what laws say of it are rounded by |r| (|v^-| + |v_free| + H |r|), and by |r|
  // |w|/h where laws find velocities from places w that they keep; stored energies by themselves. Coupled
  // contacts agree to a tolerance of the largest speed, or to a residual, whose energy is counted.
  double added_bound(const Tally& tally) const;
  double dissipation_bound() const;
  // Rigid contact lets a node in by what it moves within a step; one that started inside goes no
  // deeper.
  const Worst& penetration() const { return penetration_; }  // beyond that at the start
  double penetration_bound() const;
  double fastest() const { return fastest_; }
  // Largest work of one impulse, by which a law that makes energy is found.
  const Worst& work() const { return work_; }
  // Holds for a linear model below its critical step: K (1 - cfl^2) <= K + I, as U_n.K U_{n+1}/2 is that of
  // the mean of both minus h^2 V.K V/8.
  double worst_velocity() const { return worst_velocity_; }

 private:
  void add(std::size_t number, const Integrator& integrator, double speed);
  void measure_depth(std::size_t number, const Integrator& integrator);
  // Relative velocities of a contact before and after the step, and the sum of the speeds that they are
  // rounded by beside themselves: of the obstacle's surface, or of the nodes.
  struct Ends {
    Vector before, after;
    double carried;
  };
  Ends ends_of(const Interface& interface, int contact, const Integrator& integrator) const;
  double size_now(const Integrator& integrator) const;
  void sample(const Integrator& integrator);

  static constexpr std::int64_t every = 16;  // steps from sample to sample

  const Scene& scene_;
  Dofs v_before_;
  std::vector<Dofs> start_depth_;  // per interface, of all nodes; empty: none is measured
  std::int64_t steps_ = 0;
  double rounded_ = 0.0, rounded_most_ = 0.0, stored_ = 0.0, solved_ = 0.0;
  double size_ = 0.0, most_kinetic_ = 0.0, farthest_ = 0.0;
  double fastest_ = 0.0, worst_velocity_ = 0.0;
  Worst penetration_, work_;
};

}  // namespace ilaw::host
