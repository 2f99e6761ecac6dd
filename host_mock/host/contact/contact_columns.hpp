// contact_columns.hpp - contacts as a law is given them: what it reads and writes of them beside velocities,
// gaps and normals. The step in blocks takes them a block at a time, the solver of coupled contacts all at
// once. Where contacts follow each other the law works on the arrays of the interface, else on copies.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "contact/contact_arrays.hpp"
#include "contact/contact_heat.hpp"
#include "contact/contact_sums.hpp"
#include "contact/law.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace ilaw::host {

class ContactColumns {
 public:
  struct Outputs {
    bool energies, amounts;
  };
  // most: contacts that may be taken at once. Room is kept for the next law.
  void use(const Law& law, int dimension, Outputs outputs, std::ptrdiff_t most);
  // Whether the law works on the arrays, and whether on their states.
  struct InPlace {
    bool arrays, states;
  };
  void take(ContactArrays& at, const std::int32_t* contacts, std::ptrdiff_t count, InPlace in_place);
  void fill(ilaw_batch& batch);

  // ---- by place among the contacts ----
  std::size_t contact(std::ptrdiff_t i) const { return static_cast<std::size_t>(contacts_[i]); }
  const double* delassus() const { return delassus_; }
  double* impulse() const { return impulse_; }
  std::uint8_t* status() const { return status_; }
  // Null where the law is not asked for energies.
  const double* energy(std::size_t part) const { return energies_ ? energies_ + part * stride_ : nullptr; }
  std::array<double, ILAW_ENERGY_COUNT> energies(std::ptrdiff_t i) const;
  double amount(std::size_t k, std::ptrdiff_t i) const { return amounts_[k].values[i]; }
  double& state(std::ptrdiff_t i, std::size_t number) const {
    return state_[number * state_stride_ + static_cast<std::size_t>(i)];
  }

  // ---- after the law ----
  // A law without statuses leaves the contacts free that it gives no impulse; the others are closed.
  void complete_statuses() const;
  void give_heat(ContactHeat& heat) const;
  // Adds them up, and keeps the wear of each contact if that is asked for.
  void sum_amounts(ContactSums& sums) const;
  // What was copied goes back to the arrays.
  void scatter_results() const;
  void scatter_states() const;

 private:
  void read_parameters();
  // The array from the first contact on, or a copy of it in room; null where it is empty.
  double* column(std::vector<double>& all, double* room) const;

  ContactArrays* at_ = nullptr;
  const std::int32_t* contacts_ = nullptr;
  std::ptrdiff_t count_ = 0;
  InPlace in_place_{};
  bool gives_status_ = false;
  std::size_t wear_ = 0;  // place among the amounts, or behind them
  std::size_t dimension_ = 0, state_size_ = 0, stride_ = 0, state_stride_ = 0;
  double *delassus_ = nullptr, *area_ = nullptr, *impulse_ = nullptr, *energies_ = nullptr, *state_ = nullptr;
  std::uint8_t* status_ = nullptr;
  // Room for copies, one column after the other.
  std::vector<double> numbers_;
  double *delassus_room_ = nullptr, *area_room_ = nullptr, *impulse_room_ = nullptr, *state_room_ = nullptr,
         *parameter_room_ = nullptr;
  std::vector<std::uint8_t> statuses_;
  std::vector<ilaw_input> parameters_;
  std::vector<ilaw_output> amounts_;
};

}  // namespace ilaw::host
