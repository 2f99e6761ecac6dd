// checked.hpp - what a law must have to be one, each with the line that says what to write. A law that fails
// here is compiled no further, so that nothing of the kit's insides stands in the compiler's answer.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit/declare.hpp>
#include <ilaw/kit/window.hpp>

namespace ilaw::kit::inline ILAW_KIT_LEVEL::detail {

// Whether a law has a member of a name, whatever it is: two of a name are ambiguous.
#define ILAW_KIT_NAME(name)                        \
  struct other_##name {                            \
    int name;                                      \
  };                                               \
  template <class Law>                             \
  struct with_##name : Law, other_##name {};       \
  template <class Law>                             \
  inline constexpr bool names_##name = !requires { \
    &with_##name<Law>::name;                       \
  }

ILAW_KIT_NAME(card);
ILAW_KIT_NAME(references);
ILAW_KIT_NAME(parameters);
ILAW_KIT_NAME(state);
ILAW_KIT_NAME(state_variables);
ILAW_KIT_NAME(history_variable);
ILAW_KIT_NAME(history_size);
ILAW_KIT_NAME(record);
ILAW_KIT_NAME(step);
ILAW_KIT_NAME(asks);
ILAW_KIT_NAME(answered);
ILAW_KIT_NAME(initialise);
ILAW_KIT_NAME(inputs);
ILAW_KIT_NAME(capabilities);
ILAW_KIT_NAME(conflict);
ILAW_KIT_NAME(in_form);
ILAW_KIT_NAME(stable_velocity_step);
// Names that are written for one of these.
ILAW_KIT_NAME(initialize);
ILAW_KIT_NAME(init);
ILAW_KIT_NAME(input);
ILAW_KIT_NAME(capabilites);
ILAW_KIT_NAME(capability);
ILAW_KIT_NAME(conflicts);
ILAW_KIT_NAME(in_forms);
ILAW_KIT_NAME(records);
ILAW_KIT_NAME(stable_step);
ILAW_KIT_NAME(reference);
ILAW_KIT_NAME(variables);
ILAW_KIT_NAME(history);
ILAW_KIT_NAME(extensions);
#undef ILAW_KIT_NAME

struct any_run {
  template <class Form>
  void operator()(const Form&) const {}
};

template <class Law>
constexpr bool has_card() {
  if constexpr (requires { Law::card; }) return std::is_same_v<decltype(Law::card), const law_card>;
  return false;
}

template <class Law>
constexpr bool members_are_given() {
  for (const auto& p : Law::parameters)
    if (!p.member || !p.name) return false;
  return true;
}
template <class Law>
constexpr bool members_differ() {
  const auto& all = Law::parameters;
  for (std::size_t i = 0; i < std::size(all); ++i)
    for (std::size_t j = 0; j < i; ++j)
      if (all[i].member == all[j].member) return false;
  return true;
}

template <class Law>
constexpr bool state_is_given() {
  if constexpr (has_state<Law>)
    for (const auto& v : Law::state_variables)
      if (!v.member.is_given() || !v.name) return false;
  return true;
}
// Every double of struct state once.
template <class Law>
constexpr bool state_is_covered() {
  if constexpr (has_state<Law>) {
    std::size_t doubles = 0;
    for (const auto& v : Law::state_variables) doubles += static_cast<std::size_t>(v.member.doubles());
    if (doubles * sizeof(double) != sizeof(state_t<Law>)) return false;
  }
  return true;
}
template <class Law>
constexpr bool state_is_apart() {
  if constexpr (has_state<Law>) {
    const auto& all = Law::state_variables;
    for (std::size_t i = 0; i < std::size(all); ++i)
      for (std::size_t j = 0; j < i; ++j)
        if (all[i].member.place() == all[j].member.place()) return false;
  }
  return true;
}

// Functions that a law need not have, but that must be what they are called as. Calls that only name their
// types: no body is compiled for it.
template <class Law>
constexpr bool steps_as_const() {
  using node_type = plain_node<Law>;
  if constexpr (requires(Law & law, node_type & n) { law.step(n); })
    return requires(const Law& law, node_type& n) { law.step(n); };
  return true;
}
// What takes a copy of its node, or one that it may not write, changes nothing.
template <class Law>
constexpr bool steps_its_node() {
  using node_type = plain_node<Law>;
  return !requires(const Law& law, node_type& n) { law.step(static_cast<node_type&&>(n)); };
}
// Of laws in pack form. Where asks is for other nodes than plain ones, it is left to them.
template <class Law>
constexpr bool asks_rightly() {
  using node_type = plain_node<Law>;
  if constexpr (names_asks<Law>) {
    using open_problem = typename Law::template problem<double>;
    if constexpr (requires(Law & law, node_type & n, open_problem & p) { law.asks(n, p); })
      return requires(const Law& law, node_type& n, open_problem& p) {
        { law.asks(n, p) } -> std::same_as<bool>;
      }
    &&!requires(const Law& law, node_type& n, open_problem& p) { law.asks(static_cast<node_type&&>(n), p); };
  }
  return true;
}
template <class Law>
constexpr bool answers_rightly() {
  using node_type = plain_node<Law>;
  if constexpr (names_asks<Law>)
    return requires(const Law& law, node_type& n, const typename Law::template answer<double>& a) {
      law.answered(n, a);
    }
  &&!requires(const Law& law, node_type& n, const typename Law::template answer<double>& a) {
    law.answered(static_cast<node_type&&>(n), a);
  };
  return true;
}
// With parameters per node there is no law that a pack of nodes could ask.
template <class Law>
constexpr bool solves_rightly() {
  if constexpr (names_asks<Law>)
    return requires(const typename Law::template problem<double>& p,
                    typename Law::template answer<double>& a) {
      Law::solve(p, a);
      Law::solve_alone(p, a);
    };
  return true;
}
template <class Law>
inline constexpr bool initialises_rightly = !names_initialise<Law> || initialises<Law>;
template <class Law>
inline constexpr bool has_inputs_rightly = !names_inputs<Law> || requires(const Law& law) {
  { law.inputs() } -> std::same_as<std::uint32_t>;
};
template <class Law>
inline constexpr bool has_capabilities_rightly = !names_capabilities<Law> || requires(const Law& law) {
  { law.capabilities() } -> std::same_as<std::uint32_t>;
};
template <class Law>
inline constexpr bool has_conflict_rightly = !names_conflict<Law> || requires(const Law& law) {
  { law.conflict() } -> std::same_as<const char*>;
};
template <class Law>
inline constexpr bool has_form_rightly = !names_in_form<Law> || requires(const Law& law) {
  law.in_form(any_run{});
};
template <class Law>
inline constexpr bool limits_step_rightly = !names_stable_velocity_step<Law> || limits_step<Law>;
template <class Law>
concept gives_history_size = requires(const Law& law) {
  { law.history_size() } -> std::same_as<std::int64_t>;
};
template <class Law>
inline constexpr bool has_history_rightly =
    names_history_variable<Law> ? gives_history_size<Law> : !names_history_size<Law> && !names_record<Law>;
template <class Law>
concept records_a_node = requires(const Law& law, const plain_node<Law>& n, history own) {
  law.record(n, own);
};
template <class Law>
concept has_window_rightly = has_window<Law> && requires(double status) {
  { Law::adds_to_window(status) } -> std::same_as<bool>;
  { Law::clears_window(status) } -> std::same_as<bool>;
};
template <class Law>
inline constexpr bool records_rightly =
    !names_history_variable<Law> || records_a_node<Law> || has_window_rightly<Law>;

// What needs no description yet: names.
template <class Law>
struct checked_names {
#define ILAW_KIT_CHECK(what, condition, text) \
  static constexpr bool what = (condition);   \
  static_assert(what, text)
#define ILAW_KIT_SPELLING(wrong, right)                       \
  static constexpr bool spells_##wrong = !names_##wrong<Law>; \
  static_assert(spells_##wrong, "the kit calls no '" #wrong "': write '" #right "'")

  ILAW_KIT_CHECK(has_own_card, has_card<Law>(),
                 "a law needs static constexpr law_card card{.id = ..., .title = ..., .doc = ...}");
  ILAW_KIT_CHECK(
      has_references, names_references<Law>,
      "a law needs static constexpr const char* references[] = {...}: where its equations are from");
  ILAW_KIT_CHECK(has_parameters, names_parameters<Law>,
                 "a law needs static constexpr parameter<Law> parameters[] = {{.member = &Law::name, ...}}");
  ILAW_KIT_CHECK(has_step, names_step<Law> || names_asks<Law>,
                 "a law needs template <class Node> void step(Node& node) const");
  ILAW_KIT_CHECK(has_both_of_state, names_state<Law> == names_state_variables<Law>,
                 "a memory is struct state and static constexpr state_variable<state> state_variables[]");
  ILAW_KIT_SPELLING(initialize, initialise);
  ILAW_KIT_SPELLING(init, initialise);
  ILAW_KIT_SPELLING(input, inputs);
  ILAW_KIT_SPELLING(capabilites, capabilities);
  ILAW_KIT_SPELLING(capability, capabilities);
  ILAW_KIT_SPELLING(conflicts, conflict);
  ILAW_KIT_SPELLING(in_forms, in_form);
  ILAW_KIT_SPELLING(records, record);
  ILAW_KIT_SPELLING(stable_step, stable_velocity_step);
  ILAW_KIT_SPELLING(reference, references);
  ILAW_KIT_SPELLING(variables, state_variables);
  ILAW_KIT_SPELLING(history, history_variable);
  ILAW_KIT_SPELLING(extensions, extension);

  static constexpr bool passes = has_own_card && has_references && has_parameters && has_step &&
                                 has_both_of_state && spells_initialize && spells_init && spells_input &&
                                 spells_capabilites && spells_capability && spells_conflicts &&
                                 spells_in_forms && spells_records && spells_stable_step &&
                                 spells_reference && spells_variables && spells_history && spells_extensions;
};

// What its names stand for.
template <class Law>
struct checked_members {
  static constexpr std::uint32_t inputs = reads_gap | reads_v_previous | reads_area;

  ILAW_KIT_CHECK(has_texts, Law::card.id&& Law::card.title&& Law::card.doc,
                 "the card of a law needs .id, .title and .doc");
  ILAW_KIT_CHECK(reads_known_inputs, (Law::card.inputs & ~inputs) == 0,
                 ".inputs of the card are reads_gap, reads_v_previous and reads_area, joined by |");
  ILAW_KIT_CHECK(serves_something, Law::card.dimensions != 0 && Law::card.delassus_forms != 0,
                 "the card of a law serves at least one dimension and one form of H");
  ILAW_KIT_CHECK(serves_turned,
                 !(Law::card.delassus_forms & ILAW_DELASSUS_DIAGONAL) ||
                     (Law::card.delassus_forms & ILAW_DELASSUS_FULL),
                 "a card that serves a diagonal H serves a full one, too: in the host's axes it is full");
  ILAW_KIT_CHECK(gives_members, members_are_given<Law>(),
                 "a parameter needs .member = &Law::name and .name = \"name\"");
  ILAW_KIT_CHECK(has_one_each, members_differ<Law>(),
                 "two parameters have the same .member: each needs one of its own");
  ILAW_KIT_CHECK(describes_all, sizeof(Law) == sizeof(double) * std::size(Law::parameters),
                 "a law's members are its parameters, all double: each needs an entry of parameters[]");
  ILAW_KIT_CHECK(gives_state_members, state_is_given<Law>(),
                 "a state variable needs .member = &state::name and .name = \"name\"");
  ILAW_KIT_CHECK(describes_state, state_is_covered<Law>(),
                 "every member of struct state needs an entry of state_variables[]; members are double, "
                 "vector or tangential_vector");
  ILAW_KIT_CHECK(steps_const, steps_as_const<Law>(),
                 "step must be const: template <class Node> void step(Node& node) const");
  ILAW_KIT_CHECK(steps_node, steps_its_node<Law>(),
                 "step must take its node by reference: template <class Node> void step(Node& node) const");
  ILAW_KIT_CHECK(has_asks, asks_rightly<Law>(),
                 "asks must be template <class Node> bool asks(Node& node, problem<double>& open) const");
  ILAW_KIT_CHECK(
      has_answered, answers_rightly<Law>(),
      "answered must be template <class Node> void answered(Node& node, const answer<double>& a) const");
  ILAW_KIT_CHECK(has_solve, solves_rightly<Law>(),
                 "solve and solve_alone must be static, and their problem carry the parameters: "
                 "they may come per node");
  ILAW_KIT_CHECK(has_initialise, initialises_rightly<Law>,
                 "initialise must be template <class Node> void initialise(Node& node) const");
  ILAW_KIT_CHECK(has_inputs, has_inputs_rightly<Law>, "inputs must be std::uint32_t inputs() const");
  ILAW_KIT_CHECK(has_capabilities, has_capabilities_rightly<Law>,
                 "capabilities must be std::uint32_t capabilities() const");
  ILAW_KIT_CHECK(has_conflict, has_conflict_rightly<Law>, "conflict must be const char* conflict() const");
  ILAW_KIT_CHECK(has_form, has_form_rightly<Law>,
                 "in_form must be template <class Run> void in_form(Run run) const");
  ILAW_KIT_CHECK(has_stable_step, limits_step_rightly<Law>,
                 "stable_velocity_step must be template <class Node> double stable_velocity_step(const Node& "
                 "node) const");
  ILAW_KIT_CHECK(has_history, has_history_rightly<Law>,
                 "a history is static constexpr history_card history_variable, std::int64_t history_size() "
                 "const and record");
  ILAW_KIT_CHECK(
      has_record, records_rightly<Law>,
      "record must be template <class Node> void record(const Node& node, history own) const; a window "
      "has static bool adds_to_window(double status) and clears_window(double status) in its place");

  static constexpr bool passes = has_texts && reads_known_inputs && serves_something && serves_turned &&
                                 gives_members && has_one_each && describes_all && gives_state_members &&
                                 describes_state && steps_const && steps_node && has_asks && has_answered &&
                                 has_solve && has_initialise && has_inputs && has_capabilities &&
                                 has_conflict && has_form && has_stable_step && has_history && has_record;
};

template <class Law>
struct checked_places {
  ILAW_KIT_CHECK(passes, state_is_apart<Law>(),
                 "two state variables have the same .member: each needs one of its own");
#undef ILAW_KIT_CHECK
#undef ILAW_KIT_SPELLING
};

// Whether a struct is a law; an error, of one line, where it is not.
template <class Law>
constexpr bool checked() {
  if constexpr (checked_names<Law>::passes)
    if constexpr (checked_members<Law>::passes) return checked_places<Law>::passes;
  return false;
}

}  // namespace ilaw::kit::detail
