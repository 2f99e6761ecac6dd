// SPDX-License-Identifier: BSD-3-Clause
#include "contact/contact_heat.hpp"

#include <cmath>
#include <limits>
#include <string_view>
#include <utility>

namespace ilaw::host {

ContactHeat::ContactHeat(const ilaw_instance_info& info, bool gives_amounts,
                         std::optional<Table> obstacle_temperature)
    : obstacle_(std::move(obstacle_temperature)) {
  constexpr std::array<std::string_view, 3> amount_names{"heat", "counterpart_heat", "conducted_heat"};
  inputs_.fill(-1);
  amounts_.fill(-1);
  for (std::uint32_t p = 0; p < info.per_node_parameter_count; ++p)
    for (std::size_t k = 0; k < inputs_.size(); ++k)
      if (std::string_view(info.per_node_parameters[p]) == field_names[k]) inputs_[k] = static_cast<int>(p);
  for (std::uint32_t a = 0; gives_amounts && a < info.amount_count; ++a)
    for (std::size_t k = 0; k < amounts_.size(); ++k)
      if (std::string_view(info.amounts[a]->name) == amount_names[k]) amounts_[k] = static_cast<int>(a);
}

void ContactHeat::open(double time, std::size_t contact_count, const std::vector<std::int32_t>& active) {
  flows_.resize(contact_count);
  for (const std::int32_t contact : active) flows_[static_cast<std::size_t>(contact)] = {};
  if (obstacle_) obstacle_temperature_ = obstacle_->at(time)[0];
}

// Against a facet: the temperature where the node meets it, and the capacity that heat meets there if it is
// divided as the impulse is, 1/C = sum of w_i W_i/C_i. A node in several contacts is a set of parallel parts:
// one has w_i/W_i of its capacity, where W_i is the sum of its weights. Alone, W_i = w_i.
void ContactHeat::give(std::size_t contact, int node, const ContactPoint& point,
                       ContactArrays& contacts) const {
  double temperature = obstacle_temperature_, capacity = std::numeric_limits<double>::infinity();
  if (!point.partners.empty()) {
    temperature = capacity = 0.0;
    for (const auto& [partner, weight] : point.partners) {
      temperature += weight * temperature_[partner];
      const double sum = sums_of_weights_ ? sums_of_weights_[partner] : std::fabs(weight);
      capacity += std::fabs(weight) * sum / capacity_[partner];
    }
    capacity = 1.0 / capacity;
  }
  const double own = sums_of_weights_ ? capacity_[node] / sums_of_weights_[node] : capacity_[node];
  const std::array values{temperature_[node], temperature, own, capacity};
  for (std::size_t k = 0; k < values.size(); ++k)
    if (inputs_[k] >= 0) contacts.parameters[static_cast<std::size_t>(inputs_[k])][contact] = values[k];
}

}  // namespace ilaw::host
