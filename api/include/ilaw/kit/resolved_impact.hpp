// resolved_impact.hpp - an impact resolved to second order in its instant, by two impulses in two steps;
// docs/theory/resolved_impact.md derives the equations and proves that no energy is added.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit/contact.hpp>

namespace ilaw::kit::inline ILAW_KIT_LEVEL {

// Values of the parameter "activation" of laws that resolve impacts.
inline constexpr const char* resolving_choices[] = {"moreau", "predictive", "resolved"};
inline constexpr double resolved = 2.0;

template <class Law>
constexpr parameter<Law> resolving_activation_parameter(double Law::*member) {
  parameter<Law> p = activation_parameter<Law>(member);
  p.doc =
      "moreau: acts where the gap is closed; predictive: acts where the next gap would be negative; resolved: the "
      "same, with the impact at its instant within the step.";
  p.choices = resolving_choices;
  return p;
}

// The impulse of a step, and the work W that the impact leaves to the impulse of the next step; 0: none.
template <class V>
struct resolved_impact {
  V impulse, work;
};

// Marks an impact that has no work left to do, but a rebound.
inline constexpr double no_work = -std::numeric_limits<double>::denorm_min();

// gain: v_N - v_free,N. mean + gain/2 is the mean velocity of the step, along which the impulse works.
template <class Node>
ILAW_KIT_INLINE auto resolve_impact(const Node& node, number_of<Node> restitution, number_of<Node> work) {
  using V = number_of<Node>;
  const V inverse_mass = node.delassus.normal(), free = node.v_free.n, before = node.v_previous.n;
  const V mean = 0.5 * (before + free), change = free - before;

  // (v_n)^2 = mean^2 + 2 H W, the rebound of the last step; no more than it may gain, and no pull.
  V gain = 0.0, most = positive_part(-(before + free));
  const mask_of<V> rebounds = work != 0.0;
  if (any(rebounds)) {
    const V twice = 2.0 * (inverse_mass * work), speed = square_root(positive_part(mean * mean + twice));
    const mask_of<V> leaves = mean > 0.0;
    const V raised = select(leaves, twice, speed - mean) / select(leaves, speed + mean, V(1.0));
    gain = zero_unless(rebounds, positive_part(raised));
    most = select(work > 0.0, gain, most);
  }

  // gamma + v_n s + change s^2/2 = 0: the impact at the part s of the step, with the velocity -speed.
  const V open = positive_part(node.gap);
  const mask_of<V> hits = open + node.position_step * (free + gain) <= 0.0;
  V left = 0.0;
  if (any(hits)) {
    const V gamma = open * node.per_position_step, now = mean + gain;
    const V square = positive_part(now * now - 2.0 * change * gamma), speed = square_root(square);
    const mask_of<V> approaches = now <= 0.0;
    const V s = select(approaches, 2.0 * gamma, speed + now) / select(approaches, speed - now, -change);
    const V rest = 1.0 - s, leaving = restitution * speed, rise = leaving + 0.5 * change * rest;
    const mask_of<V> bounces = (leaving > 0.0) & (rise > 0.0);
    const V target = select(bounces, rest * rise - gamma, -gamma);
    const V needed = positive_part(smaller(target - free, most));
    const V loss = 0.5 * (1.0 - restitution * restitution) * square;
    const V after = work - (loss + needed * (mean + 0.5 * needed)) / inverse_mass;
    left = zero_unless(hits & bounces & (needed > 0.0),
                       select((after == 0.0) & (needed < most), V(no_work), after));
    gain = select(hits, needed, gain);
  }
  const V impulse = gain / inverse_mass;
  return resolved_impact<V>{impulse, zero_unless(impulse > 0.0, left)};
}

}  // namespace ilaw::kit
