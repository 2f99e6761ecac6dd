// state.hpp - how a law describes what a node remembers: one entry per member of its struct state, which
// says where the number stands and, by the member's type, what it is. Order and size cannot differ.
//   struct state { double damage; vector opening; tangential_vector slip; };
//   static constexpr state_variable<state> state_variables[] = {
//       {.member = &state::damage, .name = "damage", .maximum = 1.0, ...}, ...};
// A host finds the variables in the order of their entries, whatever that of the struct is.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit/node.hpp>

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <type_traits>

namespace ilaw::kit::inline ILAW_KIT_LEVEL {

// A vector without normal component, to be remembered: a host keeps d-1 doubles of it.
struct tangential_vector {
  double t1 = 0.0, t2 = 0.0;

  constexpr operator vector() const { return {0.0, t1, t2}; }
};

// The member of a struct state that a variable describes: all of it, or one component of a vector, which then
// has entries for all three.
template <class State>
class state_member {
 public:
  constexpr state_member() = default;
  constexpr state_member(double State::*member) : scalar_(member) {}
  constexpr state_member(vector State::*member) : vector_(member), kind_(ILAW_STATE_VECTOR) {}
  constexpr state_member(vector State::*member, double vector::*component)
      : vector_(member),
        component_(component),
        kind_(component == &vector::n ? ILAW_STATE_SCALAR : ILAW_STATE_HISTORY) {}
  constexpr state_member(tangential_vector State::*member)
      : tangential_(member), kind_(ILAW_STATE_TANGENTIAL) {}
  template <class Other>
  constexpr state_member(Other State::*) {
    static_assert(std::is_same_v<Other, double>,
                  "a member of struct state is a double, a vector or a tangential_vector");
  }

  constexpr bool is_given() const { return scalar_ || vector_ || tangential_; }
  constexpr std::uint32_t kind() const { return kind_; }
  constexpr int doubles() const {  // in struct state
    return kind_ == ILAW_STATE_VECTOR ? 3 : (kind_ == ILAW_STATE_TANGENTIAL ? 2 : 1);
  }
  constexpr int components(int dimension) const {  // in the host's state
    if (kind_ == ILAW_STATE_TANGENTIAL) return dimension - 1;
    return kind_ == ILAW_STATE_VECTOR ? dimension : 1;
  }

  // Which double of struct state is its first one: the one that changes with it.
  constexpr int place() const {
    const auto before = marked(1.0), after = marked(2.0);
    int k = 0;
    while (before[k] == after[k]) ++k;
    return k;
  }

 private:
  constexpr auto marked(double value) const {
    State s{};
    if (scalar_) s.*scalar_ = value;
    if (vector_) (s.*vector_).*(component_ ? component_ : &vector::n) = value;
    if (tangential_) (s.*tangential_).t1 = value;
    return std::bit_cast<std::array<double, sizeof(State) / sizeof(double)>>(s);
  }

  double State::*scalar_ = nullptr;
  vector State::*vector_ = nullptr;
  double vector::*component_ = nullptr;
  tangential_vector State::*tangential_ = nullptr;
  std::uint32_t kind_ = ILAW_STATE_SCALAR;
};

template <class State>
struct state_variable {
  state_member<State> member;
  const char* name;
  const char* unit = "1";
  const char* doc = "";
  bool internal = false;  // bookkeeping, not for pictures
  // What a scalar can be; a host's state with anything else is bad input. All are finite.
  double minimum = -std::numeric_limits<double>::max();
  double maximum = std::numeric_limits<double>::max();
  bool whole = false;

  constexpr bool has_range() const {
    return whole || minimum > -std::numeric_limits<double>::max() ||
           maximum < std::numeric_limits<double>::max();
  }
  // Of a value that is finite.
  bool may_be(double value) const {
    if (whole && minimum == 0.0 && maximum == 1.0) return value * value == value;
    if (!whole && maximum == std::numeric_limits<double>::max()) return value >= minimum;
    const bool inside = (value >= minimum) & (value <= maximum);
    return whole ? inside & is_whole(value) : inside;
  }
};

// The history of a law, any number of doubles; see window.hpp for one.
struct history_card {
  const char* name;
  const char* unit = "1";
  const char* doc = "";
  bool internal = false;
};

}  // namespace ilaw::kit
