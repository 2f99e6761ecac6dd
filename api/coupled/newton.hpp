// newton.hpp - Newton's method (Alart, Curnier 1991, A mixed formulation for frictional contact problems
// prone to Newton like solution methods), with derivatives of the laws by differences and a sparse factor:
// ties between masses that are far apart, long columns, redundant contacts.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "equations.hpp"
#include "sweep.hpp"

#include <cstddef>
#include <memory>
#include <vector>

namespace ilaw::coupled {

class Newton {
 public:
  // Rows of the sparse system: with more of them a step takes longer than the iterations that it saves.
  static constexpr std::size_t max_unknowns = 4000;

  Newton();
  ~Newton();

  // Changes of impulses from the present ones to the solution of the linearized equations, by contact. False
  // where a law refuses, or the system is too large or has no finite solution.
  bool step(const Blocks& blocks, const Problem& problem, const Sweep& sweep, double delta,
            std::vector<double>& changes);

 private:
  struct Contact;
  struct System;

  bool linearize(const Blocks& blocks, const Problem& problem, const Sweep& sweep);
  void read_delassus(const Blocks& blocks, const Sweep& sweep);
  void factorize();
  void assemble(double delta);

  std::unique_ptr<System> system_;
  Equations equations_;
  std::vector<double> difference_;  // law's impulse less the present one
  std::vector<double> tangents_;    // by columns per contact, 3 x 3, with moments 6 x 6: of the law's impulse
                                    // by v_free
  std::vector<double> state_;
};

}  // namespace ilaw::coupled
