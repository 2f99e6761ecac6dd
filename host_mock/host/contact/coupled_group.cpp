// SPDX-License-Identifier: BSD-3-Clause
#include "contact/coupled_group.hpp"

#include <ilaw/arrays.hpp>

#include <algorithm>
#include <utility>

namespace ilaw::host {

CoupledGroup::CoupledGroup(const Law& law, int dimension, ilaw_delassus_form form, bool has_partners)
    : dimension_(dimension), form_(form), has_partners_(has_partners), law_(law), watched_(law, dimension) {}

void CoupledGroup::open() {
  contacts_.clear();
  first_partner_.assign(1, 0);
  partners_.clear();
  body_.clear();
  counterpart_.clear();
  for (std::vector<double>* values : {&own_weights_, &weights_, &surface_, &surface_before_, &gap_, &normal_})
    values->clear();
}

void CoupledGroup::add(const CoupledContact& contact) {
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

void CoupledGroup::keep_forces(double velocity_step) {
  forget_forces();
  const auto d = static_cast<std::size_t>(dimension_);
  for (std::size_t i = 0; i < count(); ++i) {
    if (impulse(i).isZero(0.0)) continue;
    kept_.push_back(contacts_[i]);
    for (std::size_t c = 0; c < d; ++c) kept_forces_.push_back(columns_.impulse()[d * i + c] / velocity_step);
  }
  start_from_kept();
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
  start_from_kept();
}

void CoupledGroup::start_from_kept() {
  const auto d = static_cast<std::size_t>(dimension_);
  for (std::size_t i = 0; i < kept_.size(); ++i) {
    const std::size_t first = d * static_cast<std::size_t>(kept_[i]);
    if (start_.size() < first + d) start_.resize(first + d, 0.0);
    std::copy_n(&kept_forces_[d * i], d, &start_[first]);
  }
}

const ilaw_contacts& CoupledGroup::close(ContactArrays& arrays, const Vector& tangent, const StepView& step) {
  const auto d = static_cast<std::size_t>(dimension_);
  const auto size = static_cast<std::ptrdiff_t>(count());
  columns_.use(law_, dimension_, {(law_.outputs() & ILAW_OUTPUT_ENERGY) != 0, true}, size);
  columns_.take(arrays, contacts_.data(), size, {false, false});
  std::fill_n(columns_.status(), size, std::uint8_t{ILAW_FREE});
  for (std::size_t i = 0; i < count(); ++i)
    for (std::size_t c = 0; c < d; ++c) {
      const std::size_t k = d * static_cast<std::size_t>(contacts_[i]) + c;
      columns_.impulse()[d * i + c] = k < start_.size() ? step.velocity_step() * start_[k] : 0.0;
    }
  batch_ = empty_batch(tangent, step.time, step.velocity_step(), step.dt);
  columns_.fill(batch_);
  batch_.gap = ilaw::input(gap_.data(), 1, 1);
  batch_.normal = ilaw::input(normal_.data(), dimension_, 1);

  given_ = {};
  given_.struct_size = sizeof given_;
  given_.delassus_form = form_;
  given_.law = watched_.law();
  given_.instance = watched_.instance();
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
