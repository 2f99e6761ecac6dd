// lagged_friction.hpp - friction against the velocity of the half step before, as explicit codes have it. See
// docs/published_laws.md.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit.hpp>

namespace published {

using namespace ilaw::kit;

// The impulse that stops a closed contact along the normal.
template <class V, class Node>
V stopping_impulse(const Node& node) {
  const contact_condition<V> contact = contact_at(node, V(0.0), moreau);
  return zero_unless(contact.slack <= 0.0, positive_part(-contact.excess / node.delassus.normal()));
}

template <class Law, class V>
constexpr parameter<Law> finite_friction(V Law::*member) {
  parameter<Law> p = friction_parameter(member).as_required();
  p.infinity_allowed = false;
  return p;
}

template <class V>
struct lagged_coulomb {
  V friction;

  static constexpr law_card card{.id = "lagged_coulomb",
                                 .title = "Coulomb friction against the last velocity",
                                 .doc = "r_T = -mu r_N v_T^-/|v_T^-|, with contact.",
                                 .delassus_forms = ILAW_DELASSUS_SCALAR,
                                 .inputs = reads_gap | reads_v_previous,
                                 .is_isotropic = true};
  static constexpr const char* references[] = {"Explicit codes that take the sign of the velocity they know"};
  static constexpr parameter<lagged_coulomb> parameters[] = {finite_friction(&lagged_coulomb::friction)};

  template <class Node>
  status_of<V> step(Node& node) const {
    const V normal = stopping_impulse<V>(node), speed = node.v_previous.tangential_length();
    const mask_of<V> slides = (normal > 0.0) & (speed > 0.0);
    node.impulse = node.v_previous.against(normal, zero_unless(slides, friction * normal / speed));
    return select(normal > 0.0, select(slides & (friction > 0.0), status::slip, status::closed),
                  status::free);
  }
};

constexpr const char* direction_choices[] = {"vector", "components"};
constexpr double by_component = 1.0;

template <class V>
struct regularized_coulomb {
  V friction, slow_speed;
  double direction;

  static constexpr law_card card{.id = "regularized_coulomb",
                                 .title = "Coulomb friction regularized by a speed",
                                 .doc = "r_T = -mu r_N min(1, |v_T^-|/v_s) v_T^-/|v_T^-|, with contact.",
                                 .delassus_forms = ILAW_DELASSUS_SCALAR,
                                 .inputs = reads_gap | reads_v_previous};
  static constexpr const char* references[] = {
      "J. T. Oden, J. A. C. Martins, 1985, Models and computational methods for dynamic friction phenomena"};
  static constexpr parameter<regularized_coulomb> parameters[] = {
      finite_friction(&regularized_coulomb::friction),
      {.member = &regularized_coulomb::slow_speed,
       .name = "slow_speed",
       .symbol = "v_s",
       .unit = "m/s",
       .doc = "Below it friction is proportional to the speed.",
       .required = true,
       .minimum_excluded = true},
      {.member = &regularized_coulomb::direction,
       .name = "direction",
       .doc =
           "vector: as in the papers; components: each axis by itself, as a formula in 2D is often extended.",
       .choices = direction_choices}};

  template <class Node>
  status_of<V> step(Node& node) const {
    const V normal = stopping_impulse<V>(node);
    const vector<V> v = node.v_previous;
    const V whole = v.tangential_length();
    const bool splits = direction == by_component;
    const V first = over(splits ? absolute(v.t1) : whole), second = over(splits ? absolute(v.t2) : whole);
    node.impulse = {normal, 0.0 - friction * normal * (v.t1 / first),
                    0.0 - friction * normal * (v.t2 / second)};
    const mask_of<V> rubs = (whole > 0.0) & (friction > 0.0);
    return select(normal > 0.0, select(rubs, status::slip, status::closed), status::free);
  }

 private:
  V over(V speed) const { return larger(speed, slow_speed); }
};

}  // namespace published
