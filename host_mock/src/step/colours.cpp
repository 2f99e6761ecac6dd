// SPDX-License-Identifier: BSD-3-Clause
#include "step/colours.hpp"

#include <algorithm>
#include <bit>

namespace ilaw::host {

void Colours::assign(const Interface& interface) {
  acting_.clear();
  idle_.clear();
  std::fill(of_node_.begin(), of_node_.end(), 0);
  for (const std::int32_t contact_index : interface.active()) {
    if (interface.is_idle(contact_index)) {
      idle_.push_back(contact_index);
      continue;
    }
    const std::size_t colour = colour_of(interface.node_of(contact_index), interface.point(contact_index));
    if (acting_.size() <= colour) acting_.resize(colour + 1);
    acting_[colour].push_back(contact_index);
  }
}

// Greedy: the first colour that none of the contact's nodes has.
std::size_t Colours::colour_of(int node, const ContactPoint& point) {
  std::uint64_t& own = of_node_[static_cast<std::size_t>(node)];
  const auto of_partner = [&](int i) -> std::uint64_t& {
    return of_node_[static_cast<std::size_t>(point.partners[static_cast<std::size_t>(i)])];
  };
  std::uint64_t taken = own;
  for (int i = 0; i < point.partner_count; ++i) taken |= of_partner(i);
  const auto colour = std::min(static_cast<std::size_t>(std::countr_one(taken)), serial);
  const std::uint64_t mark = std::uint64_t{1} << colour;
  own |= mark;
  for (int i = 0; i < point.partner_count; ++i) of_partner(i) |= mark;
  return colour;
}

}  // namespace ilaw::host
