// shake.hpp - inputs and states changed as rounding changes them. A node that this takes to another branch of
// its law is on an edge, and rules that compare but for rounding leave it out.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "check/run.hpp"

#include <vector>

namespace ilaw::check {

class Shake {
 public:
  Shake(const Trial& trial, Draw& draw) : trial_(trial), draw_(draw) {}

  Inputs operator()(Inputs in);
  // All but axes.
  std::vector<double> operator()(std::vector<double> state);

 private:
  double size() const { return 16.0 * trial_.epsilon(); }
  double rounding_of(double size_of_vector);
  double within_range(double value);
  void change_node(double* state);

  const Trial& trial_;
  Draw& draw_;
};

// Every step from the state that the one before left, shaken. The first state is left alone: many laws tell a
// fresh node by its exact zeros.
std::vector<Results> run_shaken(const Trial& trial, const Script& script, Draw& draw);

}  // namespace ilaw::check
