// contact_arrays.hpp - what is stored of each contact.
//
// A node of the interface has its index in the interface's list of nodes (node_index) and, from
// when it is first needed, its index in these arrays (contact_index). Nodes that were never near
// have no entry, and an array that the interface has no use for is empty.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "contact/interface_setup.hpp"

#include <ilaw/ilaw.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <iosfwd>
#include <vector>

namespace ilaw::host {

// A batch with times and what is the same for all contacts alone.
ilaw_batch empty_batch(const Vector& tangent, double time, double velocity_step, double position_step);

// Not out of reach as ilaw.h says it, in its order of operations: law, promise and host agree to the
// last bit.
inline bool is_in_reach(double gap, const double* normal, const double* v_free, int dimension, double dt) {
  double normal_velocity = 0.0;
  for (int c = 0; c < dimension; ++c) normal_velocity += normal[c] * v_free[c];
  return !(gap > 0.0 && gap + dt * normal_velocity > 0.0);
}

// The states of contacts, number by number: neighbours lie side by side, so that laws work on them where they
// are, many at a time.
class StateColumns {
 public:
  explicit StateColumns(std::size_t numbers) : numbers_(numbers) {}

  bool empty() const { return numbers_ == 0; }
  double& at(std::size_t contact, std::size_t number) { return values_[number * room_ + contact]; }
  double at(std::size_t contact, std::size_t number) const { return values_[number * room_ + contact]; }
  // Layout for a batch: the first number of a contact, and the stride to its next number.
  double* first(std::size_t contact) { return empty() ? nullptr : &values_[contact]; }
  std::int64_t stride() const { return static_cast<std::int64_t>(room_); }

  const std::vector<double>& values() const { return values_; }

  void add(const std::vector<double>& state) {
    if (count_ == room_) grow();
    for (std::size_t c = 0; c < numbers_; ++c) at(count_, c) = state[c];
    ++count_;
  }
  std::vector<double> of(std::size_t contact) const {
    std::vector<double> state(numbers_);
    for (std::size_t c = 0; c < numbers_; ++c) state[c] = at(contact, c);
    return state;
  }

 private:
  // An odd number of lines of the cache from column to column: with a power of two all would go to
  // the same few places in it.
  void grow() {
    constexpr std::size_t line = 8;
    const std::size_t lines = std::max<std::size_t>(count_ / 4, 1) | 1;
    StateColumns larger(numbers_);
    larger.room_ = lines * line;
    larger.values_.resize(numbers_ * larger.room_);
    for (std::size_t c = 0; c < numbers_; ++c)
      std::copy_n(values_.begin() + static_cast<std::ptrdiff_t>(c * room_), count_,
                  larger.values_.begin() + static_cast<std::ptrdiff_t>(c * larger.room_));
    values_.swap(larger.values_);
    room_ = larger.room_;
  }

  std::size_t numbers_, count_ = 0, room_ = 0;
  std::vector<double> values_;  // column by column, each with room for more
};

class ContactArrays {
 public:
  // partnered: the counterpart has partners.
  ContactArrays(int dimension, const ilaw_instance_info& info, std::size_t node_count, bool partnered);

  // The values with which a new contact starts.
  struct Entry {
    int node_index;
    double delassus, area;
    std::vector<double> parameters;  // of the law per node, in its order
    std::vector<double> state;
    bool must_be_evaluated;
    bool turns;  // the state has axes, which turn with the normal out of reach, too
  };

  std::size_t count() const { return node_index.size(); }
  // The contact of the node at node_index; -1: none yet.
  int index_of(std::size_t node) const { return contact_index_[node]; }
  void add(const Entry& entry);

  // The d components of a vector, for one contact.
  auto vector(std::vector<double>& values, int contact) const {
    return Eigen::Map<Vector>(&values[first_component(contact)], dimension_);
  }
  auto vector(const std::vector<double>& values, int contact) const {
    return Eigen::Map<const Vector>(&values[first_component(contact)], dimension_);
  }

  // Whether it must be evaluated out of reach, too: it is neither fresh nor at rest.
  bool must_be_evaluated(std::size_t contact) const { return (marks_[contact] & awake) != 0; }
  // Whether its state may differ from the one it started with.
  bool may_have_changed(std::size_t contact) const { return (marks_[contact] & changed) != 0; }
  // After a step, of contacts that follow each other, where no status was ILAW_FREE.
  void mark_acting(std::size_t first, std::ptrdiff_t count) {
    std::uint8_t* const marks = &marks_[first];
    for (std::ptrdiff_t i = 0; i < count; ++i) marks[i] |= awake | changed;
  }
  // After a step: acts, where its status was not ILAW_FREE; rests, where the law promises
  // ILAW_CAN_REST.
  void mark_touched(std::size_t contact, bool acts, bool in_reach, bool rests) {
    std::uint8_t& mark = marks_[contact];
    if (acts || in_reach) mark |= changed;
    if (acts || (in_reach && !rests))
      mark |= awake;
    else if (rests)
      mark &= static_cast<std::uint8_t>(~awake);
  }

  // Where contacts share nodes the arrays below "coupled" are there.
  void keep_geometry();
  // What a law takes off in a step.
  void keep_wear();

  // Once more contacts are there, what a step reads and writes of them.
  void keep_in_large_pages() const;

  std::size_t bytes_per_contact() const;
  // Contacts whose state may differ from what it started as.
  void save(std::ostream& out) const;
  // Restores the output of save into the entries that were added for the same nodes in the same order.
  static std::vector<int> load_nodes(std::istream& in, std::size_t most);
  void load_state(std::istream& in);

  // By contact_index; vectors have dimension components each, energy ILAW_ENERGY_COUNT.
  std::vector<int> node_index;
  std::vector<ContactPoint> point;  // where the counterpart has partners
  std::vector<double> impulse, delassus;
  // Where nodes are driven, H by axis: as it is, and as the law is given it; delassus is then the largest.
  std::vector<double> axis_delassus, law_delassus;
  StateColumns state;
  std::vector<double> area;                     // where the law reads it
  std::vector<std::vector<double>> parameters;  // that are given per node, as the law lists them
  std::vector<std::uint8_t> status;
  std::vector<double> wear;  // depth of the last step, where it is kept
  // coupled
  std::vector<double> normal, gap;

 private:
  enum Mark : std::uint8_t { awake = 1, changed = 2 };

  std::size_t first_component(int contact) const {
    return static_cast<std::size_t>(contact) * static_cast<std::size_t>(dimension_);
  }
  void make_room();

  int dimension_;
  std::size_t state_size_;
  bool reads_area_, partnered_, keeps_geometry_ = false, keeps_wear_ = false;
  std::vector<int> contact_index_;  // by node_index
  std::vector<std::uint8_t> marks_;
};

}  // namespace ilaw::host
