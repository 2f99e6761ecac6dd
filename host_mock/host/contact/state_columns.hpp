// state_columns.hpp - the states of contacts, number by number: neighbours lie side by side, so that
// laws work on them where they are, many at a time.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace ilaw::host {

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
  void take(std::size_t contact, const StateColumns& from) {
    for (std::size_t c = 0; c < numbers_; ++c) at(contact, c) = from.at(contact, c);
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

}  // namespace ilaw::host
