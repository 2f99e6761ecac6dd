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

Eigen::Index contact_count(const ContactGroup& group);

// Calls visit(interface, contact, k) with each contact and its number in the group.
template <class Visit>
void for_each_contact(const ContactGroup& group, Visit visit) {
  Eigen::Index k = 0;
  for (const auto& [interface, contacts] : group)
    for (const std::int32_t contact : contacts) visit(*interface, contact, k++);
}

// Impulses of all contacts times the root of their delassus: a norm in energy.
Dofs scaled_impulses(const ContactGroup& group);

// What each contact was asked at last.
std::vector<Vector> asked_velocities(const ContactGroup& group);
// Asks all laws at these velocities.
void answer_at(const ContactGroup& group, const std::vector<Vector>& velocities, const StepView& step);

// The islands of a group, by their first contact; each keeps the group's order.
std::vector<ContactGroup> islands_of(const ContactGroup& group);

}  // namespace ilaw::host
