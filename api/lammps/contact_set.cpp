// SPDX-License-Identifier: BSD-3-Clause
#include "contact_set.hpp"

#include <ilaw/arrays.hpp>

#include <algorithm>

namespace ilaw::lammps {
namespace {

// Spheres have arms along the normal. A law that serves spins may give moments; a law that knows neither form
// is given the matrix.
ilaw_delassus_form form_of(const ilaw_law& law) {
  for (const std::uint32_t form : {ILAW_DELASSUS_TRANSVERSE_SPIN, ILAW_DELASSUS_TRANSVERSE})
    if ((law.delassus_forms & form) != 0) return form;
  return ILAW_DELASSUS_FULL;
}

}  // namespace

ContactSet::ContactSet(const std::string& law, const std::vector<std::array<std::string, 2>>& parameters) {
  const library opened(law);
  if (opened.plugin().law_count != 1) throw error(ILAW_NOT_FOUND, law + ": not a library of one law");
  const ilaw_law& description = *opened.plugin().laws[0];
  ilaw::parameters given;
  for (const auto& [name, text] : parameters) given.set(description, name, text);
  ilaw_setup setup{};
  setup.struct_size = sizeof setup;
  setup.dimension = 3;
  setup.delassus_form = delassus_form_ = form_of(description);
  if (has_spins()) response_size_ = 6;
  response_.reserve(response_size_);  // a null pointer would say that the array is absent
  setup.frame = ILAW_FRAME_GLOBAL;
  setup.numbers = ILAW_NUMBERS_DOUBLE;
  given.give(setup);
  interface_ = std::make_unique<ilaw::interface>(opened, "", setup);
  state_size_ = interface_->info().state_size;
}

void ContactSet::clear(double velocity_step) {
  velocity_step_ = velocity_step;
  new_.clear();
  for (auto* list : {&body_, &counterpart_}) list->clear();
  for (auto* values : {&partner_, &gap_, &area_, &normal_, &arm_, &counterpart_arm_, &wall_, &wall_previous_,
                       &wall_spin_, &response_, &state_, &energy_})
    values->clear();
}

void ContactSet::add(const Contact& contact, const Row& row) {
  const std::size_t k = size();
  partner_.push_back(contact.partner);
  body_.push_back(contact.body);
  counterpart_.push_back(contact.counterpart);
  gap_.push_back(contact.gap);
  area_.push_back(contact.area);
  for (std::size_t c = 0; c < 3; ++c) {
    normal_.push_back(contact.normal[c]);
    arm_.push_back(-contact.arm * contact.normal[c]);
    counterpart_arm_.push_back(contact.counterpart_arm * contact.normal[c]);
    if (contact.counterpart >= 0) continue;
    wall_.push_back(contact.wall_velocity[c]);
    wall_previous_.push_back(contact.wall_previous[c]);
    if (has_spins()) wall_spin_.push_back(contact.wall_spin[c]);
  }
  response_.resize(response_size_ * (k + 1));
  state_.resize(state_size_ * (k + 1));
  for (std::size_t at = 0; at < row.size(); at += entry_size())
    if (row[at] == contact.partner) {
      const double* entry = &row[at] + 1;
      for (std::size_t c = 0; c < response_size_; ++c)
        response_[response_size_ * k + c] = velocity_step_ * entry[c];
      std::copy_n(entry + response_size_, state_size_,
                  state_.end() - static_cast<std::ptrdiff_t>(state_size_));
      return;
    }
  new_.push_back(static_cast<std::int32_t>(k));
}

const ilaw_contacts* ContactSet::describe(double time, double position_step) {
  energy_.assign(ILAW_ENERGY_COUNT * size(), 0.0);
  status_.assign(size(), ILAW_FREE);
  const auto state_size = static_cast<std::int64_t>(state_size_);
  batch_ = {};
  batch_.struct_size = sizeof batch_;
  batch_.node_count = static_cast<std::int64_t>(size());
  batch_.time = time;
  batch_.velocity_step = velocity_step_;
  batch_.position_step = position_step;
  batch_.gap = ilaw::input(gap_.data(), 1, 0);
  batch_.area = ilaw::input(area_.data(), 1, 0);
  batch_.normal = ilaw::input(normal_.data(), 3, 1);
  batch_.state_in = ilaw::input(state_.data(), state_size, 1);
  batch_.state_out = ilaw::output(state_.data(), state_size, 1);
  const auto width = static_cast<std::int64_t>(response_size_);
  batch_.impulse = ilaw::output(response_.data(), width, 1);
  if (has_spins()) batch_.moment = ilaw::output(response_.data() + 3, width, 1);
  batch_.energy = ilaw::output(energy_.data(), ILAW_ENERGY_COUNT, 1);
  batch_.status = status_.data();
  batch_.status_stride = 1;
  initialise_new(batch_);
  described_ = {};
  described_.struct_size = sizeof described_;
  described_.delassus_form = delassus_form_;
  described_.law = &interface_->law();
  described_.instance = interface_->instance();
  described_.batch = &batch_;
  described_.body = body_.data();
  described_.counterpart = counterpart_.data();
  described_.arm = ilaw::input(arm_.data(), 3, 1);
  described_.counterpart_arm = ilaw::input(counterpart_arm_.data(), 3, 1);
  if (wall_.empty()) return &described_;
  described_.wall_velocity = ilaw::input(wall_.data(), 3, 1);
  described_.wall_previous = ilaw::input(wall_previous_.data(), 3, 1);
  if (has_spins()) described_.wall_spin = ilaw::input(wall_spin_.data(), 3, 1);
  return &described_;
}

void ContactSet::initialise_new(const ilaw_batch& batch) {
  if (new_.empty()) return;
  ilaw_batch part = batch;
  part.index = new_.data();
  part.node_count = static_cast<std::int64_t>(new_.size());
  interface_->initialise(part);  // what is bad is found, and named, by evaluate
}

void ContactSet::keep(std::size_t k, Row& row) const {
  row.push_back(partner_[k]);
  for (std::size_t c = 0; c < response_size_; ++c)
    row.push_back(response_[response_size_ * k + c] / velocity_step_);
  const auto state = state_.begin() + static_cast<std::ptrdiff_t>(k * state_size_);
  row.insert(row.end(), state, state + static_cast<std::ptrdiff_t>(state_size_));
}

}  // namespace ilaw::lammps
