// iterations.hpp - iterations of Gauss-Seidel with acceleration, to the tolerance or to the largest number.
//
// Few iterations: nonlinear conjugate directions (Silcowitz, Niebe, Erleben 2010, A nonsmooth nonlinear
// conjugate gradient method for interactive contact force problems). To a tolerance: some of these, then
// island by island Anderson's acceleration; where that stalls, Newton steps and Douglas-Rachford splitting.
// An accelerated iterate is taken only where the change that a plain iteration makes there is smaller than
// before; otherwise the plain iterate goes on. Changes are compared with velocities that the problem brings,
// so that impulses that run away do not make their own residual small.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "anderson.hpp"
#include "islands.hpp"
#include "newton.hpp"
#include "progress.hpp"
#include "ranks.hpp"
#include "splitting.hpp"
#include "sweep.hpp"

#include <cstdint>
#include <vector>

namespace ilaw::coupled {

class Iterations {
 public:
  Iterations(Problem& problem, Ranks& ranks, Sweep& sweep)
      : problem_(problem), ranks_(ranks), sweep_(sweep) {}

  // Goes on from this progress with all contacts: velocities of the bodies belong to the impulses, but for
  // rounding. Returns that of the island with the largest residual; stalled: whether any has.
  Progress run(Blocks& blocks, Progress progress, bool& stalled);

 private:
  // The same of one Newton step: laws that contradict each other have no finite solution.
  static constexpr double max_newton_growth = 0x1p14;
  // With at most so many iterations in all there is no method but the conjugate one.
  static constexpr std::uint32_t few = 100;
  // With few iterations, but not fewer than this, islands of up to so many contacts whose residual is above
  // this take up to so many Newton steps. Closer ones keep what they have: among the solutions of redundant
  // contacts iterations find one near that of the step before.
  static constexpr std::uint32_t least_few = 10, most_direct = 20;
  static constexpr std::size_t small_island = 32;
  static constexpr double far_off = 1e-3;
  // Times the momentum of the bodies: larger impulses press contacts against each other.
  static constexpr double near = 16.0;
  // Factor of the change with which impulses are better than the best, and are copied.
  static constexpr double much_less = 0.5;

  // The impulses with the least error, by contact.
  struct Best {
    double error = Progress::infinity;
    std::vector<double> impulses;
    std::vector<double> far_ones;  // that solve the problem, but run away; empty: none
  };

  // One plain iteration, the same on all ranks.
  void iterate(Blocks& blocks, Progress& progress, const Sweep::Conjugate& conjugate = {});
  Outcome begin_again(Blocks& blocks, Progress& progress);
  Outcome conjugate(Blocks& blocks, Progress& progress, std::uint32_t most);
  Outcome solve_islands(Blocks& blocks, Progress& progress, bool& stalled);
  Outcome solve_directly(Blocks& blocks, Progress& progress);
  Outcome solve_island(Blocks& blocks, Progress& progress);
  Outcome take_turns(Blocks& blocks, Progress& progress, Best& best);
  Outcome anderson(Blocks& blocks, Progress& progress, std::uint32_t most, Best& best);
  Outcome newton(Blocks& blocks, Progress& progress);
  bool runs_away(const Blocks& blocks, const Progress& progress);
  bool exceeds_momentum(const Blocks& blocks, const Progress& progress);
  bool grow_without_end(Blocks& blocks, Progress& progress);
  bool grows_along_normals(const Blocks& blocks) const;
  bool stops(const Block& block) const;
  bool follow_growth(Blocks& blocks, Progress& progress);
  Outcome splitting(Blocks& blocks, Progress& progress, std::uint32_t most, std::size_t depth);

  // The next iteration starts from the velocities that this makes.
  void extrapolate_bodies(double beta);
  double part_to_first_opening(const Blocks& blocks) const;
  double shorten(const Blocks& blocks, double part);
  // Moves impulses, by contact, and iterates once from there.
  void move(Blocks& blocks, Progress& progress, const std::vector<double>& changes);
  void add_changes(Blocks& blocks, const std::vector<double>& changes);
  void keep_best(Blocks& blocks, Progress& progress, Best& best);
  void return_to(Blocks& blocks, Progress& progress, const std::vector<double>& impulses);
  void read_impulses(const Blocks& blocks, std::vector<double>& impulses) const;
  void read_scaled(const Blocks& blocks);
  // To the impulses that read_scaled read.
  void return_to_image(Blocks& blocks);
  // Scales of impulses, and of moments, three components each. Returns their number.
  std::size_t scales_of(const Blocks& blocks);
  void exchange_velocities();
  void keep_start();
  std::vector<Progress> progress_of_islands(const Blocks& blocks, const Progress& progress) const;

  Problem& problem_;
  Ranks& ranks_;
  Sweep& sweep_;
  // Work arrays, whose values no method leaves to another one.
  std::vector<Motion> start_, direction_;
  std::vector<double> scales_, image_, step_, correction_;
  Anderson anderson_;
  Newton newton_;
  Splitting splitting_;
  Islands islands_;
  Blocks island_;
};

}  // namespace ilaw::coupled
