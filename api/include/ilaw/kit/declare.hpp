// declare.hpp - how a law declares itself, and the ABI description made from it at compile time.
//
// A law is a struct whose members are its parameters (all double; a choice holds its index), with
//   static constexpr law_card card;                       who it is, what it serves
//   static constexpr parameter<Law> parameters[];         one per member
//   template <class Node> void step(Node&) const;         its equations
// and, where it needs them,
//   struct state { ... };                                 named memory, and
//   static constexpr state_variable<state> state_variables[];   its description, see state.hpp
//   std::uint32_t inputs() const;                         what these parameters read (default: card.inputs)
//   static constexpr std::uint32_t always_reads;          what inputs() has for all parameters (default:
//                                                         none): loops without it are not compiled
//   std::uint32_t capabilities() const;                   what these parameters can do (default: the card's)
//   static constexpr bool rests_by_parameters = true;     capabilities() promises can_rest, and nobody
//                                                         does where parameters vary
//   static constexpr bool skips_out_of_reach = true;      the step frees such nodes (see node.hpp) without an
//                                                         impulse and refuses none: where all are so, the kit
//                                                         does it
//   static bool rests(const state&);                      the same of nodes with such a state
//   template <class Node> bool try_step(Node&) const      the usual case; true: the same as step, bit for bit
//   template <class Node> double stable_velocity_step(const Node&) const   if it limits the step: by how much
//                                                         at this node, whatever its state; see ilaw_report
//   template <class Run> void in_form(Run) const;         a shorter step for these parameters, see below
//   const char* conflict() const;                         why parameters do not go together, or null
//   static const void* extension(const char* name);       see ilaw_law (default: ilaw/ext/draft/profile.h
//   alone) template <class Node> void initialise(Node&) const;   first state (default: zeros) static
//   constexpr history_card history_variable;       declares a history, of std::int64_t history_size() const;
//   doubles, which step reads as node.history and template <class Node> void record(const Node&, history)
//   const   writes once the step is accepted
// A history that is a window is read and written for the law, which then runs in vector code (window.hpp):
//   window_in_step window_in(step_interval) const;        gives node.earlier
//   static bool adds_to_window(double status);            whether a step that gave this status is taken in,
//   static bool clears_window(double status);             and whether the window is emptied before that
//
// Forms. Where parameters turn parts of the step off, loops without those parts vectorise. A form is a struct
// declared in the law and, once the law is complete, derived from it; its step gives the same bits as the
// law's. in_form calls run once, with the form that the parameters ask for or with the law itself:
//   struct plain;                                         in the law, as is the declaration of in_form
//   struct law::plain : law {                             behind the law
//     static constexpr bool forgets = true;               where the law has a history: this step needs none
//     static constexpr bool is_always_stable = true;      limits no step, so that none is worked out
//     template <class Node> double step_falls_with(const Node&) const    the one number that the stable step
//     double stable_step_at(double) const                                falls with, and the step at it
//     static constexpr bool needs_previous = true;        inputs() then always has v_previous
//     template <class Node> void step(Node&) const;
//   };
//   template <class Run> void law::in_form(Run run) const {
//     if (friction == 0.0) run(plain{*this}); else run(*this);
//   }
// The kit asks for a form once per block of nodes that share their parameters. Where these vary from node to
// node it takes the law's own step, which serves all of them: in a law that is nothing but forms by calling
// in_form itself, as penalty does. A law may name one form for blocks of such nodes all of which have it:
//   using form_of_nodes = plain;
//   bool has_form_of_nodes() const;
// and one, or itself where it has no forms, whose loops are compiled for arrays of float as well (float.h):
//   using form_of_floats = plain;
// They are as fast as their bytes allow; other forms copy such arrays block by block.
// A form may name another with a shorter try_step, of which nothing else is compiled:
//   using form_of_try = shorter;
//   bool has_form_of_try() const;
//
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit/node.hpp>
#include <ilaw/kit/state.hpp>

#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <limits>
#include <type_traits>
#include <utility>

namespace ilaw::kit::inline ILAW_KIT_LEVEL {

// In capabilities of a card, besides those of the ABI; they become permissions.
inline constexpr std::uint32_t acts_at_distance = 1U << 30;  // evaluated out of reach, too, when fresh
inline constexpr std::uint32_t can_rest = 1U << 31;          // a free node out of reach stays as it is

struct law_card {
  const char* id;
  const char* title;
  const char* doc;
  std::uint32_t dimensions = ILAW_DIMENSION_1 | ILAW_DIMENSION_2 | ILAW_DIMENSION_3;
  std::uint32_t delassus_forms =
      ILAW_DELASSUS_SCALAR | ILAW_DELASSUS_DIAGONAL | ILAW_DELASSUS_FULL | ILAW_DELASSUS_TRANSVERSE;
  std::uint32_t inputs = reads_gap;
  std::uint32_t capabilities = 0;
  std::uint32_t state_version = 1;  // to be raised with every change of what a state means
  // Whether step names t1 or t2. One that does not works on projected_vector too, which spares the host's
  // axes a tangent per node.
  bool names_tangents = true;
};

template <class Law>
struct parameter {
  double Law::*member;
  const char* name;
  const char* symbol = "";
  const char* unit = "1";
  const char* doc = "";
  double default_value = 0.0;
  double minimum = 0.0;
  double maximum = std::numeric_limits<double>::max();
  bool required = false;
  bool minimum_excluded = false;
  bool infinity_allowed = false;
  bool whole = false;
  bool fixed = false;  // no table and no value per node: the layout of the state depends on it
  const char* const* choices = nullptr;
  std::uint32_t choice_count = 0;

  // Copies that differ in one thing, for the parameters of common_parameters.hpp.
  constexpr parameter with_doc(const char* text) const {
    parameter copy = *this;
    copy.doc = text;
    return copy;
  }
  constexpr parameter with_default(double value) const {
    parameter copy = *this;
    copy.default_value = value;
    return copy;
  }
  constexpr parameter as_required() const {
    parameter copy = *this;
    copy.required = true;
    return copy;
  }
};

template <class Law>
concept has_state = requires {
  typename Law::state;
};
template <class Law>
concept has_history = requires {
  Law::history_variable;
};

// Whether a law remembers directions, which turn with the frame.
template <class Law>
constexpr bool has_vector_state() {
  if constexpr (has_state<Law>)
    for (const auto& v : Law::state_variables)
      if (v.member.kind() != ILAW_STATE_SCALAR) return true;
  return false;
}

namespace detail {

template <class Law>
struct state_of {
  using type = stateless;
};
template <has_state Law>
struct state_of<Law> {
  using type = typename Law::state;
};

}  // namespace detail

template <class Law>
using state_t = typename detail::state_of<Law>::type;

// A node as most laws see it.
template <class Law>
using plain_node = node<transverse_delassus, state_t<Law>, vector, Law::card.inputs>;

// Whether a law gives a first state that is not zero.
template <class Law>
concept initialises = requires(const Law& law, initial_node<state_t<Law>, Law::card.inputs>& n) {
  law.initialise(n);
};

// Whether a law says which steps it is stable at.
template <class Law>
concept limits_step = requires(const Law& law, const plain_node<Law>& n) {
  law.stable_velocity_step(n);
};

// Doubles in struct state, vectors counted as three, tangential ones as two.
template <class Law>
inline constexpr int state_doubles = has_state<Law> ? static_cast<int>(sizeof(state_t<Law>) / sizeof(double))
                                                    : 0;

namespace detail {

template <class Law>
inline constexpr std::size_t parameter_count = std::size(Law::parameters);

template <class T, std::size_t N>
constexpr std::array<const T*, N> pointers_to(const std::array<T, N>& elements) {
  std::array<const T*, N> pointers{};
  for (std::size_t i = 0; i < N; ++i) pointers[i] = &elements[i];
  return pointers;
}

inline constexpr const char* time_axis[] = {"time"};

template <class Law>
constexpr ilaw_parameter abi_parameter(const parameter<Law>& p) {
  const std::uint32_t kind = p.choice_count > 0 ? ILAW_PARAMETER_CHOICE
                             : p.whole          ? ILAW_PARAMETER_COUNT
                                                : ILAW_PARAMETER_NUMBER;
  const bool varies = kind == ILAW_PARAMETER_NUMBER && !p.fixed;
  return {.struct_size = sizeof(ilaw_parameter),
          .kind = kind,
          .name = p.name,
          .symbol = p.symbol,
          .unit = p.unit,
          .doc = p.doc,
          .minimum = p.choice_count > 0 ? 0.0 : p.minimum,
          .maximum = p.choice_count > 0 ? p.choice_count - 1.0 : p.maximum,
          .default_value = p.default_value,
          .flags = (p.required ? std::uint32_t{ILAW_PARAMETER_IS_REQUIRED} : 0U) |
                   (p.minimum_excluded ? std::uint32_t{ILAW_PARAMETER_EXCLUDES_MINIMUM} : 0U) |
                   (p.infinity_allowed ? std::uint32_t{ILAW_PARAMETER_ALLOWS_INFINITY} : 0U) |
                   (varies ? std::uint32_t{ILAW_PARAMETER_ALLOWS_PER_NODE} : 0U),
          .choice_count = p.choice_count,
          .choices = p.choices,
          .axes = varies ? time_axis : nullptr,
          .axis_count = varies ? 1U : 0U,
          .reserved = 0};
}

template <class Law>
constexpr auto abi_parameters() {
  std::array<ilaw_parameter, parameter_count<Law>> result{};
  for (std::size_t i = 0; i < result.size(); ++i) result[i] = abi_parameter<Law>(Law::parameters[i]);
  return result;
}

// Text: a state_variable or a history_card.
template <class Text>
constexpr ilaw_state_variable abi_state_variable(const Text& v, std::uint32_t kind, std::uint64_t count) {
  return {.struct_size = sizeof(ilaw_state_variable),
          .kind = kind,
          .name = v.name,
          .unit = v.unit,
          .doc = v.doc,
          .count = count,
          .flags = v.internal ? std::uint32_t{ILAW_VARIABLE_INTERNAL} : 0U,
          .reserved = 0};
}

template <class Law>
constexpr std::size_t declared_state_variables() {
  if constexpr (has_state<Law>) return std::size(Law::state_variables);
  return 0;
}

// Where the variables stand in struct state.
template <class Law>
inline constexpr auto state_places = [] {
  std::array<int, declared_state_variables<Law>() + 1> places{};  // one more: no array of length zero
  if constexpr (has_state<Law>)
    for (std::size_t v = 0; v < std::size(Law::state_variables); ++v)
      places[v] = Law::state_variables[v].member.place();
  return places;
}();

template <class Law>
inline constexpr std::size_t state_variable_count = declared_state_variables<Law>() +
                                                    (has_history<Law> ? 1 : 0);

template <class Law>
constexpr auto abi_state_variables(int dimension, std::uint64_t history_size) {
  std::array<ilaw_state_variable, state_variable_count<Law>> result{};
  std::size_t i = 0;
  if constexpr (has_state<Law>)
    for (const auto& v : Law::state_variables)
      result[i++] =
          abi_state_variable(v, v.member.kind(), static_cast<std::uint64_t>(v.member.components(dimension)));
  if constexpr (has_history<Law>)
    result[i] = abi_state_variable(Law::history_variable, ILAW_STATE_HISTORY, history_size);
  return result;
}

constexpr ilaw_capabilities abi_capabilities(std::uint32_t of_card) {
  return of_card & ~(acts_at_distance | can_rest);
}
constexpr ilaw_permissions abi_permissions(std::uint32_t of_card) {
  return (of_card & acts_at_distance ? 0U : std::uint32_t{ILAW_MAY_SKIP_FRESH}) |
         (of_card & can_rest ? std::uint32_t{ILAW_MAY_SKIP_FREE} : 0U);
}
// Permissions with any parameters and in any frame.
template <class Law>
constexpr ilaw_permissions least_permissions() {
  std::uint32_t mask = Law::card.capabilities;
  if constexpr (requires { Law::rests_by_parameters; }) mask &= ~can_rest;
  if (has_history<Law> && !(mask & can_rest)) mask |= acts_at_distance;
  return abi_permissions(mask);
}

// The ABI description of a law, all of it constant.
template <class Law>
struct description {
  static constexpr auto parameters = abi_parameters<Law>();
  static constexpr auto parameter_pointers = pointers_to(parameters);
  static constexpr auto state_variables = abi_state_variables<Law>(3, 0);
  static constexpr auto state_variable_pointers = pointers_to(state_variables);
};

}  // namespace detail
}  // namespace ilaw::kit
