// SPDX-License-Identifier: BSD-3-Clause
#include "contact/contact_arrays.hpp"

#include "base/bytes.hpp"

#include <algorithm>

namespace ilaw::host {

ContactArrays::ContactArrays(int dimension, const ilaw_instance_info& info, std::size_t node_count)
    : dimension_(dimension),
      state_size_(info.state_size),
      contact_index_(node_count, -1),
      parameters_(info.per_node_parameter_count) {}

void ContactArrays::add(int node, double node_area, const std::vector<double>& node_parameters) {
  contact_index_[static_cast<std::size_t>(node)] = static_cast<int>(count());
  node_index.push_back(node);
  point.emplace_back();
  for (std::vector<double>* vectors : {&v_free, &v_previous, &normal, &impulse, &previous_impulse})
    vectors->resize(count() * static_cast<std::size_t>(dimension_));
  delassus.push_back(0.0);
  gap.push_back(0.0);
  area.push_back(node_area);
  energy.resize(count() * ILAW_ENERGY_COUNT);
  state.resize(count() * state_size_);
  status.push_back(ILAW_FREE);
  touched.push_back(0);
  parameter_inputs_.clear();
  for (std::size_t p = 0; p < parameters_.size(); ++p) {
    parameters_[p].push_back(node_parameters[p]);
    parameter_inputs_.push_back({parameters_[p].data(), 1, 1});
  }
}

void ContactArrays::accept_state(int contact) {
  if (keeps_state_in_)
    std::copy_n(&next_state_[first_state(contact)], state_size_, &state[first_state(contact)]);
}

ilaw_batch ContactArrays::start_batch() {
  ilaw_batch batch{};
  batch.struct_size = sizeof batch;
  batch.area = {area.data(), 1, 1};
  batch.normal = {normal.data(), dimension_, 1};
  batch.per_node_parameters = parameter_inputs_.data();
  batch.state_out = {state.data(), static_cast<std::int64_t>(state_size_), 1};
  return batch;
}

ilaw_batch ContactArrays::step_batch() {
  const auto size = static_cast<std::int64_t>(state_size_);
  if (keeps_state_in_) next_state_.resize(state.size());
  ilaw_batch batch = start_batch();
  batch.v_free = {v_free.data(), dimension_, 1};
  batch.v_previous = {v_previous.data(), dimension_, 1};
  batch.delassus = {delassus.data(), 1, 1};
  batch.gap = {gap.data(), 1, 1};
  batch.state_in = {state.data(), size, 1};
  batch.state_out = {keeps_state_in_ ? next_state_.data() : state.data(), size, 1};
  batch.impulse = {impulse.data(), dimension_, 1};
  batch.energy = {energy.data(), ILAW_ENERGY_COUNT, 1};
  batch.status = status.data();
  batch.status_stride = 1;
  return batch;
}

std::size_t ContactArrays::bytes_per_contact() const {
  return sizeof(ContactPoint) + sizeof(int) + 2 +
         sizeof(double) * (5 * static_cast<std::size_t>(dimension_) + 3 + ILAW_ENERGY_COUNT +
                           parameters_.size() + state_size_ * (keeps_state_in_ ? 2 : 1));
}

void ContactArrays::save(std::ostream& out) const {
  write_sized(out, node_index);
  write_sized(out, touched);
  write_sized(out, state);
}

std::vector<int> ContactArrays::load_nodes(std::istream& in, std::size_t most) {
  std::vector<int> nodes = read_sized<int>(in, most);
  for (const int node : nodes)
    if (node < 0 || node >= static_cast<int>(most)) refuse_damaged();
  return nodes;
}

void ContactArrays::load_state(std::istream& in) {
  touched = read_sized<std::uint8_t>(in, count());
  state = read_sized<double>(in, count() * state_size_);
  if (touched.size() != count() || state.size() != count() * state_size_) refuse_damaged();
}

}  // namespace ilaw::host
