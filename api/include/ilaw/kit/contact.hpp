// contact.hpp - when a contact acts, and the velocity it must leave with.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit/node.hpp>

namespace ilaw::kit::inline ILAW_KIT_LEVEL {

// Values of the parameter "activation".
inline constexpr const char* activation_choices[] = {"moreau", "predictive"};
inline constexpr double moreau = 0.0, predictive = 1.0;

// Contact asks 0 <= excess + H_NN r_N _|_ r_N >= 0 where slack <= 0, and r_N = 0 elsewhere.
// rest = v_free,N + v_N^- - excess <= 0: the work of r_N over the step is r_N rest/2 then, for any H.
struct contact_condition {
  double slack, excess, rest;
};

// A contact that must leave with v_N = target, were it not for its energy: in a central-difference host the
// work of r over the step is r.(v^- + v)/2, whatever the steps. So v_N <= -v_N^- where it is pressed: a node
// that was leaving is not stopped, but turns round at most at the speed with which it left. Near the critical
// step such nodes are met, and stopping them makes the motion diverge. Restitution asks for less by itself.
constexpr contact_condition contact_leaving_at(double target, double slack, double v_free,
                                               double v_previous) {
  return {slack, larger(v_free - target, v_free + v_previous), smaller(v_previous + target, 0.0)};
}

// moreau: where the gap is closed, v_N + e v_N^- >= 0 (Moreau 1988).
// predictive: where the next gap would not be positive, v_N >= -g/h, so that it is never negative. An impact
// with restitution leaves with -e v_N^- at once, which is larger. A gap that is negative already must not
// grow; pushing it out would create energy.
struct activated_contact {
  double slack, arrival;
};
template <class Node>
activated_contact activated(const Node& node, double activation) {
  // The same for all nodes, and zero for moreau: where v_N^- >= 0 no target from -e v_N^- to 0 changes excess
  // or rest.
  const bool predicts = activation == predictive;
  const double step = predicts ? node.position_step : 0.0, rate = predicts ? -1.0 / node.position_step : 0.0;
  const double open = positive_part(node.gap), arrival = open * rate;
  // Where the gap is positive this is next_gap, to the last bit.
  const double ahead = open + step * node.v_free.n;
  return {ahead, arrival};
}
template <class Node>
contact_condition contact_at(const Node& node, double restitution, double activation) {
  const double rebound = -restitution * node.v_previous.n;
  const activated_contact a = activated(node, activation);
  return contact_leaving_at(rebound > 0.0 ? rebound : a.arrival, a.slack, node.v_free.n, node.v_previous.n);
}
// The same without restitution, to the last bit.
template <class Node>
contact_condition inelastic_contact_at(const Node& node, double activation) {
  const activated_contact a = activated(node, activation);
  return contact_leaving_at(a.arrival, a.slack, node.v_free.n, node.v_previous.n);
}

}  // namespace ilaw::kit
