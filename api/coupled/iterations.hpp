// iterations.hpp - iterations of Gauss-Seidel with acceleration, to the tolerance or to the largest number.
//
// Few iterations: nonlinear conjugate directions (Silcowitz, Niebe, Erleben 2010, A nonsmooth nonlinear
// conjugate gradient method for interactive contact force problems). To a tolerance: some of these, then
// island by island Anderson's acceleration; where that stalls, Newton steps and Douglas-Rachford
// splitting.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "anderson.hpp"
#include "islands.hpp"
#include "newton.hpp"
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

  // speed: the residual is relative to no smaller velocity. rounding: a change of a contact's velocity below
  // it that iterations no longer lower counts as solved.
  void begin(std::uint32_t most, double tolerance, double speed, double rounding);
  // The largest velocity of a contact without impulses, where iterations begin with some.
  void set_first_size(double size) { first_size_ = size > speed_ ? size : speed_; }
  // To the tolerance, or to the largest number of iterations since begin(). Velocities of the bodies belong
  // to the impulses, but for rounding. Returns the code of a law that failed, or ILAW_OK.
  std::int32_t run(Blocks& blocks);
  bool is_over() const { return failed_ < 0 || count_ >= most_ || size_ > max_growth * first_size_; }

  std::uint32_t count() const { return most_counted_; }
  double residual() const { return residual_; }
  std::uint32_t method() const { return method_; }
  bool has_stalled() const { return stalled_; }
  // Largest velocity of the first iteration, or without impulses, and that of the last iteration.
  double first_size() const { return first_size_; }
  double size() const { return size_; }
  double tolerance() const { return tolerance_; }
  double rounding() const { return rounding_; }
  bool is_solved() const { return !(residual_ > tolerance_) || residual_ * size_ <= rounding_; }

 private:
  // Beyond this growth of the largest velocity impulses are rounding alone: iterations end.
  static constexpr double max_growth = 0x1p50;
  // The same of one Newton step: laws that contradict each other have no finite solution.
  static constexpr double max_newton_growth = 0x1p14;
  // Iterations of the conjugate method before others; with at most `few` iterations in all there is no other.
  static constexpr std::uint32_t few = 100, first_conjugate = 30;
  // Iterations between looks for sleeping contacts that come within reach.
  static constexpr std::uint32_t wake_interval = 4;
  // Factor of the squared residual with which impulses are better than the best, and are copied.
  static constexpr double much_less = 0.25;
  // Iterations that have not lowered the change by a tenth, where that is below rounding: the last ones.
  static constexpr std::uint32_t plateau = 20;
  // Iterations of a method before another one gets its turn.
  static constexpr std::uint32_t first_part = 100;

  // One iteration, the same on all ranks. True where contacts are solved.
  bool iterate(Blocks& blocks, const Sweep::Conjugate& conjugate);
  bool accept(Change change);
  bool stays_at_rounding();
  void exchange_velocities();
  void keep_start();
  bool conjugate(Blocks& blocks, std::uint32_t most);
  // The next iteration starts from the velocities that this makes.
  void extrapolate_bodies(double beta);
  bool anderson(Blocks& blocks, std::uint32_t most);
  bool take_turns(Blocks& blocks);
  bool newton(Blocks& blocks);
  double part_to_first_opening(const Blocks& blocks) const;
  double shorten(const Blocks& blocks, double part);
  bool splitting(Blocks& blocks, std::uint32_t most, std::size_t depth);
  bool move(Blocks& blocks, const std::vector<double>& changes);
  // Scales of impulses, and of moments, three components each. Returns their number.
  std::size_t scales_of(const Blocks& blocks);
  void keep_best(Blocks& blocks);
  void note_best(const Blocks& blocks);
  bool return_to_best(Blocks& blocks);
  void read_impulses(const Blocks& blocks, std::vector<double>& impulses) const;
  void read_scaled(const Blocks& blocks);
  // Anderson and other methods in turn, until one ends.
  bool alternate(Blocks& blocks);
  void solve_islands(Blocks& blocks);
  void find_island_residuals(const Blocks& blocks, std::vector<double>& residuals);

  Problem& problem_;
  Ranks& ranks_;
  Sweep& sweep_;
  std::uint32_t most_ = 0, count_ = 0, most_counted_ = 0, method_ = ILAW_METHOD_GAUSS_SEIDEL;
  double tolerance_ = 0.0, speed_ = 0.0, rounding_ = 0.0, size_ = 0.0, first_size_ = 0.0, residual_ = 0.0,
         change_ = 0.0, square_ = 0.0;
  double least_in_first_half_ = 0.0, least_ = 0.0;
  double lowered_ = 0.0;  // the change when it last fell by a tenth
  std::uint32_t since_lowered_ = 0;
  bool stalled_ = false;
  std::int32_t failed_ = ILAW_OK;
  std::vector<Motion> start_, direction_;
  double best_square_ = 0.0;
  std::vector<double> scales_, image_, step_, correction_, best_;
  Anderson anderson_;
  Newton newton_;
  Splitting splitting_;
  Islands islands_;
  Blocks island_;
};

}  // namespace ilaw::coupled
