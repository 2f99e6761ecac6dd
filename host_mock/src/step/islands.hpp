// islands.hpp - the acting contacts of a step in groups that no shared node joins, so that each can be
// solved for itself.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "contact/interface.hpp"

#include <vector>

namespace ilaw::host {

// Contacts of an interface that share no node: they can be solved at once.
struct ContactPart {
  Interface* interface;
  ContactList contacts;
};
// In the order of solution.
using ContactGroup = std::vector<ContactPart>;

// The islands of a group, by their first contact; each keeps the group's order.
std::vector<ContactGroup> islands_of(const ContactGroup& group);

}  // namespace ilaw::host
