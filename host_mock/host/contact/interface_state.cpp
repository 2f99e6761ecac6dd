// State of contacts that no step has reached, and the state that a checkpoint restores.
// SPDX-License-Identifier: BSD-3-Clause
#include "base/bytes.hpp"
#include "contact/interface.hpp"

#include <ilaw/arrays.hpp>

#include <cstddef>
#include <cstdint>
#include <istream>
#include <string>
#include <vector>

namespace ilaw::host {
namespace {

// Parameters of one node, as a batch takes them.
std::vector<ilaw_input> inputs_of(const std::vector<double>& parameters) {
  std::vector<ilaw_input> inputs;
  inputs.reserve(parameters.size());
  for (const double& value : parameters) inputs.push_back(ilaw::input(&value, 1, 1));
  return inputs;
}

}  // namespace

std::vector<double> Interface::parameters_of(int node_index) const {
  std::vector<double> parameters;
  for (std::size_t p = 0; p < info().per_node_parameter_count; ++p)
    parameters.push_back(setup_.arguments.values_of(info().per_node_parameters[p])[at(node_index)]);
  return parameters;
}

std::vector<double> Interface::parameters_at(int contact_index) const {
  std::vector<double> parameters;
  for (const std::vector<double>& values : contacts_.parameters)
    parameters.push_back(values[at(contact_index)]);
  return parameters;
}

// The state that the law starts with at time 0, whenever the contact is made. Its axes are those of
// the first time that it is active: where the normal turns, a law whose state has axes is active
// from the first step (may_skip).
std::vector<double> Interface::first_state(int node_index, const Dofs& u) const {
  std::vector<double> state(info().state_size);
  if (state.empty()) return state;
  const std::vector<double> parameters = parameters_of(node_index);
  const std::vector<ilaw_input> inputs = inputs_of(parameters);
  const Vector normal = setup_.counterpart->contact_point(node_index, u, 0.0).normal;
  ilaw_batch batch = empty_batch(setup_.tangent, 0.0, 1.0, 1.0);
  batch.node_count = 1;
  batch.area = ilaw::input(&setup_.areas[at(node_index)], 1, 1);
  batch.normal = ilaw::input(normal.data(), dimension_, 1);
  batch.per_node_parameters = inputs.data();
  batch.state_out = ilaw::output(state.data(), static_cast<std::int64_t>(state.size()), 1);
  const Answer answer = law_.initialise(batch);
  check({answer.code, 1, -1, 0, answer.report.reason}, std::to_string(setup_.nodes[at(node_index)]));
  return state;
}

std::vector<double> Interface::state_at(int node_index, const Dofs& u) const {
  const int contact_index = contacts_.index_of(at(node_index));
  if (contact_index < 0) return first_state(node_index, u);
  return contacts_.state.of(at(contact_index));
}

void Interface::save(std::ostream& out) const {
  contacts_.save(out);
  write_sized(out, amounts_);
  setup_.counterpart->save(out);
}

void Interface::load(std::istream& in, const Dofs& u) {
  const std::vector<int> nodes = ContactArrays::load_nodes(in, setup_.nodes.size());
  for (const int node_index : nodes) contact_index_of(node_index, u);
  if (contacts_.node_index != nodes) refuse_damaged();
  contacts_.load_state(in);
  amounts_ = read_sized<double>(in, info().amount_count);
  if (amounts_.size() != info().amount_count) refuse_damaged();
  setup_.counterpart->load(in);
  search_.forget();
}

}  // namespace ilaw::host
