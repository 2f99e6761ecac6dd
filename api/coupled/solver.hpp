// solver.hpp - a step of coupled contacts: checks, iterations until the tolerance, results.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "colours.hpp"
#include "islands.hpp"
#include "iterations.hpp"
#include "ranks.hpp"
#include "sweep.hpp"

#include <array>
#include <cstdint>
#include <vector>

namespace ilaw::coupled {

class Solver {
 public:
  // report has been cleared.
  std::int32_t solve(const ilaw_bodies* bodies, const ilaw_contacts* const* groups, std::int64_t group_count,
                     const ilaw_coupled_options& options, ilaw_coupled_report& report);

 private:
  const char* open(const ilaw_bodies* bodies, const ilaw_contacts* const* groups, std::int64_t group_count,
                   ilaw_coupled_report& report);
  const char* make_blocks(ilaw_coupled_report& report);
  bool fill(Block& block);
  const char* refuse_held_axes(ilaw_coupled_report& report);
  const char* complaint_of_overlaps(const ilaw_bodies& bodies);
  void split_shared_bodies();
  void iterate(Limits limits);
  bool release_bonds();
  // From the impulses. Returns the largest change of a velocity.
  double set_velocities();
  void find_scale(Limits& limits);
  void forget_large_impulses();
  void find_bad_contacts(ilaw_coupled_report& report) const;
  void find_stable_step(ilaw_coupled_report& report);
  // Where contacts are not solved: which is off by most, and what is coupled with it.
  void find_worst_contact(ilaw_coupled_report& report);
  double energy_error() const;
  // Describes the contacts that are coupled with the worst one.
  void explain(const Block& worst, std::size_t lane, ilaw_coupled_report& report);
  void find_opposed_laws(const Block& worst, std::size_t lane, ilaw_coupled_report& report) const;
  void describe_island(std::size_t contact, ilaw_coupled_report& report);
  std::int32_t evaluate_balance(ilaw_coupled_report& report);
  void write(ilaw_coupled_report& report);

  Sweep sweep_{problem_};  // has cache lines: first
  Ranks ranks_;
  Colours colours_;
  Blocks blocks_;
  Problem problem_;
  Iterations iterations_{problem_, ranks_, sweep_};
  Progress progress_;  // of the last solve: of the island with the largest residual
  bool has_stalled_ = false;
  std::vector<std::int32_t> order_;
  std::vector<Motion> here_, everywhere_;  // sums of impulses per body, of this rank and of all
  std::vector<double> balance_, counts_;
  // Scratch.
  std::vector<const double*> outputs_;
  std::vector<double> balance_state_;
  std::vector<ilaw_output> amounts_;
  Islands islands_;
  std::array<char, 512> message_{};
};

}  // namespace ilaw::coupled
