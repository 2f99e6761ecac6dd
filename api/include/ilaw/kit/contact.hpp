// contact.hpp - when a contact acts, and the velocity it must leave with.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit/node.hpp>

namespace ilaw::kit {

// Contact asks 0 <= excess + H_NN r_N _|_ r_N >= 0 where it is active, r_N = 0 elsewhere.
struct contact_condition {
  bool active;
  double excess;
};

// Closed gap: v_N + e v_N^- >= 0 (Moreau 1988).
template <class Node>
contact_condition moreau_contact(const Node& node, double restitution) {
  return {node.gap <= 0.0, node.v_free.n + restitution * node.v_previous.n};
}

// Next gap: v_N >= -g/h, so that it is never negative. An impact with restitution leaves with -e v_N^- at
// once, which is larger. A gap that is negative already must not grow; pushing it out would create energy.
template <class Node>
contact_condition predict_contact(const Node& node, double restitution) {
  const double arrival = -positive_part(node.gap) / node.position_step;
  const double rebound = -restitution * node.v_previous.n;
  return {node.v_free.n < arrival, node.v_free.n - (rebound > 0.0 ? rebound : arrival)};
}

}  // namespace ilaw::kit
