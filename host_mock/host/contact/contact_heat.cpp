// SPDX-License-Identifier: BSD-3-Clause
#include "contact/contact_heat.hpp"

#include <cmath>
#include <limits>
#include <string_view>
#include <utility>

namespace ilaw::host {

ContactHeat::ContactHeat(const ilaw_instance_info& info, std::optional<Table> obstacle_temperature)
    : obstacle_(std::move(obstacle_temperature)) {
  constexpr std::array<std::string_view, 3> amount_names{"heat", "counterpart_heat", "heat_per_kelvin"};
  inputs_.fill(-1);
  amounts_.fill(-1);
  for (std::uint32_t p = 0; p < info.per_node_parameter_count; ++p)
    for (std::size_t k = 0; k < inputs_.size(); ++k)
      if (std::string_view(info.per_node_parameters[p]) == field_names[k]) inputs_[k] = static_cast<int>(p);
  for (std::uint32_t a = 0; a < info.amount_count; ++a)
    for (std::size_t k = 0; k < amounts_.size(); ++k)
      if (std::string_view(info.amounts[a]->name) == amount_names[k]) amounts_[k] = static_cast<int>(a);
  for (std::uint32_t a = 0; a < info.amount_count; ++a)
    if (std::string_view(info.amounts[a]->name) == "conducted_heat") conducted_heat_ = static_cast<int>(a);
}

void ContactHeat::open(double time, std::size_t contact_count, const std::vector<std::int32_t>& active) {
  flows_.resize(contact_count);
  for (const std::int32_t contact : active) flows_[static_cast<std::size_t>(contact)] = {};
  if (obstacle_) obstacle_temperature_ = obstacle_->at(time)[0];
}

// A side is at the mean of its nodes, and has the capacity that heat meets there if it is divided as the
// impulse is: 1/C = sum of w_i^2/C_i.
void ContactHeat::give(std::size_t contact, int node, const ContactPoint& point,
                       ContactArrays& contacts) const {
  struct Side {
    double temperature = 0.0, softness = 0.0;
  };
  Side own, other;
  const auto add_to = [&](Side& side) {
    return [&](int index, double weight) {
      side.temperature += weight * temperature_[index];
      side.softness += weight * weight / capacity_[index];
    };
  };
  point.for_each_side(node, add_to(own), add_to(other));
  if (point.partners.empty()) other.temperature = obstacle_temperature_;
  const std::array values{own.temperature, other.temperature, 1.0 / own.softness, 1.0 / other.softness};
  for (std::size_t k = 0; k < values.size(); ++k)
    if (inputs_[k] >= 0) contacts.parameters[static_cast<std::size_t>(inputs_[k])][contact] = values[k];
}

}  // namespace ilaw::host
