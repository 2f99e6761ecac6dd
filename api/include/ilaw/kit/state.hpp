// state.hpp - how a law describes what a node remembers: one entry per member of its struct state, which says
// where the number stands and, by the member's type, what it is. Order and size cannot differ.
//   struct state { V damage; vector<V> opening; tangential_vector<V> slip; };
//   static constexpr state_variable<state> state_variables[] = {
//       {.member = &state::damage, .name = "damage", .maximum = 1.0, ...}, ...};
// A host finds the variables in the order of their entries, whatever that of the struct is.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit/law.hpp>
#include <ilaw/kit/vector.hpp>

#include <array>

namespace ilaw::kit::inline ILAW_KIT_LEVEL {

// The member of a struct state that a variable describes: all of it, or one component of a vector, which then
// has entries for all three.
template <class State>
class state_member {
 public:
  constexpr state_member() = default;
  constexpr state_member(double State::*member) : scalar_(member) {}
  constexpr state_member(vector<double> State::*member) : vector_(member), kind_(ILAW_KIND_VECTOR) {}
  constexpr state_member(vector<double> State::*member, double vector<double>::*component)
      : vector_(member),
        component_(component),
        kind_(component == &vector<double>::n ? ILAW_KIND_SCALAR : ILAW_KIND_HISTORY) {}
  constexpr state_member(tangential_vector<double> State::*member)
      : tangential_(member), kind_(ILAW_KIND_TANGENTIAL) {}
  template <class Other>
  constexpr state_member(Other State::*) {
    static_assert(std::is_same_v<Other, double>,
                  "a member of struct state is a V, a vector<V> or a tangential_vector<V>");
  }

  constexpr bool is_given() const { return scalar_ || vector_ || tangential_; }
  constexpr std::uint32_t kind() const { return kind_; }
  constexpr int numbers() const {  // in struct state
    return kind_ == ILAW_KIND_VECTOR ? 3 : (kind_ == ILAW_KIND_TANGENTIAL ? 2 : 1);
  }
  constexpr int components(int dimension) const {  // in the host's state
    if (kind_ == ILAW_KIND_TANGENTIAL) return dimension - 1;
    return kind_ == ILAW_KIND_VECTOR ? dimension : 1;
  }

  // Which number of struct state is its first one: the one that changes with it.
  constexpr int place() const {
    const auto before = marked(1.0), after = marked(2.0);
    int k = 0;
    while (before[static_cast<std::size_t>(k)] == after[static_cast<std::size_t>(k)]) ++k;
    return k;
  }

 private:
  constexpr auto marked(double value) const {
    State s{};
    if (scalar_) s.*scalar_ = value;
    if (vector_) (s.*vector_).*(component_ ? component_ : &vector<double>::n) = value;
    if (tangential_) (s.*tangential_).t1 = value;
    return std::bit_cast<std::array<double, sizeof(State) / sizeof(double)>>(s);
  }

  double State::*scalar_ = nullptr;
  vector<double> State::*vector_ = nullptr;
  double vector<double>::*component_ = nullptr;
  tangential_vector<double> State::*tangential_ = nullptr;
  std::uint32_t kind_ = ILAW_KIND_SCALAR;
};

template <class State>
struct state_variable {
  state_member<State> member;
  const char* name;
  const char* unit = "1";
  const char* doc = "";
  bool internal = false;  // bookkeeping, not for pictures
  // Allowed values of a scalar; a host's state with anything else is bad input. All are finite.
  double minimum = -std::numeric_limits<double>::max();
  double maximum = std::numeric_limits<double>::max();
  bool whole = false;

  constexpr bool has_range() const {
    return whole || minimum > -std::numeric_limits<double>::max() ||
           maximum < std::numeric_limits<double>::max();
  }
  // Expects finite values.
  template <class V>
  ILAW_KIT_INLINE mask_of<V> may_be(V value) const {
    if (whole && minimum == 0.0 && maximum == 1.0) return value * value == value;
    if (!whole && maximum == std::numeric_limits<double>::max()) return value >= minimum;
    const auto inside = (value >= minimum) & (value <= maximum);
    return whole ? inside & is_whole(value) : inside;
  }
};

// What a law's window is called in the host's state.
struct history_card {
  const char* name;
  const char* unit = "1";
  const char* doc = "";
  bool internal = false;
};

// Whether a law remembers directions, which turn with the frame.
template <class Law>
constexpr bool has_vector_state() {
  if constexpr (has_state<Law>)
    for (const auto& v : Law::state_variables)
      if (v.member.kind() != ILAW_KIND_SCALAR) return true;
  return false;
}

namespace detail {

// Where the variables of L<double> stand in struct state.
template <class Law>
inline constexpr auto state_places = [] {
  if constexpr (has_state<Law>) {
    std::array<int, std::size(Law::state_variables)> places{};
    for (std::size_t v = 0; v < places.size(); ++v) places[v] = Law::state_variables[v].member.place();
    return places;
  } else {
    return std::array<int, 1>{};
  }
}();

// Entry of the host's state that holds number k of struct state; -1: a component beyond the dimension.
template <class Law>
constexpr int state_entry(int k, int dimension) {
  int entry = 0;
  if constexpr (has_state<Law>)
    for (std::size_t v = 0; v < std::size(Law::state_variables); ++v) {
      const auto& member = Law::state_variables[v].member;
      const int component = k - state_places<Law>[v];
      if (component >= 0 && component < member.numbers())
        return component < member.components(dimension) ? entry + component : -1;
      entry += member.components(dimension);
    }
  return -1;
}

// The entries of the host's state in which the numbers of a state stand, of each dimension; see batch_walk.
// In the order of the entries in space.
template <class Law>
inline constexpr auto state_entries = [] {
  std::array<std::array<int, static_cast<std::size_t>(state_numbers<Law>) + 1>, 4> all{};
  for (int d = 1; d <= 3; ++d)
    for (int k = 0; k < state_numbers<Law>; ++k)
      all[static_cast<std::size_t>(d)][static_cast<std::size_t>(state_entry<Law>(k, 3))] =
          state_entry<Law>(k, d);
  return all;
}();

// ---- the state of a node as an array of numbers, in the order of the struct or of the host

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

}  // namespace detail
}  // namespace ilaw::kit
