// colours.hpp - the active contacts of an interface in groups that can be solved at once, as no two
// contacts of a group share a node.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "contact/interface.hpp"

#include <cstdint>
#include <vector>

namespace ilaw::host {

class Colours {
 public:
  explicit Colours(int node_count) : of_node_(static_cast<std::size_t>(node_count)) {}

  // For the active contacts of a step that the interface has opened. Idle ones are kept apart,
  // whatever nodes they share: the order of those that act must not depend on how many others are
  // active.
  void assign(const Interface& interface);

  // Calls visit(contacts) with what may be solved at once, in the order of solution.
  template <class Visit>
  void for_each_acting(Visit visit) const {
    for (std::size_t colour = 0; colour < acting_.size(); ++colour)
      if (colour == serial)
        for (const std::int32_t contact_index : acting_[colour]) visit(ContactList{contact_index});
      else
        visit(acting_[colour]);
  }
  const ContactList& idle() const { return idle_; }

 private:
  // For all contacts that find no other colour: they are solved one by one.
  static constexpr std::size_t serial = 63;

  std::size_t colour_of(int node, const ContactPoint& point);

  std::vector<ContactList> acting_;  // by colour
  ContactList idle_;
  std::vector<std::uint64_t> of_node_;  // a bit per colour
};

}  // namespace ilaw::host
