// contact.hpp - when a contact acts, and the velocity it must leave with.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit/node.hpp>

namespace ilaw::kit::inline ILAW_KIT_LEVEL {

// Values of the parameter "activation".
inline constexpr const char* activation_choices[] = {"moreau", "predictive"};
inline constexpr double moreau = 0.0, predictive = 1.0;

// Contact asks 0 <= excess + H_NN r_N _|_ r_N >= 0 where slack <= 0, and r_N = 0 elsewhere.
struct contact_condition {
  double slack, excess;
};

// moreau: where the gap is closed, v_N + e v_N^- >= 0 (Moreau 1988).
// predictive: where the next gap would not be positive, v_N >= -g/h, so that it is never negative. An impact
// with restitution leaves with -e v_N^- at once, which is larger. A gap that is negative already must not
// grow; pushing it out would create energy.
template <class Node>
contact_condition contact_at(const Node& node, double restitution, double activation) {
  const double rebound = -restitution * node.v_previous.n;
  const double rate = 1.0 / node.position_step;  // the same for all nodes: divided once
  const double arrival = -positive_part(node.gap) * rate;
  const double predicted = rebound > 0.0 ? rebound : arrival;
  const double ahead = node.gap > 0.0 ? next_gap(node) : node.v_free.n;
  return {activation == predictive ? ahead : node.gap,
          node.v_free.n - (activation == predictive ? predicted : rebound)};
}

}  // namespace ilaw::kit
