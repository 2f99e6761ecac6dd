// contact_arrays.hpp - the arrays that a law reads and writes, one entry per contact.
//
// A node of the interface has its index in the interface's list of nodes (node_index) and, from
// when it is first needed, its index in these arrays (contact_index). Nodes that were never near
// have no entry.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "contact/counterpart.hpp"

#include <ilaw/ilaw.h>

#include <cstdint>
#include <iosfwd>
#include <vector>

namespace ilaw::host {

class ContactArrays {
 public:
  ContactArrays(int dimension, const ilaw_instance_info& info, std::size_t node_count);

  std::size_t count() const { return node_index.size(); }
  // Of the node at node_index; -1: none yet.
  int index_of(std::size_t node) const { return contact_index_[node]; }
  // Appends the contact of a node, with its values of the law's parameters per node; its state is
  // zero.
  void add(int node, double node_area, const std::vector<double>& node_parameters);

  // The d components of a vector, for one contact.
  auto vector(std::vector<double>& values, int contact) const {
    return Eigen::Map<Vector>(&values[first_component(contact)], dimension_);
  }
  auto vector(const std::vector<double>& values, int contact) const {
    return Eigen::Map<const Vector>(&values[first_component(contact)], dimension_);
  }
  std::size_t first_state(int contact) const { return static_cast<std::size_t>(contact) * state_size_; }

  // State in and out are arrays of their own: a step may evaluate a contact more than once.
  void keep_state_in() { keeps_state_in_ = true; }
  // The state after the step becomes that before the next.
  void accept_state(int contact);

  // The arrays that initialise takes; with those that evaluate takes.
  ilaw_batch start_batch();
  ilaw_batch step_batch();

  std::size_t bytes_per_contact() const;
  void save(std::ostream& out) const;
  // What save wrote, into the entries that were added for the same nodes in the same order.
  static std::vector<int> load_nodes(std::istream& in, std::size_t most);
  void load_state(std::istream& in);

  // By contact_index; vectors have dimension components each, energy ILAW_ENERGY_COUNT.
  std::vector<int> node_index;
  std::vector<ContactPoint> point;
  std::vector<double> v_free, v_previous, normal, impulse, previous_impulse;
  std::vector<double> delassus, gap, area, energy, state;
  std::vector<std::uint8_t> status;
  std::vector<std::uint8_t> touched;  // neither fresh nor at rest: must be evaluated out of reach, too

 private:
  std::size_t first_component(int contact) const {
    return static_cast<std::size_t>(contact) * static_cast<std::size_t>(dimension_);
  }

  int dimension_;
  std::size_t state_size_;
  bool keeps_state_in_ = false;
  std::vector<int> contact_index_;  // by node_index
  std::vector<double> next_state_;
  std::vector<std::vector<double>> parameters_;  // per node, as the law lists them
  std::vector<ilaw_input> parameter_inputs_;
};

}  // namespace ilaw::host
