// SPDX-License-Identifier: BSD-3-Clause
#include "check/shake.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>

namespace ilaw::check {
namespace {

constexpr double size_of_zero = 1e-6;

}  // namespace

Inputs Shake::operator()(Inputs in) {
  for (std::size_t i = 0; i < in.count; ++i) {
    for (std::vector<double>* vectors : {&in.v_free, &in.v_smooth, &in.spin_free}) {
      if (vectors->empty()) continue;
      const double size_of_vector = in.vector(*vectors, i).norm();
      for (std::size_t c = 0; c < in.dimension; ++c)
        (*vectors)[i * in.dimension + c] += rounding_of(size_of_vector);
    }
    const double factor = 1.0 + size() * draw_.within(-1.0, 1.0);
    for (std::size_t c = 0; c < in.form_width; ++c) in.delassus[i * in.form_width + c] *= factor;
  }
  in.round_to(trial_.setup);
  return in;
}

std::vector<double> Shake::operator()(std::vector<double> state) {
  for (std::size_t first = 0; first < state.size(); first += trial_.info.state_size)
    change_node(&state[first]);
  return state;
}

// Components are rounded as those of a vector, which may be the one of several variables: other axes mix
// them.
void Shake::change_node(double* state) {
  std::map<std::string, double> sizes;
  const auto for_variables = [&](const auto& visit) {
    double* at = state;
    for (std::uint32_t k = 0; k < trial_.info.state_variable_count; ++k) {
      const ilaw_state_variable& variable = *trial_.info.state_variables[k];
      for (const double* const end = at + variable.count; at != end; ++at) visit(variable, *at);
    }
  };
  for_variables([&](const ilaw_state_variable& variable, double value) {
    double& size = sizes[variable.unit];
    size = std::max(size, std::abs(value));
  });
  for_variables([&](const ilaw_state_variable& variable, double& value) {
    if (variable.kind == ILAW_KIND_SCALAR)
      value = within_range(value);
    else if (variable.kind != ILAW_KIND_AXIS)
      value += rounding_of(sizes[variable.unit]);
  });
}

// Scalars often have a range that begins at 0 and ends at a value that is reached.
double Shake::within_range(double value) {
  return value == 0.0 ? size() * size_of_zero : value * (1.0 - size() * draw_.within(0.0, 1.0));
}

double Shake::rounding_of(double size_of_vector) {
  return size() * draw_.within(-1.0, 1.0) * (size_of_vector + size_of_zero);
}

std::vector<Results> run_shaken(const Trial& trial, const Script& script, Draw& draw) {
  Started arrays(trial, script[0]);
  Shake shake(trial, draw);
  std::vector<Results> results;
  for (const Inputs& in : script) {
    if (!results.empty()) arrays.set_state(shake(arrays.state()));
    results.push_back(arrays.evaluate(shake(in)));
  }
  return results;
}

}  // namespace ilaw::check
