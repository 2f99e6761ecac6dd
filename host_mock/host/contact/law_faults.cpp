// SPDX-License-Identifier: BSD-3-Clause
#include "contact/law_faults.hpp"

#include <array>
#include <cmath>
#include <cstdio>
#include <cstring>

namespace ilaw::host {

bool show_fault(const ContactSums& sums) {
  double energies = 0.0;
  for (const double energy : sums.energy) energies += energy;
  return sums.least_dissipation < 0.0 || std::isnan(energies) || !std::isfinite(sums.work) ||
         sums.statuses[ILAW_BAD_INPUT] > 0;
}

const char* fault_of(const double* impulse, int dimension, const double* energy, int status) {
  static thread_local std::array<char, 128> text;
  const auto found = [](const char* what, double value, const char* expected) {
    std::snprintf(text.data(), text.size(), "found %s %g, expected %s", what, value, expected);
    return text.data();
  };
  if (status == ILAW_BAD_INPUT) return "found the status of bad input, but no code that says so";
  for (int c = 0; c < dimension; ++c)
    if (!std::isfinite(impulse[c])) return found("the impulse", impulse[c], "a finite one");
  for (int k = 0; k < ILAW_ENERGY_COUNT; ++k)
    if (std::isnan(energy[k])) return found("the energy", energy[k], "a number");
  for (int k = 0; k < ILAW_ENERGY_STORED; ++k)
    if (energy[k] < 0.0) return found("a dissipated energy of", energy[k], "none below 0");
  return nullptr;
}

Refusal overwriting(const char* input) {
  static thread_local std::array<char, 64> text;
  std::snprintf(text.data(), text.size(), "it wrote to its input %s", input);
  return {ILAW_BAD_LIBRARY, 0, -1, 0, text.data()};
}

InputCopy::InputCopy(const ilaw_batch& batch, std::size_t dimension, const ilaw_instance_info& info) {
  for (std::int64_t i = 0; i < batch.node_count; ++i)
    entries_.push_back(static_cast<std::size_t>(batch.index ? batch.index[i] : i));
  inputs_ = {{"v_free", batch.v_free, dimension, {}}, {"v_previous", batch.v_previous, dimension, {}},
             {"delassus", batch.delassus, 1, {}},     {"gap", batch.gap, 1, {}},
             {"normal", batch.normal, dimension, {}}, {"area", batch.area, 1, {}}};
  for (std::size_t p = 0; p < info.per_node_parameter_count; ++p)
    inputs_.push_back({"a parameter per node", batch.per_node_parameters[p], 1, {}});
  if (batch.state_in.values != batch.state_out.values)
    inputs_.push_back({"state_in", batch.state_in, info.state_size, {}});
  for (Input& input : inputs_) input.values = read(input.from, input.components);
}

std::vector<double> InputCopy::read(const ilaw_input& from, std::size_t components) const {
  std::vector<double> values;
  if (!from.values) return values;
  for (const std::size_t entry : entries_)
    for (std::size_t c = 0; c < components; ++c)
      values.push_back(from.values[entry * static_cast<std::size_t>(from.node_stride) +
                                   c * static_cast<std::size_t>(from.component_stride)]);
  return values;
}

const char* InputCopy::changed() const {
  for (const Input& input : inputs_) {
    const std::vector<double> now = read(input.from, input.components);
    if (!now.empty() && std::memcmp(now.data(), input.values.data(), now.size() * sizeof(double)) != 0)
      return input.name;
  }
  return nullptr;
}

}  // namespace ilaw::host
