// node_state.hpp - the state of a node: where the host has its numbers, and what they may be.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit/declare.hpp>
#include <ilaw/kit/detail/frame.hpp>

#include <bit>

namespace ilaw::kit::inline ILAW_KIT_LEVEL::detail {

// Entry of the host's state that holds double k of struct state; -1: a component beyond the dimension.
template <class Law>
constexpr int state_entry(int k, int dimension) {
  int entry = 0;
  if constexpr (has_state<Law>)
    for (std::size_t v = 0; v < std::size(Law::state_variables); ++v) {
      const auto& member = Law::state_variables[v].member;
      const int component = k - state_places<Law>[v];
      if (component >= 0 && component < member.doubles())
        return component < member.components(dimension) ? entry + component : -1;
      entry += member.components(dimension);
    }
  return -1;
}

template <class Law>
constexpr int state_entries(int dimension) {
  int count = 0;
  for (int k = 0; k < state_doubles<Law>; ++k) count += state_entry<Law>(k, dimension) >= 0 ? 1 : 0;
  return count;
}

// Double K of the state of node i: in a column of its own or, in space, in a row of all that the host stores.
template <class Law>
inline constexpr int row_of_state = state_entries<Law>(3);
template <class Law, class Layout, int K>
double state_number(const double* const* state, int i) {
  if constexpr (!has_state_rows<Layout>)
    return state[K][i];
  else if constexpr (constexpr int entry = state_entry<Law>(K, 3); entry >= 0)
    return state[0][row_of_state<Law> * i + entry];
  else
    return 0.0;
}
template <class Law, class Layout, int K>
void put_state_number(double* const* state, int i, double value) {
  if constexpr (!has_state_rows<Layout>)
    state[K][i] = value;
  else if constexpr (constexpr int entry = state_entry<Law>(K, 3); entry >= 0)
    state[0][row_of_state<Law> * i + entry] = value;
}
template <class Law, class Layout, std::size_t... K>
state_t<Law> state_at(const double* const* state, int i, std::index_sequence<K...>) {
  return std::bit_cast<state_t<Law>>(
      std::array<double, sizeof...(K)>{state_number<Law, Layout, static_cast<int>(K)>(state, i)...});
}

// Of a state that comes in: finite, and every scalar what its variable may be.
template <class Law, std::size_t V = 0>
double range_defect(const std::array<double, state_doubles<Law>>& state) {
  if constexpr (V < std::size(Law::state_variables)) {
    constexpr const auto& v = Law::state_variables[V];
    const double rest = range_defect<Law, V + 1>(state);
    if constexpr (v.has_range()) return rest + defect_unless(v.may_be(state[state_places<Law>[V]]));
    return rest;
  }
  return 0.0;
}
template <class Law>
double state_defect(const state_t<Law>& state) {
  double sum = 0.0;
  if constexpr (has_state<Law>)
    for (double s : std::bit_cast<std::array<double, state_doubles<Law>>>(state)) sum = defect(s, sum);
  return sum;
}
template <class Law>
double incoming_state_defect(const state_t<Law>& state) {
  if constexpr (has_state<Law>)
    return state_defect<Law>(state) +
           range_defect<Law>(std::bit_cast<std::array<double, state_doubles<Law>>>(state));
  return 0.0;
}

template <class Law>
bool same_bits(const state_t<Law>& a, const state_t<Law>& b) {
  std::uint64_t different = 0;
  if constexpr (has_state<Law>) {
    const auto x = std::bit_cast<std::array<std::uint64_t, state_doubles<Law>>>(a);
    const auto y = std::bit_cast<std::array<std::uint64_t, state_doubles<Law>>>(b);
    for (std::size_t k = 0; k < x.size(); ++k) different |= x[k] ^ y[k];
  }
  return different == 0;
}

// Number by number: a choice between structs is a branch, which does not vectorise.
template <class Law, class Layout, std::size_t... K>
void store_state(double* const* state, int i, const state_t<Law>& after, const state_t<Law>& before,
                 bool accepted, std::index_sequence<K...> /*doubles*/) {
  const auto next = std::bit_cast<std::array<double, sizeof...(K)>>(after);
  const auto last = std::bit_cast<std::array<double, sizeof...(K)>>(before);
  (put_state_number<Law, Layout, static_cast<int>(K)>(state, i, accepted ? next[K] : last[K]), ...);
}

}  // namespace ilaw::kit::detail
