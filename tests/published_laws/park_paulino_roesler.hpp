// park_paulino_roesler.hpp - the cohesive law of Park, Paulino and Roesler, with unloading of each mode to
// the origin. See docs/published_laws.md.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "impact_springs.hpp"

namespace published {

// The part of the toughness that a mode still has at the opening x of its final opening, and its slope over
// x: F = (a/m)^m (1-x)^a (m/a+x)^m, m = a (a-1) l^2/(1 - a l^2), steepest at x = l.
template <class V>
struct decay {
  V shape, m, scale;

  ILAW_KIT_INLINE decay(V exponent, V peak)
      : shape(exponent),
        m(exponent * (exponent - 1.0) * peak * peak / (1.0 - exponent * peak * peak)),
        scale(power(V(exponent / m), m)) {}
  ILAW_KIT_INLINE V at(V x) const { return scale * power(V(1.0 - x), shape) * power(V(m / shape + x), m); }
  ILAW_KIT_INLINE V slope_over(V x) const {  // -F'/x
    return scale * (shape + m) * power(V(1.0 - x), V(shape - 1.0)) * power(V(m / shape + x), V(m - 1.0));
  }
};

template <class V>
struct park_paulino_roesler {
  V strength, toughness, strength_2, toughness_2, exponent, exponent_2, peak, peak_2;

  static constexpr law_card card{
      .id = "park_paulino_roesler",
      .title = "Cohesive law of Park, Paulino and Roesler",
      .doc = "Tractions of one potential as both openings grow; unloads to the origin by mode.",
      .delassus_forms = ILAW_DELASSUS_SCALAR,
      .inputs = reads_v_previous | reads_area,
      .capabilities = can_adhere | can_store_energy};
  static constexpr const char* references[] = {
      "K. Park, G. H. Paulino, J. R. Roesler, 2009, A unified potential-based cohesive model of mixed-mode fracture",
      "K. Park, G. H. Paulino, 2012, Computational implementation of the PPR potential-based cohesive model in ABAQUS"};

  static constexpr parameter<park_paulino_roesler> of_size(V park_paulino_roesler::*member, const char* name,
                                                           const char* unit) {
    return {.member = member, .name = name, .unit = unit, .required = true, .minimum_excluded = true};
  }
  static constexpr parameter<park_paulino_roesler> of_shape(V park_paulino_roesler::*member, const char* name,
                                                            double usual, double least, double most) {
    return {.member = member, .name = name, .default_value = usual, .minimum = least, .maximum = most};
  }
  static constexpr parameter<park_paulino_roesler> parameters[] = {
      of_size(&park_paulino_roesler::strength, "strength", "N/m^2"),
      of_size(&park_paulino_roesler::toughness, "toughness", "J/m^2"),
      of_size(&park_paulino_roesler::strength_2, "strength_2", "N/m^2"),
      of_size(&park_paulino_roesler::toughness_2, "toughness_2", "J/m^2"),
      of_shape(&park_paulino_roesler::exponent, "exponent", 3.0, 1.5, 8.0),
      of_shape(&park_paulino_roesler::exponent_2, "exponent_2", 3.0, 1.5, 8.0),
      of_shape(&park_paulino_roesler::peak, "peak", 0.125, 0.01, 0.3),
      of_shape(&park_paulino_roesler::peak_2, "peak_2", 0.125, 0.01, 0.3)};

  struct state {
    vector<V> opening;
    V most_open, most_sheared;
  };
  static constexpr state_variable<state> state_variables[] = {
      {.member = &state::opening, .name = "opening", .unit = "m"},
      {.member = &state::most_open, .name = "most_open", .unit = "m", .minimum = 0.0},
      {.member = &state::most_sheared, .name = "most_sheared", .unit = "m", .minimum = 0.0}};

  template <class Node>
  status_of<V> step(Node& node) const {
    const decay<V> opens(exponent, peak), shears(exponent_2, peak_2);
    const V end = final_opening(opens, peak, toughness, strength),
            end_2 = final_opening(shears, peak_2, toughness_2, strength_2);
    const vector<V> w = node.state.opening;
    const V opened = positive_part(w.n), sheared = w.tangential_length();
    node.state.most_open = larger(node.state.most_open, opened);
    node.state.most_sheared = larger(node.state.most_sheared, sheared);
    // Psi = min(phi_n, phi_t) - N T, with N and T cut off where a mode has nothing left.
    const mask_of<V> is_tougher = toughness >= toughness_2;
    const V first = select(is_tougher, toughness, V(1.0)), second = select(is_tougher, V(1.0), toughness_2);
    const V n = positive_part(first * opens.at(part(opened, end)) - positive_part(toughness - toughness_2)),
            t = positive_part(second * shears.at(part(sheared, end_2)) -
                              positive_part(toughness_2 - toughness));
    const V open = first * opens.slope_over(part(node.state.most_open, end)) / (end * end) * t,
            pressed = toughness * opens.slope_over(V(0.0)) / (end * end);
    const V stiff = select(w.n < 0.0, pressed, open),
            stiff_2 = second * shears.slope_over(part(node.state.most_sheared, end_2)) / (end_2 * end_2) * n;
    pull(node, w, node.area * stiff, node.area * stiff_2);
    return select((stiff > 0.0) | (stiff_2 > 0.0), status::bonded, status::free);
  }

 private:
  ILAW_KIT_INLINE static V part(V opening, V end) { return smaller(opening / end, V(1.0)); }
  static V final_opening(const decay<V>& mode, V peak, V energy, V most) {
    return energy * mode.slope_over(peak) * peak / most;
  }
  // The openings at the next positions; stored is what unloading to the origin gives back.
  template <class Node>
  static void pull(Node& node, vector<V> w, V stiff, V stiff_2) {
    const V step = node.velocity_step;
    node.impulse = w.against(0.0 - step * stiff * w.n, step * stiff_2);
    const vector<V> v = node.v_free + node.delassus.times(node.impulse), mean = node.v_previous + v;
    const vector<V> next = w + V(node.position_step) * v;
    node.state.opening = next;
    if (!node.wants_energy) return;
    node.stored = positive_part(0.5 * (stiff * w.n * next.n + stiff_2 * tangential_product(w, next)));
    node.normal_gain = -0.5 * node.impulse.n * mean.n;
    node.tangential_gain = -0.5 * tangential_product(node.impulse, mean);
  }
};

}  // namespace published
