// newton.hpp - Newton's method for small islands (Alart, Curnier 1991, A mixed formulation for frictional
// contact problems prone to Newton like solution methods), with derivatives of the laws by differences: ties
// between masses that are far apart, which are linear while they hold.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "equations.hpp"
#include "sweep.hpp"

#include <cstddef>
#include <vector>

namespace ilaw::coupled {

class Newton {
 public:
  // The dense matrix has as many rows: with more of them a step takes longer than the iterations that it
  // saves.
  static constexpr std::size_t max_unknowns = 300;

  // Changes of impulses from the present ones to the solution of the linearized equations, by contact. False
  // where a law refuses or the system has no finite solution.
  bool step(const Blocks& blocks, const Problem& problem, const Sweep& sweep, std::vector<double>& changes);

 private:
  bool linearize(const Blocks& blocks, const Problem& problem, const Sweep& sweep);

  Equations equations_;
  std::vector<double> difference_;  // law's impulse less the present one
  std::vector<double> tangents_;    // 3 x 3 by columns per contact: of the law's impulse by v_free
  std::vector<double> state_;
};

}  // namespace ilaw::coupled
