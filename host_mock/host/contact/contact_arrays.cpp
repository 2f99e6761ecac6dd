// SPDX-License-Identifier: BSD-3-Clause
#include "contact/contact_arrays.hpp"

#include "base/bytes.hpp"
#include "base/large_pages.hpp"

#include <ilaw/arrays.hpp>

namespace ilaw::host {

ilaw_batch empty_batch(const Vector& tangent, double time, double velocity_step, double position_step) {
  ilaw_batch batch{};
  batch.struct_size = sizeof batch;
  batch.time = time;
  batch.velocity_step = velocity_step;
  batch.position_step = position_step;
  if (tangent.size() > 0) batch.tangent = ilaw::input(tangent.data(), 0, 1);
  return batch;
}

ContactArrays::ContactArrays(int dimension, const ilaw_instance_info& info, std::size_t node_count,
                             bool partnered)
    : state(info.state_size),
      parameters(info.per_node_parameter_count),
      dimension_(dimension),
      state_size_(info.state_size),
      reads_area_(((info.inputs | info.balance_inputs) & ILAW_INPUT_AREA) != 0),
      partnered_(partnered),
      contact_index_(node_count, -1) {}

void ContactArrays::add(const Entry& entry) {
  contact_index_[static_cast<std::size_t>(entry.node_index)] = static_cast<int>(count());
  node_index.push_back(entry.node_index);
  impulse.resize(count() * static_cast<std::size_t>(dimension_));
  delassus.push_back(entry.delassus);
  state.add(entry.state);
  if (reads_area_) area.push_back(entry.area);
  for (std::size_t p = 0; p < parameters.size(); ++p) parameters[p].push_back(entry.parameters[p]);
  status.push_back(ILAW_FREE);
  const int touched = entry.turns ? changed : 0;
  marks_.push_back(static_cast<std::uint8_t>(entry.must_be_evaluated ? awake | changed : touched));
  if (partnered_) point.emplace_back();
  if (keeps_geometry_) make_room();
  if (keeps_wear_) wear.push_back(0.0);
}

void ContactArrays::keep_wear() {
  keeps_wear_ = true;
  wear.resize(count());
}

void ContactArrays::keep_geometry() {
  keeps_geometry_ = true;
  make_room();
}

void ContactArrays::make_room() {
  normal.resize(count() * static_cast<std::size_t>(dimension_));
  gap.resize(count());
}

void ContactArrays::keep_in_large_pages() const {
  for (const std::vector<double>* values : {&impulse, &delassus, &area, &state.values()})
    host::keep_in_large_pages(*values);
}

std::size_t ContactArrays::bytes_per_contact() const {
  const auto d = static_cast<std::size_t>(dimension_);
  const std::size_t stored = d + 1 + state_size_ + (reads_area_ ? 1 : 0) + parameters.size();
  return sizeof(int) + 2 + (partnered_ ? sizeof(ContactPoint) : 0) +
         sizeof(double) * (stored + (keeps_geometry_ ? d + 1 : 0));
}

void ContactArrays::save(std::ostream& out) const {
  std::vector<int> nodes;
  std::vector<std::uint8_t> marks;
  std::vector<double> states;
  for (std::size_t k = 0; k < count(); ++k) {
    if (!may_have_changed(k)) continue;
    nodes.push_back(node_index[k]);
    marks.push_back(marks_[k]);
    const std::vector<double> own = state.of(k);
    states.insert(states.end(), own.begin(), own.end());
  }
  write_sized(out, nodes);
  write_sized(out, marks);
  write_sized(out, states);
}

std::vector<int> ContactArrays::load_nodes(std::istream& in, std::size_t most) {
  std::vector<int> nodes = read_sized<int>(in, most);
  for (const int node : nodes)
    if (node < 0 || node >= static_cast<int>(most)) refuse_damaged();
  return nodes;
}

void ContactArrays::load_state(std::istream& in) {
  marks_ = read_sized<std::uint8_t>(in, count());
  const std::vector<double> states = read_sized<double>(in, count() * state_size_);
  if (marks_.size() != count() || states.size() != count() * state_size_) refuse_damaged();
  for (std::size_t k = 0; k < states.size(); ++k) state.at(k / state_size_, k % state_size_) = states[k];
}

}  // namespace ilaw::host
