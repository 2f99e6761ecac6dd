// SPDX-License-Identifier: BSD-3-Clause
#include "contact/contact_columns.hpp"

#include <ilaw/arrays.hpp>

#include <algorithm>
#include <string_view>

namespace ilaw::host {

void ContactColumns::use(const Law& law, int dimension, Outputs outputs, std::ptrdiff_t most) {
  const ilaw_instance_info& info = law.info();
  dimension_ = static_cast<std::size_t>(dimension);
  state_size_ = info.state_size;
  stride_ = static_cast<std::size_t>(most);
  parameters_.resize(info.per_node_parameter_count);
  amounts_.resize(outputs.amounts ? info.amount_count : 0);
  const std::size_t columns =
      2 + dimension_ + ILAW_ENERGY_COUNT + state_size_ + parameters_.size() + amounts_.size();
  if (numbers_.size() < columns * stride_) numbers_.resize(columns * stride_);
  double* next = numbers_.data();
  const auto room = [&](std::size_t count) {
    double* const first = next;
    next += count * stride_;
    return first;
  };
  double* const energies = room(ILAW_ENERGY_COUNT);
  energies_ = outputs.energies ? energies : nullptr;
  for (ilaw_output& amount : amounts_) amount = ilaw::output(room(1), 1, 0);
  delassus_room_ = room(1);
  area_room_ = room(1);
  impulse_room_ = room(dimension_);
  parameter_room_ = room(parameters_.size());
  state_room_ = room(state_size_);
  if (statuses_.size() < stride_) statuses_.resize(stride_);
  wear_ = 0;
  while (wear_ < amounts_.size() && std::string_view(info.amounts[wear_]->name) != "wear") ++wear_;
  gives_status_ = (law.outputs() & ILAW_OUTPUT_STATUS) != 0;
}

void ContactColumns::take(ContactArrays& at, const std::int32_t* contacts, std::ptrdiff_t count,
                          InPlace in_place) {
  at_ = &at;
  contacts_ = contacts;
  count_ = count;
  in_place_ = in_place;
  delassus_ = column(at.delassus, delassus_room_);
  area_ = column(at.area, area_room_);
  impulse_ = in_place.arrays ? &at.impulse[contact(0) * dimension_] : impulse_room_;
  status_ = in_place.arrays ? &at.status[contact(0)] : statuses_.data();
  read_parameters();
  state_stride_ = in_place.states ? static_cast<std::size_t>(at.state.stride()) : stride_;
  state_ = in_place.states ? at.state.first(contact(0)) : state_room_;
  for (std::size_t number = 0; !in_place.states && number < state_size_; ++number)
    for (std::ptrdiff_t i = 0; i < count; ++i) state(i, number) = at.state.at(contact(i), number);
}

void ContactColumns::read_parameters() {
  for (std::size_t p = 0; p < parameters_.size(); ++p)
    parameters_[p] = ilaw::input(column(at_->parameters[p], parameter_room_ + p * stride_), 1, 0);
}

double* ContactColumns::column(std::vector<double>& all, double* room) const {
  if (all.empty()) return nullptr;
  if (in_place_.arrays) return &all[contact(0)];
  for (std::ptrdiff_t i = 0; i < count_; ++i) room[i] = all[contact(i)];
  return room;
}

void ContactColumns::fill(ilaw_batch& batch) {
  batch.node_count = count_;
  batch.area = ilaw::input(area_, 1, 0);
  batch.per_node_parameters = parameters_.empty() ? nullptr : parameters_.data();
  batch.state_in = ilaw::input(state_, 1, static_cast<std::int64_t>(state_stride_));
  batch.state_out = ilaw::output(state_, 1, static_cast<std::int64_t>(state_stride_));
  batch.impulse = ilaw::output(impulse_, static_cast<std::int64_t>(dimension_), 1);
  if (energies_) batch.energy = ilaw::output(energies_, 1, static_cast<std::int64_t>(stride_));
  batch.amounts = amounts_.empty() ? nullptr : amounts_.data();
  batch.status = status_;
  batch.status_stride = 1;
}

std::array<double, ILAW_ENERGY_COUNT> ContactColumns::energies(std::ptrdiff_t i) const {
  std::array<double, ILAW_ENERGY_COUNT> energies{};
  for (std::size_t k = 0; energies_ && k < energies.size(); ++k) energies[k] = energy(k)[i];
  return energies;
}

void ContactColumns::complete_statuses() const {
  if (gives_status_) return;
  for (std::ptrdiff_t i = 0; i < count_; ++i) {
    const double* const r = impulse_ + static_cast<std::ptrdiff_t>(dimension_) * i;
    const bool acts = std::any_of(r, r + dimension_, [](double part) { return part != 0.0; });
    status_[i] = acts ? ILAW_CLOSED : ILAW_FREE;
  }
}

void ContactColumns::give_heat(ContactHeat& heat) const {
  for (std::ptrdiff_t i = 0; i < count_; ++i)
    heat.take(contact(i), [&](std::size_t k) { return amount(k, i); });
}

void ContactColumns::sum_amounts(ContactSums& sums) const {
  for (std::size_t k = 0; k < amounts_.size(); ++k)
    for (std::ptrdiff_t i = 0; i < count_; ++i) sums.add_amount(k, amount(k, i));
  for (std::ptrdiff_t i = 0; wear_ < amounts_.size() && !at_->wear.empty() && i < count_; ++i)
    at_->wear[contact(i)] = amount(wear_, i);
}

void ContactColumns::scatter_results() const {
  if (in_place_.arrays) return;
  for (std::ptrdiff_t i = 0; i < count_; ++i) {
    std::copy_n(impulse_ + static_cast<std::ptrdiff_t>(dimension_) * i, dimension_,
                &at_->impulse[contact(i) * dimension_]);
    at_->status[contact(i)] = status_[i];
  }
}

void ContactColumns::scatter_states() const {
  for (std::size_t number = 0; !in_place_.states && number < state_size_; ++number)
    for (std::ptrdiff_t i = 0; i < count_; ++i) at_->state.at(contact(i), number) = state(i, number);
}

}  // namespace ilaw::host
