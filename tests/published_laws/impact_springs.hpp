// impact_springs.hpp - springs whose damping grows with the indentation, as their papers print them. See
// docs/published_laws.md.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit.hpp>

namespace published {

using namespace ilaw::kit;

template <class V>
ILAW_KIT_INLINE V power(V x, V p) {
  return zero_unless(x > 0.0, exp(p * log(select(x > 0.0, x, V(1.0)))));
}

// F = k x^p (1 + factor x'), of the indentation and of the last known velocity. The energy is the level that
// makes an elastic spring in a central-difference host exact, as in the law penalty.
template <class V, class Node>
status_of<V> push(Node& node, V stiffness, V exponent, V factor) {
  const V x = positive_part(-node.gap), h = node.velocity_step;
  const V elastic = h * stiffness * power(x, exponent), damper = factor * node.v_previous.n;
  node.impulse.n = zero_unless(x > 0.0, elastic - elastic * damper);
  if (node.wants_energy) {
    const V v = node.v_free.n + node.delassus.normal() * node.impulse.n;
    const V level = elastic / h * (x / (exponent + 1.0) - 0.5 * node.position_step * v);
    node.stored = positive_part(level);
    node.normal_gain = -0.5 * elastic * (node.v_previous.n + v);
  }
  return select(x > 0.0, status::closed, status::free);
}

template <class Law, class V>
constexpr parameter<Law> stiffness_parameter(V Law::*member) {
  return {.member = member,
          .name = "stiffness",
          .symbol = "k",
          .unit = "N/m^p",
          .doc = "Of a node.",
          .required = true};
}
template <class Law, class V>
constexpr parameter<Law> exponent_parameter(V Law::*member) {
  return {.member = member,
          .name = "exponent",
          .symbol = "p",
          .doc = "Power of the indentation.",
          .default_value = 1.5,
          .minimum = 1.0,
          .maximum = 3.0};
}

template <class V>
struct hunt_crossley {
  V stiffness, exponent, loss;

  static constexpr law_card card{.id = "hunt_crossley",
                                 .title = "Spring of Hunt and Crossley",
                                 .doc = "F = k x^p (1 + 3/2 alpha x'), explicit.",
                                 .delassus_forms = ILAW_DELASSUS_SCALAR,
                                 .inputs = reads_gap | reads_v_previous,
                                 .capabilities = can_store_energy,
                                 .is_isotropic = true};
  static constexpr const char* references[] = {
      "K. H. Hunt, F. R. E. Crossley, 1975, Coefficient of restitution interpreted as damping in vibroimpact"};
  static constexpr parameter<hunt_crossley> parameters[] = {
      stiffness_parameter(&hunt_crossley::stiffness),
      exponent_parameter(&hunt_crossley::exponent),
      {.member = &hunt_crossley::loss,
       .name = "loss",
       .symbol = "alpha",
       .unit = "s/m",
       .doc = "Restitution is 1 - alpha v at small speeds."}};

  template <class Node>
  status_of<V> step(Node& node) const {
    return push<V>(node, stiffness, exponent, 1.5 * loss);
  }
};

template <class V>
struct lankarani_nikravesh {
  V stiffness, exponent, restitution;

  static constexpr law_card card{
      .id = "lankarani_nikravesh",
      .title = "Spring of Lankarani and Nikravesh",
      .doc = "F = k x^p (1 + 3 (1 - e^2) x'/(4 x'_0)), explicit; x'_0 where it closed.",
      .delassus_forms = ILAW_DELASSUS_SCALAR,
      .inputs = reads_gap | reads_v_previous,
      .capabilities = can_store_energy,
      .is_isotropic = true};
  static constexpr const char* references[] = {
      "H. M. Lankarani, P. E. Nikravesh, 1990, A contact force model with hysteresis damping for impact analysis of "
      "multibody systems"};
  static constexpr parameter<lankarani_nikravesh> parameters[] = {
      stiffness_parameter(&lankarani_nikravesh::stiffness),
      exponent_parameter(&lankarani_nikravesh::exponent),
      {.member = &lankarani_nikravesh::restitution,
       .name = "restitution",
       .symbol = "e",
       .doc = "Newton's coefficient, in the loss of energy.",
       .default_value = 1.0,
       .maximum = 1.0}};

  struct state {
    V is_closed, speed;
  };
  static constexpr state_variable<state> state_variables[] = {
      {.member = &state::is_closed, .name = "is_closed", .minimum = 0.0, .maximum = 1.0, .whole = true},
      {.member = &state::speed, .name = "speed", .unit = "m/s", .doc = "x'_0, at which the contact closed."}};

  template <class Node>
  status_of<V> step(Node& node) const {
    const V speed = select(node.state.is_closed > 0.0, node.state.speed, 0.0 - node.v_previous.n);
    const mask_of<V> is_closed = node.gap < 0.0;
    node.state.is_closed = zero_unless(is_closed, V(1.0));
    node.state.speed = zero_unless(is_closed, speed);
    const V loss = 0.75 * (1.0 - restitution * restitution);
    return push<V>(node, stiffness, exponent, zero_unless(loss > 0.0, loss / speed));
  }
};

}  // namespace published
