// tangential_spring.hpp - Coulomb's friction by a tangential spring of stiffness k, implicit, for H with one
// tangential entry. Its memory is the elastic slip xi, xi' = xi + h (v^- + v)/2 while it sticks. Then
// r_T = -h k (xi + xi')/2, so that
//     s = v_free + v^- + 4 xi/h + (h_T + 4/(h^2 k)) r_T = 0,
// and a node that slides has r_T on the cone, against s. docs/theory/springs.md shows that no step adds
// energy. k = inf: a rigid stick.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit/friction.hpp>

namespace ilaw::kit::inline ILAW_KIT_LEVEL {

// The impulse -q/resistance within the cone of a pressure; says where the node slides.
template <class Node, class V = number_of<Node>>
ILAW_KIT_INLINE mask_of<V> rub_against(Node& node, V normal, vector<V> q, V resistance, V pressure,
                                       V friction) {
  const friction_factor<V> found =
      rub(resistance, pressure, q.scaled_tangential_length(), V(0.0), V(0.0), friction);
  node.impulse = q.against(normal, found.factor);
  return found.status == status::slip;
}

template <class V>
struct tangential_spring {
  double step;                 // h
  V stiffness;                 // k
  V rate, per_rate, softness;  // h k, 1/(h k) and 4/(h^2 k); 0 where there is no spring
  bool is_rigid, is_soft;      // at some node

  // A spring too soft for 1/(h k) to be a number is none.
  ILAW_KIT_INLINE static mask_of<V> counts(double step, V stiffness) {
    return step * stiffness >= std::numeric_limits<double>::min();
  }
  // rubs: where there is friction. acts: where a spring counts.
  ILAW_KIT_INLINE tangential_spring(double h, V k, mask_of<V> rubs, mask_of<V> acts)
      : step(h),
        stiffness(k),
        rate(zero_unless(acts, h * k)),
        per_rate(zero_unless(acts, 1.0 / (h * k))),
        softness(zero_unless(acts, 4.0 / h / (h * k))),
        is_rigid(any(rubs & (k == infinity))),
        is_soft(any(rubs & !(k == infinity))) {}

  // s without r_T. A rigid stick gives back the part e_T of v_T^-.
  template <class Node>
  ILAW_KIT_INLINE vector<V> slip(const Node& node, vector<V> spring, V given_back) const {
    if (!is_soft) return node.v_free + given_back * node.v_previous;
    const mask_of<V> rigid = stiffness == infinity;
    return node.v_free + select(rigid, given_back, V(1.0)) * node.v_previous +
           zero_unless(!rigid, V(4.0 / step)) * spring;
  }
  // e_T of a rigid stick: what of v_T^- the free velocity has turned round, so that the stick does no work. A
  // little more, as rounding may leave velocities along v^-, which then do none either.
  template <class Node>
  ILAW_KIT_INLINE V given_back(const Node& node) const {
    constexpr double more_than_rounding = 1.0 + 0x1p-48;
    if (!is_rigid) return 0.0;
    const V speed = tangential_product(node.v_previous, node.v_previous);
    const V turned = 0.0 - more_than_rounding * tangential_product(node.v_free, node.v_previous);
    return zero_unless(turned > 0.0, turned / larger(turned, speed));
  }
  // Gives the impulse; says where the node slides.
  template <class Node>
  ILAW_KIT_INLINE mask_of<V> rub(Node& node, V normal, vector<V> spring, V pressure, V friction) const {
    return rub_against(node, normal, slip(node, spring, given_back(node)),
                       node.delassus.tangential() + softness, pressure, friction);
  }
  // The spring after the step, where it acts. A node that sticks strains it along; one that slides leaves no
  // more than the force holds, in the direction of its end. twice_mean: v^- + v; most: the cone's radius.
  ILAW_KIT_INLINE vector<V> strained(vector<V> spring, vector<V> r, vector<V> twice_mean, V h_t, V most,
                                     mask_of<V> slides, mask_of<V> acts) const {
    const V h = step;
    const vector<V> moved = spring + (0.5 * h) * twice_mean;
    const V longest = per_rate * most, length = moved.tangential_length();
    const mask_of<V> by_force = (h * h * stiffness * h_t > 4.0) & !slides;
    const vector<V> kept = select(slides & (length > longest), longest / length, V(1.0)) * moved;
    const vector<V> next = select(by_force, (-2.0 * per_rate) * r - spring, kept);
    const mask_of<V> holds = (stiffness < infinity) & acts;
    return {0.0, zero_unless(holds, next.t1) + 0.0, zero_unless(holds, next.t2) + 0.0};  // never -0
  }
  ILAW_KIT_INLINE V energy(vector<V> a, vector<V> b) const {
    return zero_unless(stiffness < infinity, 0.5 * stiffness * tangential_product(a, b));
  }
};

}  // namespace ilaw::kit
