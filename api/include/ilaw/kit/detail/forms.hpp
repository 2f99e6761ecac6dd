// forms.hpp - which loops a law needs: for which frames and forms of H, and whether with the solver.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

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

// Free histories are read and written node by node.
template <class Law>
inline constexpr bool has_free_history = has_history<Law> && !has_window<Law>;

}  // namespace ilaw::kit::detail
