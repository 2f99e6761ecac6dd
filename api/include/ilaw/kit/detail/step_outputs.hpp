// step_outputs.hpp - what few laws give beside impulse, state and energy: the largest stable step of the
// nodes of a batch, heat and wear.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit/detail/view.hpp>
#include <ilaw/kit/heat.hpp>

namespace ilaw::kit::inline ILAW_KIT_LEVEL::detail {

template <class V>
struct step_limit {
  V least = infinity, most_normal = 0.0, most_tangential = 0.0;
  bool is_by_node = false;
};

// Law: L<double>; Wide: L<V>.
template <class Law, class Wide, class Node, class V = typename Node::number>
struct stable_step {
  // Where it depends on H alone and falls with either entry, the largest entries of all nodes decide.
  static constexpr bool by_delassus = requires(const Law& law) { law.stable_velocity_step(1.0, 1.0); };
  static constexpr bool by_node = requires(const Wide& law, const Node& n) { law.stable_velocity_step(n); };

  // Where both forms are given, the one of the node counts where the other gives NaN, and for parameters per
  // node (varying).
  ILAW_KIT_INLINE static void add(step_limit<V>& found, const Wide& law, const Node& n, bool varying,
                                  mask_of<V> good) {
    if constexpr (by_node)
      if (!by_delassus || found.is_by_node) {
        found.least = smaller(select(good, law.stable_velocity_step(n), V(infinity)), found.least);
        return;
      }
    if constexpr (by_delassus) {
      const V normal = n.delassus.normal(), tangential = n.delassus.largest_tangential();
      if (varying) {
        found.least =
            smaller(select(good, law.stable_velocity_step(normal, tangential), V(infinity)), found.least);
      } else {
        found.most_normal = larger(zero_unless(good, normal), found.most_normal);
        found.most_tangential = larger(zero_unless(good, tangential), found.most_tangential);
      }
    }
  }
  static step_limit<V> start(const Law& law, bool varying) {
    step_limit<V> made;
    if constexpr (by_delassus && by_node) {
      const double step = law.stable_velocity_step(1.0, 1.0);
      made.is_by_node = varying || step != step;
    }
    return made;
  }
  static void give(const step_limit<V>& found, const Law& law, tally& all) {
    double least = infinity, normal = 0.0, tangential = 0.0;
    for (int k = 0; k < lanes_of<V>; ++k) {
      least = smaller(lane_of(found.least, k), least);
      normal = larger(lane_of(found.most_normal, k), normal);
      tangential = larger(lane_of(found.most_tangential, k), tangential);
    }
    if constexpr (by_delassus)
      if (normal > 0.0) least = smaller(law.stable_velocity_step(normal, tangential), least);
    all.stable_velocity_step = smaller(least, all.stable_velocity_step);
  }
};

// Heat and wear of a step. friction is what it dissipated, so that friction/|r_T| is the mean speed of slip
// where friction alone gives r_T (is_free: of bonds). Apart from the loop, which rarely needs it. first: the
// place of heat among the amounts.
template <class V, class Vector, class Number>
ILAW_KIT_APART void store_heat(const view<Number>& b, std::int64_t i, int first, V friction, Vector impulse,
                               Vector twice_mean, V partition, V coefficient, mask_of<V> is_free) {
  const V rubs = impulse.tangential_length(), rest = 1.0 - partition;
  const V speed = select(is_free & (rubs > 0.0), friction / rubs, 0.5 * twice_mean.tangential_length());
  const V area = b.area.at ? load<V>(b.area.at + i) : V(0.0);
  const V depth = coefficient * (impulse.n / area);  // per slip
  const mask_of<V> wears = (depth > 0.0) & (area > 0.0) & (speed > 0.0);
  const V amounts[heat_amount_count] = {zero_unless(partition > 0.0, partition * friction),
                                        zero_unless(rest > 0.0, rest * friction),
                                        zero_unless(wears, depth * speed)};
  for (int k = 0; k < heat_amount_count; ++k)
    if (b.amounts[first + k]) detail::store(amounts[k], b.amounts[first + k] + i);
}

}  // namespace ilaw::kit::detail
