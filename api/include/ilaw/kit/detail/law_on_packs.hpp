// law_on_packs.hpp - a law whose members are packs: which nodes it serves, and its parameters, the same in
// all lanes or by node.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit/detail/view.hpp>
#include <ilaw/kit/state.hpp>

namespace ilaw::kit::inline ILAW_KIT_LEVEL::detail {

// Whether kernels may work from the normal alone: no tangent named, and no vector remembered, which would
// need tangents to be written in.
template <class Law>
inline constexpr bool needs_no_tangents =
    Law::card.is_isotropic && !has_history<Law> && !has_vector_state<Law>();

template <class Law>
inline constexpr bool serves_transverse = (Law::card.delassus_forms &
                                           (ILAW_DELASSUS_SCALAR | ILAW_DELASSUS_TRANSVERSE)) != 0;
template <class Law>
inline constexpr bool serves_spins = (Law::card.delassus_forms & with_spins) != 0;
template <class Law>
inline constexpr bool serves_full = (Law::card.delassus_forms &
                                     (ILAW_DELASSUS_DIAGONAL | ILAW_DELASSUS_FULL)) != 0;

template <class Law, class Node>
concept can_ask = requires(const Law& law, Node& n, typename Law::problem& p) {
  law.ask(n, p);
};

template <class Law, class Node>
concept can_choose = requires(const Law& law, Node& n) {
  law.step(n);
}
&&(
    requires(const Law& law) { law.asks(); } || requires(const Law& law) { law.asks(true); });

template <class Law, class V>
struct law_on;
template <template <class> class L, class Old, class V>
struct law_on<L<Old>, V> {
  using type = L<V>;
};
template <class Law, class V>
using law_on_t = typename law_on<Law, V>::type;

// The law with the same values in all lanes.
template <class V, class Law, std::size_t... K>
ILAW_KIT_INLINE law_on_t<Law, V> broadcast(const Law& law, std::index_sequence<K...>) {
  using Wide = law_on_t<Law, V>;
  Wide wide;
  (Wide::parameters[K].member.copy(wide, Law::parameters[K].member, law), ...);
  return wide;
}
template <class V, class Law>
ILAW_KIT_INLINE law_on_t<Law, V> broadcast(const Law& law) {
  if constexpr (std::is_same_v<V, double>)
    return law;
  else
    return broadcast<V>(law, std::make_index_sequence<static_cast<std::size_t>(parameter_count<Law>)>{});
}

// Tables over fields, lane by lane.
template <class Wide, class Number>
[[gnu::noinline]] void look_up(Wide& own, const view<Number>& b) {
  using V = typename number_of_law<Wide>::type;
  for (int k = 0; k < parameter_count<Wide>; ++k) {
    const table& t = b.tables[k];
    if (!t.per_node || !Wide::parameters[k].member.may_vary()) continue;
    double found[lanes_of<V>];
    for (int lane = 0; lane < lanes_of<V>; ++lane) {
      double place[3] = {};
      for (int a = 0; a < t.axis_count; ++a)
        place[a] = t.source[a] == table::time
                       ? b.step.time
                       : lane_of(Wide::parameters[t.source[a]].member.varying_in(own), lane);
      found[lane] = t.at(place);
    }
    __builtin_memcpy(static_cast<void*>(&Wide::parameters[k].member.varying_in(own)), found, sizeof found);
  }
}

// The parameters of the nodes of a pack. Where one is out of range or several do not go together, the law
// stays as it was, so that no step need stand it; returns which nodes are good.
template <class Wide, class Law, class Number>
[[gnu::noinline]] auto take_parameters(Wide& own, const Law& law, const view<Number>& b, std::int64_t i) {
  using V = typename number_of_law<Wide>::type;
  mask_of<V> good = all<V>();
  for (int k = 0; k < parameter_count<Law>; ++k)
    if (Wide::parameters[k].member.may_vary() && b.parameters[k]) {
      const V given = load<V>(b.parameters[k] + i);
      good = good & Wide::parameters[k].range().has(given);
      Wide::parameters[k].member.varying_in(own) = given;
    }
  if (b.tables) look_up(own, b);
  int varying[parameter_count<Law>], count = 0;
  for (int k = 0; k < parameter_count<Law>; ++k)
    if (Wide::parameters[k].member.may_vary() && b.varies(k)) varying[count++] = k;
  if constexpr (requires { law.conflict(); }) {
    unsigned fit = 0;
    Law here = law;
    for (int lane = 0; lane < lanes_of<V>; ++lane) {
      for (int j = 0; j < count; ++j)
        Law::parameters[varying[j]].member.set(
            here, lane_of(Wide::parameters[varying[j]].member.varying_in(own), lane));
      fit |= here.conflict() ? 0U : 1U << lane;
    }
    good = good & mask_from<V>(fit);
  }
  if (any(!good))
    for (int j = 0; j < count; ++j) {
      V& value = Wide::parameters[varying[j]].member.varying_in(own);
      value = select(good, value, V(Law::parameters[varying[j]].member.get(law)));
    }
  return good;
}

}  // namespace ilaw::kit::detail
