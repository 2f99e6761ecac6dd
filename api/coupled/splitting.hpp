// splitting.hpp - Douglas-Rachford splitting of coupled contacts (Lions, Mercier 1979, Splitting algorithms
// for the sum of two nonlinear operators; as ADMM: Boyd et al. 2011; for frictional contact: Acary, Bremond,
// Huber 2018): each law alone at H = rho D, then all velocities at once by a sparse factor, in turn. Chains
// and redundant contacts, which Gauss-Seidel solves slowly, do not slow it down.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "anderson.hpp"
#include "equations.hpp"
#include "sweep.hpp"

#include <cstddef>
#include <memory>
#include <vector>

namespace ilaw::coupled {

class Splitting {
 public:
  // Rows and columns of the system: beyond, the factor takes more memory than the contacts.
  static constexpr std::size_t max_unknowns = 60000;

  Splitting();
  ~Splitting();

  // Another problem: rho begins at 1.
  void reset() { rho_ = 1.0; }
  // Begins at the present impulses, with the last rho. depth: of Anderson's acceleration, or 0. False where
  // the system is too large.
  bool open(const Blocks& blocks, const Problem& problem, const Sweep& sweep, std::size_t depth);
  // One iteration. False where a law refuses or numbers are not finite.
  bool iterate(const Blocks& blocks, const Problem& problem);
  // Largest velocity by which the two parts of the last iteration differ.
  double difference() const { return difference_; }
  // From the present impulses to those of the last iteration, by contact.
  void changes(const Blocks& blocks, std::vector<double>& changes) const;

 private:
  struct Factor;

  bool answer(const Blocks& blocks, const Problem& problem);
  void write_delassus(const Layout& layout, const double* scales, double* h) const;
  void solve_linear();
  void adapt(double primal, double dual);
  void accelerate();

  std::unique_ptr<Factor> factor_;
  Equations equations_;
  Anderson anderson_;
  std::size_t depth_ = 0, iterations_ = 0, last_adapted_ = 0, adaptations_ = 0;
  double rho_ = 1.0, difference_ = 0.0;
  bool adapted_ = false;
  // In the scales of the contacts' impulses and moments, three components of each.
  std::vector<double> free_;              // velocities without impulses
  std::vector<double> state_, next_;      // the iterated vector, and its image
  std::vector<double> law_, law_before_;  // impulses of the laws
  std::vector<double> linear_;            // impulses of the linear part
  std::vector<double> step_, correction_, law_state_;
};

}  // namespace ilaw::coupled
