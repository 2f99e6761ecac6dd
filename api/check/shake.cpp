// SPDX-License-Identifier: BSD-3-Clause
#include "check/shake.hpp"

#include <cmath>

namespace ilaw::check {
namespace {

constexpr double size_of_zero = 1e-6;

}  // namespace

Inputs Shake::operator()(Inputs in) {
  for (double& v : in.v_free) v = changed(v);
  for (std::size_t i = 0; i < in.count; ++i) {
    const double factor = 1.0 + size() * draw_.within(-1.0, 1.0);
    for (std::size_t c = 0; c < in.form_width; ++c) in.delassus[i * in.form_width + c] *= factor;
  }
  in.round_to(trial_.setup);
  return in;
}

std::vector<double> Shake::operator()(std::vector<double> state) {
  for (std::size_t first = 0; first < state.size(); first += trial_.info.state_size)
    for (std::size_t k = 0, at = first; k < trial_.info.state_variable_count; ++k) {
      const ilaw_state_variable& variable = *trial_.info.state_variables[k];
      for (const std::size_t end = at + variable.count; at < end; ++at) {
        if (variable.kind == ILAW_STATE_SCALAR)
          state[at] = within_range(state[at]);
        else if (variable.kind != ILAW_STATE_AXIS)
          state[at] = changed(state[at]);
      }
    }
  return state;
}

// Scalars often have a range that begins at 0 and ends at a value that is reached.
double Shake::within_range(double value) {
  return value == 0.0 ? size() * size_of_zero : value * (1.0 - size() * draw_.within(0.0, 1.0));
}

double Shake::changed(double value) {
  return value + size() * draw_.within(-1.0, 1.0) * (std::abs(value) + size_of_zero);
}

std::vector<Results> run_shaken(const Trial& trial, const Script& script, Draw& draw) {
  Heap heap;
  Arrays arrays(trial, script[0], {}, heap);
  arrays.initialise(script[0]);
  Shake shake(trial, draw);
  std::vector<Results> results;
  for (const Inputs& in : script) {
    arrays.set_state(shake(arrays.state()));
    results.push_back(arrays.evaluate(shake(in)));
  }
  return results;
}

}  // namespace ilaw::check
