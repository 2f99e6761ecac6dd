// node_state.hpp - the state of a node as an array of numbers, in the order of the struct or of the host.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit/state.hpp>

namespace ilaw::kit::inline ILAW_KIT_LEVEL::detail {

template <class V, class State>
ILAW_KIT_INLINE V& number_in(State& state, int k) {
  return reinterpret_cast<V*>(&state)[k];
}
template <class V, class State>
ILAW_KIT_INLINE const V& number_in(const State& state, int k) {
  return reinterpret_cast<const V*>(&state)[k];
}

// Between the struct and the host's entries in space; the walk brings states of fewer dimensions to the same
// order, with zeros.
template <class Law, class State, class V, int Count, std::size_t... K>
ILAW_KIT_INLINE void to_struct(State& state, const V (&entries)[Count], std::index_sequence<K...>) {
  ((number_in<V>(state, static_cast<int>(K)) = entries[state_entry<Law>(static_cast<int>(K), 3)]), ...);
}
template <class Law, class State, class V, int Count, std::size_t... K>
ILAW_KIT_INLINE void from_struct(V (&entries)[Count], const State& state, std::index_sequence<K...>) {
  ((entries[state_entry<Law>(static_cast<int>(K), 3)] = number_in<V>(state, static_cast<int>(K))), ...);
}

}  // namespace ilaw::kit::detail
