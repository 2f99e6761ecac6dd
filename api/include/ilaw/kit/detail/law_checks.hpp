// law_checks.hpp - what a law must have to be one, each with the line that says what to write. A law that
// fails here is compiled no further, so that nothing of the kit's insides stands in the compiler's message.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit/detail/evaluate.hpp>

// A path through a law's step that returns no status: an error in whatever follows this header.
#pragma GCC diagnostic error "-Wreturn-type"

namespace ilaw::kit::inline ILAW_KIT_LEVEL::detail {

// ---- names, which a law has or has not

// names_x<Law>: whether a law has a member x of any kind; two of a name are ambiguous.
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
// Every name that a law may define; law.hpp says what for.
// clang-format off
ILAW_KIT_NAME(card); ILAW_KIT_NAME(references); ILAW_KIT_NAME(parameters); ILAW_KIT_NAME(state);
ILAW_KIT_NAME(state_variables); ILAW_KIT_NAME(history); ILAW_KIT_NAME(amounts); ILAW_KIT_NAME(step);
ILAW_KIT_NAME(problem); ILAW_KIT_NAME(answer); ILAW_KIT_NAME(ask); ILAW_KIT_NAME(solve);
ILAW_KIT_NAME(solve_scalar); ILAW_KIT_NAME(finish); ILAW_KIT_NAME(asks);
ILAW_KIT_NAME(prepare); ILAW_KIT_NAME(initialise); ILAW_KIT_NAME(conflict); ILAW_KIT_NAME(inputs);
ILAW_KIT_NAME(capabilities); ILAW_KIT_NAME(permissions); ILAW_KIT_NAME(tells_tangents_apart);
ILAW_KIT_NAME(stable_velocity_step); ILAW_KIT_NAME(window); ILAW_KIT_NAME(adds_to_window); ILAW_KIT_NAME(clears_window);
ILAW_KIT_NAME(extension);
// Names that the kit would pass over.
ILAW_KIT_NAME(initialize); ILAW_KIT_NAME(init); ILAW_KIT_NAME(prepared); ILAW_KIT_NAME(stable_step);
ILAW_KIT_NAME(is_isotropic);
// clang-format on
#undef ILAW_KIT_NAME

// ---- entries of a law's tables

constexpr bool all_of(const auto& entries, auto is_right) {
  for (const auto& entry : entries)
    if (!is_right(entry)) return false;
  return true;
}
constexpr int sum_of(const auto& entries, auto number) {
  int sum = 0;
  for (const auto& entry : entries) sum += number(entry);
  return sum;
}
constexpr bool differ(const auto& entries, auto place) {
  for (std::size_t i = 0; i < std::size(entries); ++i)
    for (std::size_t j = 0; j < i; ++j)
      if (place(entries[i]) == place(entries[j])) return false;
  return true;
}
template <class Law>
constexpr bool is_axis(std::string_view name) {
  return name == "time" || !all_of(Law::parameters, [&](auto& p) { return !p.is_field || name != p.name; });
}

// Structs whose members are V and nothing else grow as V does.
template <class OfPack, class OfTwo>
inline constexpr bool all_of_V =
    sizeof(OfTwo) == 2 * sizeof(OfPack) && std::is_trivially_copy_constructible_v<OfPack>;

// ---- calls, of which only the types are named: no body is compiled for them

// Whether a law takes a node; and whether it takes it as it must: a function that takes a copy of its node,
// or one that it may not write, changes nothing.
#define ILAW_KIT_CALL(name, result, ...)                                       \
  template <class Law, class Node>                                             \
  concept calls_##name = requires(Law & law, Node && node) {                   \
    law.name(std::forward<Node>(node) __VA_OPT__(, ) __VA_ARGS__);             \
  };                                                                           \
  template <class Law, class Node>                                             \
  inline constexpr bool fits_##name =                                          \
      !calls_##name<const Law, Node> && requires(const Law& law, Node& node) { \
    { law.name(node __VA_OPT__(, ) __VA_ARGS__) } -> std::same_as<result>;     \
  }
ILAW_KIT_CALL(step, status_of<pack>);
ILAW_KIT_CALL(ask, asked<pack>, std::declval<typename Law::problem&>());
ILAW_KIT_CALL(finish, status_of<pack>, std::declval<const typename Law::answer&>());
#undef ILAW_KIT_CALL
// Own: what prepare gave, which both solvers may take as well.
template <class Law, class... Own>
concept solves = requires(const Law& law, const typename Law::problem& p, typename Law::answer& a,
                          const Own&... own) {
  { law.solve(p, a, own...) } -> std::same_as<mask_of<typename number_of_law<Law>::type>>;
  law.solve_scalar(p, a, own...);
};

// ---- the checks

// The line that says what to write unless a condition holds. The next check is compiled only if it does.
#define ILAW_KIT_CHECK(text, ...)      \
  if constexpr (!(__VA_ARGS__)) {      \
    static_assert(!sizeof(Law), text); \
    return false;                      \
  } else
// A function that a law need not have; signature: how to write it.
#define ILAW_KIT_FUNCTION(name, signature, ...)                                                           \
  ILAW_KIT_CHECK(                                                                                         \
      #name " must be " signature, !names_##name<Law> || requires(const Law& law, const step_sizes& step, \
                                                                  initial_node<Law>& node) { __VA_ARGS__; })
#define ILAW_KIT_SPELLED(wrong, right) \
  ILAW_KIT_CHECK("the kit calls no '" #wrong "': write " right, !names_##wrong<Law>)

template <class Law, class Vector, class H>
constexpr bool passes_node() {
  using Wide = law_on_t<Law, pack>;
  using Node = node<Wide, Vector, H>;
  constexpr bool steps = calls_step<Wide, Node&>, asks = calls_ask<Wide, Node&>;
  ILAW_KIT_CHECK("no step or ask takes the nodes of a form of H that .delassus_forms of the card names",
                 steps || asks)
  ILAW_KIT_CHECK("step must be template <class Node> status_of<V> step(Node& node) const",
                 !steps || fits_step<Wide, Node>)
  ILAW_KIT_CHECK("ask must be template <class Node> asked<V> ask(Node& node, problem& open) const",
                 !asks || fits_ask<Wide, Node>)
  ILAW_KIT_CHECK(
      "finish must be template <class Node> status_of<V> finish(Node& node, const answer& a) const",
      !asks || fits_finish<Wide, Node>)
  ILAW_KIT_CHECK("step and ask take the same nodes: bool asks() const says which parameters need ask",
                 !(steps && asks) || names_asks<Law>)
  ILAW_KIT_CHECK(
      "stable_velocity_step must be template <class Node> V stable_velocity_step(const Node& node) const",
      !names_stable_velocity_step<Law> ||
          requires(const Wide& law, const Node& node) { law.stable_velocity_step(node); })
  return true;
}
// One kind after the other, so that a mistake is said once.
template <class Law, class H, bool Serves>
constexpr bool passes_nodes() {
  if constexpr (!Serves)
    return true;
  else if constexpr (!needs_no_tangents<Law> || std::is_same_v<H, full<pack>>)
    return passes_node<Law, vector<pack>, H>();
  else if constexpr (passes_node<Law, vector<pack>, H>())
    return passes_node<Law, projected<pack>, H>();
  else
    return false;
}

template <class Law>
constexpr bool passes_state() {
  return true;
}
template <has_state Law>
constexpr bool passes_state() {
  ILAW_KIT_CHECK("the members of struct state must be V, vector<V> or tangential_vector<V>",
                 all_of_V<typename law_on_t<Law, pack>::state, typename law_on_t<Law, pack_of<2>>::state>)
  ILAW_KIT_CHECK("a state variable needs .member = &state::name and .name = \"name\"",
                 all_of(Law::state_variables, [](auto& v) { return v.member.is_given() && v.name; }))
  ILAW_KIT_CHECK(
      "every member of struct state needs an entry of state_variables[]",
      sum_of(Law::state_variables, [](auto& v) { return v.member.numbers(); }) == state_numbers<Law>)
  ILAW_KIT_CHECK("two state variables have the same .member: each needs one of its own",
                 differ(Law::state_variables, [](auto& v) { return v.member.place(); }))
  return true;
}

// Whether a struct is a law; an error of one line where it is not.
template <template <class> class L>
constexpr bool checked() {
  using Law = L<double>;
  using Wide = L<pack>;
  using Two = L<pack_of<2>>;
  constexpr int parts = names_problem<Law> + names_answer<Law> + names_ask<Law> + names_solve<Law> +
                        names_solve_scalar<Law> + names_finish<Law>;
  constexpr bool has_any_history =
      names_history<Law> || names_window<Law> || names_adds_to_window<Law> || names_clears_window<Law>;
  ILAW_KIT_SPELLED(initialize, "'initialise'")
  ILAW_KIT_SPELLED(init, "'initialise'")
  ILAW_KIT_SPELLED(prepared, "'prepare'")
  ILAW_KIT_SPELLED(stable_step, "'stable_velocity_step'")
  ILAW_KIT_SPELLED(is_isotropic, ".is_isotropic = true in the card")
  ILAW_KIT_CHECK(
      "a law needs static constexpr law_card card{.id = ..., .title = ..., .doc = ...}",
      requires { requires std::is_same_v<decltype(Law::card), const law_card>; })
  ILAW_KIT_CHECK(
      "a law needs static constexpr const char* references[] = {...}: where its equations are from",
      names_references<Law>)
  ILAW_KIT_CHECK("a law needs static constexpr parameter<Law> parameters[] = {{.member = &Law::name, ...}}",
                 names_parameters<Law>)
  ILAW_KIT_CHECK("a law needs template <class Node> status_of<V> step(Node& node) const",
                 names_step<Law> || names_ask<Law>)
  ILAW_KIT_CHECK("a memory is struct state and static constexpr state_variable<state> state_variables[]",
                 names_state<Law> == names_state_variables<Law>)
  ILAW_KIT_CHECK("a solver is problem, answer, ask, solve, solve_scalar and finish: one of them is missing",
                 parts == 0 || parts == 6)
  ILAW_KIT_CHECK("asks chooses between step and ask: the law has one of them alone",
                 !names_asks<Law> || (names_step<Law> && names_ask<Law>))
  ILAW_KIT_CHECK("the card of a law needs .id, .title and .doc",
                 Law::card.id && Law::card.title && Law::card.doc)
  ILAW_KIT_CHECK(
      "a card that serves a diagonal H serves a full one, too: in the host's axes it is full",
      !(Law::card.delassus_forms & ILAW_DELASSUS_DIAGONAL) || (Law::card.delassus_forms & ILAW_DELASSUS_FULL))
  ILAW_KIT_CHECK("a parameter needs .member = &Law::name and .name = \"name\"",
                 all_of(Law::parameters, [](auto& p) { return p.member.is_given() && p.name; }))
  ILAW_KIT_CHECK("two parameters have the same .member: each needs one of its own",
                 differ(Wide::parameters, [](auto& p) { return p.member; }))
  ILAW_KIT_CHECK("a law's members are its parameters, V, double or grid: each needs an entry of parameters[]",
                 sizeof(Law) == sizeof(double) * std::size(Law::parameters))
  ILAW_KIT_CHECK("a law has at most 32 parameters and eight amounts",
                 parameter_count<Law> <= most_parameters && amount_count<Law> <= most_amounts)
  ILAW_KIT_CHECK("a law with_spins serves dimension 3, reads_v_previous, and has no history",
                 !serves_spins<Law> || (reads<Law>(reads_v_previous) && !has_window<Law> &&
                                        (Law::card.dimensions & ILAW_DIMENSION_3)))
  ILAW_KIT_CHECK("a choice or whole number is the same at all nodes: its member is a double, not a V",
                 all_of(Wide::parameters,
                        [](auto& p) { return !(p.choices.count > 0 || p.whole) || !p.member.may_vary(); }))
  ILAW_KIT_CHECK("a field differs from node to node: its member is a V",
                 all_of(Wide::parameters, [](auto& p) { return !p.is_field || p.member.may_vary(); }))
  ILAW_KIT_CHECK(
      "a table is over \"time\" or a field, a parameter with .is_field = true",
      all_of(Wide::parameters, [](auto& p) { return p.member.is_grid() || all_of(p.axes, is_axis<Law>); }))
  ILAW_KIT_CHECK("asks must be bool asks() const or bool asks(bool is_transverse) const",
                 !names_asks<Law> || can_be_asked<Law>)
  ILAW_KIT_FUNCTION(conflict, "const char* conflict() const", { law.conflict() } -> std::same_as<const char*>)
  ILAW_KIT_FUNCTION(inputs, "std::uint32_t inputs() const", { law.inputs() } -> std::same_as<std::uint32_t>)
  ILAW_KIT_FUNCTION(capabilities, "std::uint32_t capabilities() const",
                    { law.capabilities() } -> std::same_as<std::uint32_t>)
  ILAW_KIT_FUNCTION(permissions, "std::uint32_t permissions() const",
                    { law.permissions() } -> std::same_as<std::uint32_t>)
  ILAW_KIT_FUNCTION(tells_tangents_apart, "bool tells_tangents_apart() const",
                    { law.tells_tangents_apart() } -> std::same_as<bool>)
  ILAW_KIT_FUNCTION(prepare, "auto prepare(const step_sizes& step) const", law.prepare(step))
  ILAW_KIT_FUNCTION(initialise, "template <class Node> void initialise(Node& node) const",
                    law.initialise(node))
  ILAW_KIT_FUNCTION(extension, "static const void* extension(const char* name)",
                    { Law::extension("") } -> std::same_as<const void*>)
  ILAW_KIT_CHECK(
      "a history is static constexpr history_card history and window() const with static bool "
      "adds_to_window(ilaw_status) and clears_window(ilaw_status)",
      !has_any_history || has_window<Law>)
  ILAW_KIT_CHECK(
      "the members of problem and answer must all be of type V", !names_ask<Law> || requires {
        requires all_of_V<typename Wide::problem, typename Two::problem>;
        requires all_of_V<typename Wide::answer, typename Two::answer>;
      })
  ILAW_KIT_CHECK(
      "solve must be mask_of<V> solve(const problem& p, answer& a) const, and solve_scalar the same without "
      "result; both may take what prepare gave as well",
      !names_ask<Law> || solves<Law> || solves<Law, prepared_t<Law>>)
  if constexpr (passes_state<Law>())
    if constexpr (passes_nodes<Law, transverse<pack>, serves_transverse<Law>>())
      if constexpr (passes_nodes<Law, full<pack>, serves_full<Law>>())
        return passes_nodes<Law, transverse_spin<pack>, serves_spins<Law>>();
  return false;
}
#undef ILAW_KIT_CHECK
#undef ILAW_KIT_FUNCTION
#undef ILAW_KIT_SPELLED

}  // namespace ilaw::kit::detail
