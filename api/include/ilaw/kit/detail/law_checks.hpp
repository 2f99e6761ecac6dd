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

// Names that the kit does not know, and what they stand for.
#define ILAW_KIT_MISSPELLINGS(f) \
  f(params, "'parameters'") f(state_variable, "'state_variables'") f(initialize, "'initialise'") \
  f(init, "'initialise'") f(do_step, "'step'") f(prepared, "'prepare'") \
  f(stable_step, "'stable_velocity_step'") f(is_isotropic, ".is_isotropic = true in the card")
// clang-format on
#define ILAW_KIT_MISSPELLED(wrong, right) ILAW_KIT_NAME(wrong);
ILAW_KIT_MISSPELLINGS(ILAW_KIT_MISSPELLED)

// ---- entries of a law's tables

constexpr bool all_of(const auto& entries, auto is_right) {
  for (const auto& entry : entries)
    if (!is_right(entry)) return false;
  return true;
}
constexpr bool differ(const auto& entries, auto place) {
  for (std::size_t i = 0; i < std::size(entries); ++i)
    for (std::size_t j = 0; j < i; ++j)
      if (place(entries[i]) == place(entries[j])) return false;
  return true;
}
template <class Law>
constexpr bool is_axis(const char* axis) {
  const std::string_view name = axis;
  return name == "time" ||
         !all_of(Law::parameters, [&](const auto& f) { return !f.is_field || name != f.name; });
}
template <class Law>
constexpr bool axes_are_known() {
  return all_of(Law::parameters, [](const auto& p) {
    for (std::uint32_t k = 0; k < p.axes.count; ++k)
      if (!p.member.is_grid() && !is_axis<Law>(p.axes.values[k])) return false;
    return true;
  });
}

// Structs whose members are V and nothing else grow as V does.
template <class OfPack, class OfTwo>
inline constexpr bool all_of_V =
    sizeof(OfTwo) == 2 * sizeof(OfPack) && std::is_trivially_copy_constructible_v<OfPack>;
// Every number of struct state once.
template <class Law>
constexpr bool state_is_covered() {
  std::size_t numbers = 0;
  for (const auto& v : Law::state_variables) numbers += static_cast<std::size_t>(v.member.numbers());
  return numbers * sizeof(double) == sizeof(state_t<Law>);
}

// ---- calls, of which only the types are named: no body is compiled for them

#define ILAW_KIT_CALL(name, ...)                                                    \
  struct name##_call {                                                              \
    template <class Law, class Node>                                                \
    auto operator()(Law& law, Node&& node) const                                    \
        -> decltype(law.name(std::forward<Node>(node) __VA_OPT__(, ) __VA_ARGS__)); \
  }
ILAW_KIT_CALL(step);
ILAW_KIT_CALL(ask, std::declval<typename Law::problem&>());
ILAW_KIT_CALL(finish, std::declval<const typename Law::answer&>());
#undef ILAW_KIT_CALL
// A function that takes a copy of its node, or one that it may not write, changes nothing.
template <class Call, class Result, class Law, class Node>
inline constexpr bool fits = requires(const Law& law, Node& node, Call call) {
  { call(law, node) } -> std::same_as<Result>;
}
&&!std::is_invocable_v<Call, const Law&, Node>;

template <class Law, class Node>
struct calls {
  using Wide = law_on_t<Law, pack>;
  static constexpr bool steps = std::is_invocable_v<step_call, Wide&, Node&>,
                        asks = std::is_invocable_v<ask_call, Wide&, Node&>,
                        step_fits = !steps || fits<step_call, status_of<pack>, Wide, Node>,
                        ask_fits = !asks || fits<ask_call, asked<pack>, Wide, Node>,
                        finish_fits = !asks || fits<finish_call, status_of<pack>, Wide, Node>,
                        limits = requires(const Wide&law, const Node&node) {
    law.stable_velocity_step(node);
  };
};
// The nodes that a law may be given: by form of H, and by what its vectors are.
template <class Law>
constexpr bool all_nodes(auto is_right) {
  using Wide = law_on_t<Law, pack>;
  bool right = true;
  const auto add = [&]<class H>(std::type_identity<H>) {
    right = right && is_right(calls<Law, node<Wide, vector<pack>, H>>{});
    if constexpr (needs_no_tangents<Law> && !std::is_same_v<H, full<pack>>)
      right = right && is_right(calls<Law, node<Wide, projected<pack>, H>>{});
  };
  if constexpr (serves_transverse<Law>) add(std::type_identity<transverse<pack>>{});
  if constexpr (serves_full<Law>) add(std::type_identity<full<pack>>{});
  if constexpr (serves_spins<Law>) add(std::type_identity<transverse_spin<pack>>{});
  return right;
}
// Own: what prepare gave, which both solvers may take as well.
template <class Law, class... Own>
concept solves_lanes = requires(const Law& law, const typename Law::problem& p, typename Law::answer& a,
                                const Own&... own) {
  { law.solve(p, a, own...) } -> std::same_as<mask_of<typename number_of_law<Law>::type>>;
};
template <class Law, class... Own>
concept solves_one = requires(const Law& law, const typename Law::problem& p, typename Law::answer& a,
                              const Own&... own) {
  law.solve_scalar(p, a, own...);
};

// ---- the checks

// Where the law has something: the line that says what to write unless the condition on it holds.
#define ILAW_KIT_WHERE(has, text, ...)       \
  if constexpr (has) {                       \
    constexpr bool is_right = (__VA_ARGS__); \
    static_assert(is_right, text);           \
    passes = passes && is_right;             \
  }
#define ILAW_KIT_CHECK(text, ...) ILAW_KIT_WHERE(true, text, __VA_ARGS__)
// A function that a law need not have.
#define ILAW_KIT_FUNCTION(name, result)                                  \
  ILAW_KIT_WHERE(                                                        \
      names_##name<Law>, #name " must be " #result " " #name "() const", \
      requires(const Law& law) { requires std::is_same_v<decltype(law.name()), result>; })
#define ILAW_KIT_SPELLED(wrong, right) \
  ILAW_KIT_CHECK("the kit calls no '" #wrong "': write " right, !names_##wrong<Law>)

template <class Law>
constexpr bool spells_rightly() {
  bool passes = true;
  ILAW_KIT_MISSPELLINGS(ILAW_KIT_SPELLED)
  return passes;
}

template <class Law>
constexpr bool passes_names() {
  bool passes = true;
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
  constexpr int parts = names_problem<Law> + names_answer<Law> + names_ask<Law> + names_solve<Law> +
                        names_solve_scalar<Law> + names_finish<Law>;
  ILAW_KIT_WHERE(parts != 0,
                 "a solver is problem, answer, ask, solve, solve_scalar and finish: one of them is missing",
                 parts == 6)
  ILAW_KIT_WHERE(names_asks<Law>, "asks chooses between step and ask: the law has one of them alone",
                 names_step<Law> && names_ask<Law>)
  return passes;
}

// Law: L<double>.
template <class Law>
constexpr bool passes_members() {
  bool passes = true;
  using Wide = law_on_t<Law, pack>;
  using Two = law_on_t<Law, pack_of<2>>;
  constexpr std::uint32_t inputs = reads_gap | reads_v_previous | reads_v_smooth | reads_area;
  constexpr std::uint32_t forms = Law::card.delassus_forms;

  ILAW_KIT_CHECK("the card of a law needs .id, .title and .doc",
                 Law::card.id && Law::card.title && Law::card.doc)
  ILAW_KIT_CHECK(
      ".inputs of the card are reads_gap, reads_v_previous, reads_v_smooth and reads_area, joined by |",
      (Law::card.inputs & ~inputs) == 0)
  ILAW_KIT_CHECK("the card of a law serves at least one dimension and one form of H",
                 Law::card.dimensions != 0 && forms != 0)
  ILAW_KIT_WHERE((forms & ILAW_DELASSUS_DIAGONAL) != 0,
                 "a card that serves a diagonal H serves a full one, too: in the host's axes it is full",
                 (forms & ILAW_DELASSUS_FULL) != 0)
  ILAW_KIT_CHECK("a parameter needs .member = &Law::name and .name = \"name\"",
                 all_of(Law::parameters, [](const auto& p) { return p.member.is_given() && p.name; }))
  ILAW_KIT_CHECK("two parameters have the same .member: each needs one of its own",
                 differ(Wide::parameters, [](const auto& p) { return p.member; }))
  ILAW_KIT_CHECK("a law's members are its parameters, V, double or grid: each needs an entry of parameters[]",
                 sizeof(Law) == sizeof(double) * std::size(Law::parameters))
  ILAW_KIT_CHECK("a law has at most 32 parameters", parameter_count<Law> <= most_parameters)
  ILAW_KIT_CHECK("a choice or whole number is the same at all nodes: its member is a double, not a V",
                 all_of(Wide::parameters, [](const auto& p) {
                   return !(p.choices.count > 0 || p.whole) || !p.member.may_vary();
                 }))
  ILAW_KIT_CHECK("a field differs from node to node: its member is a V",
                 all_of(Wide::parameters, [](const auto& p) { return !p.is_field || p.member.may_vary(); }))
  ILAW_KIT_CHECK("a table is over \"time\" or a field, a parameter with .is_field = true",
                 axes_are_known<Law>())
  if constexpr (has_state<Law>) {
    constexpr bool is_of_V = all_of_V<typename Wide::state, typename Two::state>;
    ILAW_KIT_CHECK("the members of struct state must be V, vector<V> or tangential_vector<V>", is_of_V)
    ILAW_KIT_CHECK("a state variable needs .member = &state::name and .name = \"name\"",
                   all_of(Law::state_variables, [](const auto& v) { return v.member.is_given() && v.name; }))
    ILAW_KIT_WHERE(is_of_V, "every member of struct state needs an entry of state_variables[]",
                   state_is_covered<Law>())
  }
  if constexpr (names_ask<Law>) {
    ILAW_KIT_CHECK("the members of problem and answer must all be of type V",
                   all_of_V<typename Wide::problem, typename Two::problem> &&
                       all_of_V<typename Wide::answer, typename Two::answer>)
    ILAW_KIT_CHECK(
        "solve must be mask_of<V> solve(const problem& p, answer& a) const, and solve_scalar the same without "
        "result; both may take what prepare gave as well",
        (solves_lanes<Two> || solves_lanes<Two, prepared_t<Two>>)&&(solves_one<Law> ||
                                                                    solves_one<Law, prepared_t<Law>>))
  }
  ILAW_KIT_WHERE(
      names_asks<Law>, "asks must be bool asks() const or bool asks(bool is_transverse) const",
      requires(const Law& law) { requires std::is_same_v<decltype(law.asks()), bool>; } ||
          requires(const Law& law) { requires std::is_same_v<decltype(law.asks(true)), bool>; })
  ILAW_KIT_FUNCTION(conflict, const char*)
  ILAW_KIT_FUNCTION(inputs, std::uint32_t)
  ILAW_KIT_FUNCTION(capabilities, std::uint32_t)
  ILAW_KIT_FUNCTION(permissions, std::uint32_t)
  ILAW_KIT_FUNCTION(tells_tangents_apart, bool)
  ILAW_KIT_WHERE(
      names_prepare<Law>, "prepare must be auto prepare(const step_sizes& step) const",
      requires(const Law& law, const step_sizes& s) { law.prepare(s); })
  ILAW_KIT_WHERE(
      names_initialise<Law>, "initialise must be template <class Node> void initialise(Node& node) const",
      requires(const Law& law, initial_node<Law>& n) { law.initialise(n); })
  ILAW_KIT_WHERE(
      names_extension<Law>, "extension must be static const void* extension(const char* name)",
      requires(const char* s) { requires std::is_same_v<decltype(Law::extension(s)), const void*>; })
  ILAW_KIT_WHERE(names_amounts<Law>, "amounts must be static constexpr amount_card amounts[], at most eight",
                 std::is_same_v<std::remove_cvref_t<decltype(Law::amounts[0])>, amount_card> &&
                     amount_count<Law> <= most_amounts)
  constexpr bool has_any_history =
      names_history<Law> || names_window<Law> || names_adds_to_window<Law> || names_clears_window<Law>;
  ILAW_KIT_WHERE(
      has_any_history,
      "a history is static constexpr history_card history and window() const with static bool "
      "adds_to_window(ilaw_status) and clears_window(ilaw_status)",
      requires(const Law& law) {
        Law::history;
        { law.window().duration } -> std::convertible_to<double>;
        { Law::adds_to_window(ilaw_status{}) } -> std::same_as<bool>;
        { Law::clears_window(ilaw_status{}) } -> std::same_as<bool>;
      })
  return passes;
}

// Checks of the calls with nodes, which need valid names and members.
template <class Law>
constexpr bool passes_nodes() {
  bool passes = true;
  ILAW_KIT_WHERE(has_state<Law>, "two state variables have the same .member: each needs one of its own",
                 differ(Law::state_variables, [](const auto& v) { return v.member.place(); }))
  ILAW_KIT_CHECK("no step or ask takes the nodes of a form of H that .delassus_forms of the card names",
                 all_nodes<Law>([](auto call) { return call.steps || call.asks; }))
  ILAW_KIT_CHECK("step must be template <class Node> status_of<V> step(Node& node) const",
                 all_nodes<Law>([](auto call) { return call.step_fits; }))
  ILAW_KIT_CHECK("ask must be template <class Node> asked<V> ask(Node& node, problem& open) const",
                 all_nodes<Law>([](auto call) { return call.ask_fits; }))
  ILAW_KIT_CHECK(
      "finish must be template <class Node> status_of<V> finish(Node& node, const answer& a) const",
      all_nodes<Law>([](auto call) { return call.finish_fits; }))
  ILAW_KIT_WHERE(
      serves_spins<Law>, "a law with_spins serves dimension 3, reads_v_previous, and has no history",
      reads<Law>(reads_v_previous) && !has_history<Law> && (Law::card.dimensions & ILAW_DIMENSION_3) != 0)
  ILAW_KIT_WHERE(!names_asks<Law>,
                 "step and ask take the same nodes: bool asks() const says which parameters need ask",
                 all_nodes<Law>([](auto call) { return !(call.steps && call.asks); }))
  ILAW_KIT_WHERE(
      names_stable_velocity_step<Law>,
      "stable_velocity_step must be V stable_velocity_step(V h_n, V h_t) const, or template <class Node> V "
      "stable_velocity_step(const Node& node) const",
      requires(const Law& law) { law.stable_velocity_step(1.0, 1.0); } ||
          !all_nodes<Law>([](auto call) { return !call.limits; }))
  return passes;
}
#undef ILAW_KIT_NAME
#undef ILAW_KIT_MISSPELLINGS
#undef ILAW_KIT_MISSPELLED
#undef ILAW_KIT_SPELLED
#undef ILAW_KIT_CHECK
#undef ILAW_KIT_WHERE
#undef ILAW_KIT_FUNCTION

// Whether a struct is a law; an error of one line where it is not.
template <template <class> class L>
constexpr bool checked() {
  using Law = L<double>;
  if constexpr (spells_rightly<Law>() && passes_names<Law>())
    if constexpr (passes_members<Law>()) return passes_nodes<Law>();
  return false;
}

}  // namespace ilaw::kit::detail
