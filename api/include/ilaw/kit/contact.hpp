// contact.hpp - when a contact acts, and the velocity it must leave with.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit/node.hpp>

namespace ilaw::kit::inline ILAW_KIT_LEVEL {

// Values of the parameter "activation".
inline constexpr const char* activation_choices[] = {"moreau", "predictive"};
inline constexpr double moreau = 0.0, predictive = 1.0;

// Contact requires 0 <= excess + H_NN r_N _|_ r_N >= 0 where slack <= 0, and r_N = 0 elsewhere.
// rest = v_free,N + v_N^- - excess <= 0: the work of r_N over the step is r_N rest/2 then, for any H.
template <class V>
struct contact_condition {
  V slack, excess, rest;
};

// A contact that must leave with v_N = target, were it not for its energy: in a central-difference host the
// work of r over the step is r.(v^- + v)/2, whatever the steps. So v_N <= -v_N^- where it is pressed: a node
// that was leaving is not stopped, but turns round at most at the speed with which it left. Near the critical
// step such nodes occur, and stopping them makes the motion diverge. Restitution asks for less by itself.
template <class V>
ILAW_KIT_INLINE contact_condition<V> contact_leaving_at(std::type_identity_t<V> target, V slack, V v_free,
                                                        V v_previous) {
  return {slack, larger(v_free - target, v_free + v_previous), smaller(v_previous + target, 0.0)};
}

// moreau: where the gap is closed, v_N + e v_N^- >= 0 (Moreau 1988).
// predictive: where the next gap would not be positive, v_N >= -g/h, so that it is never negative. An impact
// with restitution leaves with -e v_N^- at once, which is larger; whether there is one is decided without the
// impulses of other contacts (contact.md, "Several contacts at one body"). A gap that is negative already
// must not grow; pushing it out would create energy.
template <class Node>
ILAW_KIT_INLINE auto contact_at(const Node& node, number_of<Node> restitution, double activation) {
  using V = number_of<Node>;
  // Zero for moreau: where v_N^- >= 0 no target from -e v_N^- to 0 changes excess or rest.
  const bool predicts = activation == predictive;
  const double step = predicts ? node.position_step : 0.0, rate = predicts ? -node.per_position_step : 0.0;
  const V open = positive_part(node.gap), arrival = open * rate;
  V slack = open + step * node.v_free.n;  // next_gap to the last bit where the gap is positive
  V rebound = -restitution * node.v_previous.n;
  if constexpr (has_smooth<Node>) {
    if (node.is_coupled) {
      const V smooth = open + step * node.v_smooth.n;
      rebound = zero_unless(smooth <= 0.0, rebound);
      slack = smaller(smooth, slack);
    }
  }
  return contact_leaving_at<V>(select(rebound > 0.0, rebound, arrival), slack, node.v_free.n,
                               node.v_previous.n);
}

// What a contact reads of inputs: v_smooth only where an impact may leave with a rebound.
ILAW_KIT_INLINE constexpr std::uint32_t inputs_of_contact(std::uint32_t inputs, double restitution,
                                                          double activation) {
  return restitution > 0.0 && activation != moreau ? inputs : inputs & ~reads_v_smooth;
}

template <class Law>
constexpr parameter<Law> restitution_parameter(typename number_of_law<Law>::type Law::*member) {
  return {.member = member,
          .name = "restitution",
          .symbol = "e",
          .doc = "Newton's coefficient: normal velocity after an impact over the one before, reversed.",
          .maximum = 1.0};
}
template <class Law>
constexpr parameter<Law> activation_parameter(double Law::*member) {
  return {
      .member = member,
      .name = "activation",
      .doc = "moreau: acts where the gap is closed; predictive: acts where the next gap would be negative.",
      .default_value = predictive,
      .choices = activation_choices};
}

}  // namespace ilaw::kit
