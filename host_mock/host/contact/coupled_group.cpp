// SPDX-License-Identifier: BSD-3-Clause
#include "contact/coupled_group.hpp"

#include <ilaw/arrays.hpp>

#include <algorithm>
#include <utility>

namespace ilaw::host {

CoupledGroup::CoupledGroup(const Law& law, int dimension, ilaw_delassus_form form, bool has_partners)
    : dimension_(dimension),
      form_(form),
      has_partners_(has_partners),
      state_size_(law.info().state_size),
      law_(law, dimension),
      parameters_(law.info().per_node_parameter_count),
      amounts_(law.info().amount_count) {}

void CoupledGroup::open() {
  contacts_.clear();
  first_partner_.assign(1, 0);
  partners_.clear();
  body_.clear();
  counterpart_.clear();
  for (std::vector<double>* values :
       {&own_weights_, &weights_, &surface_, &surface_before_, &gap_, &normal_, &area_, &state_})
    values->clear();
  for (std::vector<double>& values : parameters_) values.clear();
}

void CoupledGroup::add(const CoupledContact& contact, const ContactArrays& arrays) {
  const auto k = static_cast<std::size_t>(contact.contact);
  const auto append = [](std::vector<double>& values, const auto& vector) {
    values.insert(values.end(), vector.data(), vector.data() + vector.size());
  };
  contacts_.push_back(contact.contact);
  body_.push_back(contact.node);
  own_weights_.push_back(contact.point.own_weight);
  partners_.insert(partners_.end(), contact.point.partners.begin(), contact.point.partners.end());
  first_partner_.push_back(partners_.size());
  append(surface_, contact.surface);
  append(surface_before_, contact.surface_before);
  gap_.push_back(contact.point.gap);
  append(normal_, contact.point.normal);
  if (!arrays.area.empty()) area_.push_back(arrays.area[k]);
  for (std::size_t p = 0; p < parameters_.size(); ++p) parameters_[p].push_back(arrays.parameters[p][k]);
  for (std::size_t number = 0; number < state_size_; ++number) state_.push_back(arrays.state.at(k, number));
}

// As many entries for each contact as the longest one has.
void CoupledGroup::lay_out_partners() {
  std::size_t most = 1;
  for (std::size_t i = 0; i < count(); ++i) most = std::max(most, first_partner_[i + 1] - first_partner_[i]);
  given_.counterpart_count = static_cast<std::uint32_t>(most);
  counterpart_.assign(most * count(), -1);
  weights_.assign(most * count(), 0.0);
  for (std::size_t i = 0; i < count(); ++i)
    for (std::size_t p = first_partner_[i]; p < first_partner_[i + 1]; ++p) {
      counterpart_[most * i + p - first_partner_[i]] = partners_[p].node;
      weights_[most * i + p - first_partner_[i]] = partners_[p].weight;
    }
}

void CoupledGroup::read_parameters(const ContactArrays& arrays) {
  for (std::size_t p = 0; p < parameters_.size(); ++p)
    for (std::size_t i = 0; i < count(); ++i)
      parameters_[p][i] = arrays.parameters[p][static_cast<std::size_t>(contacts_[i])];
}

void CoupledGroup::keep_forces(double velocity_step) {
  forget_forces();
  const auto d = static_cast<std::size_t>(dimension_);
  ContactList contacts;
  std::vector<double> forces;
  for (std::size_t i = 0; i < count(); ++i) {
    if (impulse(i).isZero(0.0)) continue;
    contacts.push_back(contacts_[i]);
    for (std::size_t c = 0; c < d; ++c) forces.push_back(impulse_[d * i + c] / velocity_step);
  }
  keep(std::move(contacts), std::move(forces));
}

void CoupledGroup::forget_forces() {
  const auto d = static_cast<std::size_t>(dimension_);
  for (const std::int32_t contact : kept_)
    std::fill_n(start_.begin() + static_cast<std::ptrdiff_t>(d * static_cast<std::size_t>(contact)), d, 0.0);
  kept_.clear();
  kept_forces_.clear();
}

void CoupledGroup::keep(ContactList contacts, std::vector<double> forces) {
  kept_ = std::move(contacts);
  kept_forces_ = std::move(forces);
  const auto d = static_cast<std::size_t>(dimension_);
  for (std::size_t i = 0; i < kept_.size(); ++i) {
    const std::size_t first = d * static_cast<std::size_t>(kept_[i]);
    if (start_.size() < first + d) start_.resize(first + d, 0.0);
    std::copy_n(&kept_forces_[d * i], d, &start_[first]);
  }
}

const ilaw_contacts& CoupledGroup::close(const Vector& tangent, const StepView& step) {
  const auto d = static_cast<std::size_t>(dimension_);
  const auto size = static_cast<std::int64_t>(state_size_);
  impulse_.assign(d * count(), 0.0);
  for (std::size_t i = 0; i < count(); ++i)
    for (std::size_t c = 0; c < d; ++c)
      if (const std::size_t k = d * static_cast<std::size_t>(contacts_[i]) + c; k < start_.size())
        impulse_[d * i + c] = step.velocity_step() * start_[k];
  energy_.assign(ILAW_ENERGY_COUNT * count(), 0.0);
  status_.assign(count(), ILAW_FREE);
  next_state_.resize(state_.size());
  batch_ = empty_batch(tangent, step.time, step.velocity_step(), step.dt);
  batch_.node_count = static_cast<std::int64_t>(count());
  batch_.gap = ilaw::input(gap_.data(), 1, 1);
  batch_.normal = ilaw::input(normal_.data(), dimension_, 1);
  batch_.area = ilaw::input(area_.data(), 1, 1);
  parameter_inputs_.clear();
  for (const std::vector<double>& values : parameters_)
    parameter_inputs_.push_back(ilaw::input(values.data(), 1, 1));
  batch_.per_node_parameters = parameter_inputs_.data();
  batch_.state_in = ilaw::input(state_.data(), size, 1);
  batch_.state_out = ilaw::output(next_state_.data(), size, 1);
  batch_.impulse = ilaw::output(impulse_.data(), dimension_, 1);
  if (law_.law()->outputs & ILAW_OUTPUT_ENERGY)
    batch_.energy = ilaw::output(energy_.data(), ILAW_ENERGY_COUNT, 1);
  amount_outputs_.clear();
  for (std::vector<double>& values : amounts_) {
    values.assign(count(), 0.0);
    amount_outputs_.push_back(ilaw::output(values.data(), 1, 0));
  }
  batch_.amounts = amount_outputs_.empty() ? nullptr : amount_outputs_.data();
  batch_.status = status_.data();
  batch_.status_stride = 1;

  given_ = {};
  given_.struct_size = sizeof given_;
  given_.delassus_form = form_;
  given_.law = law_.law();
  given_.instance = law_.instance();
  given_.batch = &batch_;
  lay_out_partners();
  given_.body = body_.data();
  given_.counterpart = counterpart_.data();
  if (!has_partners_) {
    given_.wall_velocity = ilaw::input(surface_.data(), dimension_, 1);
    given_.wall_previous = ilaw::input(surface_before_.data(), dimension_, 1);
  } else if (given_.counterpart_count > 1) {
    given_.counterpart_weight = ilaw::input(weights_.data(), given_.counterpart_count, 1);
  }
  const auto is_one = [](double weight) { return weight == 1.0; };
  if (!std::all_of(own_weights_.begin(), own_weights_.end(), is_one))
    given_.body_weight = ilaw::input(own_weights_.data(), 1, 1);
  return given_;
}

}  // namespace ilaw::host
