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
// And a name that the kit does not know, written for one that it does.
#define ILAW_KIT_SPELLING(wrong, right)                                     \
  ILAW_KIT_NAME(wrong);                                                     \
  template <class Law>                                                      \
  constexpr bool spells_##wrong() {                                         \
    constexpr bool is_right = !names_##wrong<Law>;                          \
    static_assert(is_right, "the kit calls no '" #wrong "': write " right); \
    return is_right;                                                        \
  }

// Every name that a law may define (law.hpp says what for), and how often it is missed.
// clang-format off
ILAW_KIT_NAME(card); ILAW_KIT_NAME(references); ILAW_KIT_NAME(parameters); ILAW_KIT_NAME(state);
ILAW_KIT_NAME(state_variables); ILAW_KIT_NAME(history); ILAW_KIT_NAME(amounts); ILAW_KIT_NAME(step);
ILAW_KIT_NAME(problem); ILAW_KIT_NAME(answer); ILAW_KIT_NAME(ask); ILAW_KIT_NAME(solve);
ILAW_KIT_NAME(solve_scalar); ILAW_KIT_NAME(finish); ILAW_KIT_NAME(asks);
ILAW_KIT_NAME(prepare); ILAW_KIT_NAME(initialise); ILAW_KIT_NAME(conflict); ILAW_KIT_NAME(inputs);
ILAW_KIT_NAME(capabilities); ILAW_KIT_NAME(permissions); ILAW_KIT_NAME(tells_tangents_apart);
ILAW_KIT_NAME(stable_velocity_step); ILAW_KIT_NAME(window); ILAW_KIT_NAME(adds_to_window); ILAW_KIT_NAME(clears_window);
ILAW_KIT_NAME(extension);

#define ILAW_KIT_SPELLINGS(spelling) \
  spelling(params, "'parameters'") spelling(state_variable, "'state_variables'") \
  spelling(initialize, "'initialise'") spelling(init, "'initialise'") \
  spelling(do_step, "'step'") spelling(prepared, "'prepare'") \
  spelling(stable_step, "'stable_velocity_step'") \
  spelling(is_isotropic, ".is_isotropic = true in the card")
// clang-format on
ILAW_KIT_SPELLINGS(ILAW_KIT_SPELLING)

// All of them, whatever the first one says.
template <class Law>
constexpr bool spells_rightly() {
#define ILAW_KIT_SPELLED(wrong, right) &spells_##wrong<Law>()
  return true ILAW_KIT_SPELLINGS(ILAW_KIT_SPELLED);
#undef ILAW_KIT_SPELLED
}
#undef ILAW_KIT_NAME
#undef ILAW_KIT_SPELLING
#undef ILAW_KIT_SPELLINGS

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
constexpr bool state_is(auto is_right) {
  if constexpr (has_state<Law>) return is_right(Law::state_variables);
  return true;
}

template <class Law>
constexpr bool has_card() {
  if constexpr (requires { Law::card; }) return std::is_same_v<decltype(Law::card), const law_card>;
  return false;
}
template <class Law>
constexpr bool has_amounts_rightly() {
  if constexpr (names_amounts<Law>)
    return std::is_same_v<std::remove_cvref_t<decltype(Law::amounts[0])>, amount_card> &&
           amount_count<Law> <= most_amounts;
  return true;
}

constexpr bool same_text(const char* a, const char* b) {
  while (*a && *a == *b) ++a, ++b;
  return *a == *b;
}
template <class Law>
constexpr bool axes_are_known() {
  return all_of(Law::parameters, [](const auto& p) {
    for (std::uint32_t k = 0; k < p.axes.count && !p.member.is_grid(); ++k)
      if (const char* axis = p.axes.values[k]; !same_text(axis, "time"))
        if (all_of(Law::parameters, [&](const auto& f) { return !f.is_field || !same_text(axis, f.name); }))
          return false;
    return true;
  });
}

// Structs whose members are V and nothing else grow as V does.
template <class OfPack, class OfTwo>
inline constexpr bool all_of_V =
    sizeof(OfTwo) == 2 * sizeof(OfPack) && std::is_trivially_copy_constructible_v<OfPack>;
template <class Law>
constexpr bool state_is_of_V() {
  if constexpr (has_state<Law>)
    return all_of_V<typename law_on_t<Law, pack>::state, typename law_on_t<Law, pack_of<2>>::state>;
  return true;
}
template <class Law>
constexpr bool problems_are_of_V() {
  using One = law_on_t<Law, pack>;
  using Two = law_on_t<Law, pack_of<2>>;
  if constexpr (names_ask<Law>)
    return all_of_V<typename One::problem, typename Two::problem> &&
           all_of_V<typename One::answer, typename Two::answer>;
  return true;
}
// Every number of struct state once.
template <class Law>
constexpr bool state_is_covered() {
  return state_is<Law>([](const auto& all) {
    std::size_t numbers = 0;
    for (const auto& v : all) numbers += static_cast<std::size_t>(v.member.numbers());
    return numbers * sizeof(double) == sizeof(state_t<Law>);
  });
}

// ---- calls, of which only the types are named: no body is compiled for them

template <class Law, class Node>
using step_call = decltype(std::declval<Law>().step(std::declval<Node>()));
template <class Law, class Node, class Plain = std::remove_cvref_t<Law>>
using ask_call =
    decltype(std::declval<Law>().ask(std::declval<Node>(), std::declval<typename Plain::problem&>()));
template <class Law, class Node, class Plain = std::remove_cvref_t<Law>>
using finish_call =
    decltype(std::declval<Law>().finish(std::declval<Node>(), std::declval<const typename Plain::answer&>()));

template <template <class...> class Call, class... Arguments>
concept can = requires {
  typename Call<Arguments...>;
};
// A function that takes a copy of its node, or one that it may not write, changes nothing.
template <class Result, template <class...> class Call, class Law, class Node>
constexpr bool writes() {
  if constexpr (can<Call, const Law&, Node&>)
    return std::is_same_v<Call<const Law&, Node&>, Result> && !can<Call, const Law&, Node>;
  return false;
}

template <class Law, class Node>
struct calls {
  using node_type = Node;
  using Wide = law_on_t<Law, pack>;

  static constexpr bool steps = can<step_call, Wide&, Node&>, asks = can<ask_call, Wide&, Node&>;
  static constexpr bool step_fits = !steps || writes<status_of<pack>, step_call, Wide, Node>();
  static constexpr bool ask_fits = !asks || writes<asked<pack>, ask_call, Wide, Node>();
  static constexpr bool finish_fits = !asks || writes<status_of<pack>, finish_call, Wide, Node>();
};

// The nodes that a law may be given: by form of H, and by what its vectors are.
template <class Law, template <class> class Delassus>
constexpr bool all_nodes_of(auto is_right) {
  using Wide = law_on_t<Law, pack>;
  bool right = is_right(calls<Law, node<Wide, vector<pack>, Delassus<pack>>>{});
  if constexpr (needs_no_tangents<Law> && !std::is_same_v<Delassus<pack>, full<pack>>)
    right = right && is_right(calls<Law, node<Wide, projected<pack>, Delassus<pack>>>{});
  return right;
}
template <class Law>
constexpr bool all_nodes(auto is_right) {
  bool right = true;
  if constexpr (serves_transverse<Law>) right = right && all_nodes_of<Law, transverse>(is_right);
  if constexpr (serves_full<Law>) right = right && all_nodes_of<Law, full>(is_right);
  if constexpr (serves_spins<Law>) right = right && all_nodes_of<Law, transverse_spin>(is_right);
  return right;
}

template <class Law>
constexpr bool has_whole_solver() {
  constexpr int parts = names_problem<Law> + names_answer<Law> + names_ask<Law> + names_solve<Law> +
                        names_solve_scalar<Law> + names_finish<Law>;
  return parts == 0 || parts == 6;
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
template <class Law>
constexpr bool solves_rightly() {
  using Two = law_on_t<Law, pack_of<2>>;
  if constexpr (names_ask<Law>)
    return (solves_lanes<Two> || solves_lanes<Two, prepared_t<Two>>)&&(solves_one<Law> ||
                                                                       solves_one<Law, prepared_t<Law>>);
  return true;
}

template <class Law>
inline constexpr bool limits_step_rightly =
    !names_stable_velocity_step<Law> ||
    kernel<Law, pack, double, local_frame, transverse>::steps::by_delassus || !all_nodes<Law>([](auto call) {
      return !requires(const typename decltype(call)::Wide& law,
                       const typename decltype(call)::node_type& n) {
        law.stable_velocity_step(n);
      };
    });
template <class Law>
constexpr bool has_history_rightly() {
  if constexpr (has_history<Law>) return requires(const Law& law) {
      { law.window().duration } -> std::convertible_to<double>;
      { Law::adds_to_window(ilaw_status{}) } -> std::same_as<bool>;
      { Law::clears_window(ilaw_status{}) } -> std::same_as<bool>;
    };
  return !(names_window<Law> || names_adds_to_window<Law> || names_clears_window<Law>);
}

// ---- the checks

#define ILAW_KIT_CHECK(condition, text)    \
  {                                        \
    constexpr bool is_right = (condition); \
    static_assert(is_right, text);         \
    passes = passes && is_right;           \
  }
// A function that a law need not have, but that must be what it is called as.
#define ILAW_KIT_FUNCTION(name, result, declaration) \
  ILAW_KIT_CHECK(                                    \
      !names_##name<Law> ||                          \
          requires(const Law& law) {                 \
            { law.name() } -> std::same_as<result>;  \
          },                                         \
      #name " must be " declaration)

template <class Law>
constexpr bool passes_names() {
  bool passes = true;
  ILAW_KIT_CHECK(has_card<Law>(),
                 "a law needs static constexpr law_card card{.id = ..., .title = ..., .doc = ...}")
  ILAW_KIT_CHECK(
      names_references<Law>,
      "a law needs static constexpr const char* references[] = {...}: where its equations are from")
  ILAW_KIT_CHECK(names_parameters<Law>,
                 "a law needs static constexpr parameter<Law> parameters[] = {{.member = &Law::name, ...}}")
  ILAW_KIT_CHECK(names_step<Law> || names_ask<Law>,
                 "a law needs template <class Node> status_of<V> step(Node& node) const")
  ILAW_KIT_CHECK(names_state<Law> == names_state_variables<Law>,
                 "a memory is struct state and static constexpr state_variable<state> state_variables[]")
  ILAW_KIT_CHECK(has_whole_solver<Law>(),
                 "a solver is problem, answer, ask, solve, solve_scalar and finish: one of them is missing")
  ILAW_KIT_CHECK(!names_asks<Law> || (names_step<Law> && names_ask<Law>),
                 "asks chooses between step and ask: the law has one of them alone")
  return passes;
}

// Law: L<double>.
template <class Law>
constexpr bool passes_members() {
  bool passes = true;
  using Wide = law_on_t<Law, pack>;
  constexpr std::uint32_t inputs = reads_gap | reads_v_previous | reads_v_smooth | reads_area;

  ILAW_KIT_CHECK(Law::card.id && Law::card.title && Law::card.doc,
                 "the card of a law needs .id, .title and .doc")
  ILAW_KIT_CHECK(
      (Law::card.inputs & ~inputs) == 0,
      ".inputs of the card are reads_gap, reads_v_previous, reads_v_smooth and reads_area, joined by |")
  ILAW_KIT_CHECK(Law::card.dimensions != 0 && Law::card.delassus_forms != 0,
                 "the card of a law serves at least one dimension and one form of H")
  ILAW_KIT_CHECK(
      !(Law::card.delassus_forms & ILAW_DELASSUS_DIAGONAL) || (Law::card.delassus_forms & ILAW_DELASSUS_FULL),
      "a card that serves a diagonal H serves a full one, too: in the host's axes it is full")
  ILAW_KIT_CHECK(all_of(Law::parameters, [](const auto& p) { return p.member.is_given() && p.name; }),
                 "a parameter needs .member = &Law::name and .name = \"name\"")
  ILAW_KIT_CHECK(differ(Wide::parameters, [](const auto& p) { return p.member; }),
                 "two parameters have the same .member: each needs one of its own")
  ILAW_KIT_CHECK(sizeof(Law) == sizeof(double) * std::size(Law::parameters),
                 "a law's members are its parameters, V, double or grid: each needs an entry of parameters[]")
  ILAW_KIT_CHECK(parameter_count<Law> <= most_parameters, "a law has at most 32 parameters")
  ILAW_KIT_CHECK(
      all_of(Wide::parameters,
             [](const auto& p) { return !(p.choices.count > 0 || p.whole) || !p.member.may_vary(); }),
      "a choice or whole number is the same at all nodes: its member is a double, not a V")
  ILAW_KIT_CHECK(all_of(Wide::parameters, [](const auto& p) { return !p.is_field || p.member.may_vary(); }),
                 "a field differs from node to node: its member is a V")
  ILAW_KIT_CHECK(axes_are_known<Law>(),
                 "a table is over \"time\" or a field, a parameter with .is_field = true")
  ILAW_KIT_CHECK(state_is_of_V<Law>(),
                 "the members of struct state must be V, vector<V> or tangential_vector<V>")
  ILAW_KIT_CHECK(state_is<Law>([](const auto& all) {
                   return all_of(all, [](const auto& v) { return v.member.is_given() && v.name; });
                 }),
                 "a state variable needs .member = &state::name and .name = \"name\"")
  ILAW_KIT_CHECK(!state_is_of_V<Law>() || state_is_covered<Law>(),
                 "every member of struct state needs an entry of state_variables[]")
  ILAW_KIT_CHECK(problems_are_of_V<Law>(), "the members of problem and answer must all be of type V")
  ILAW_KIT_CHECK(
      solves_rightly<Law>(),
      "solve must be mask_of<V> solve(const problem& p, answer& a) const, and solve_scalar the same without "
      "result; both may take what prepare gave as well")
  ILAW_KIT_CHECK(
      !names_asks<Law> ||
          requires(const Law& law) {
            { law.asks() } -> std::same_as<bool>;
          } ||
          requires(const Law& law) {
            { law.asks(true) } -> std::same_as<bool>;
          },
      "asks must be bool asks() const or bool asks(bool is_transverse) const")
  ILAW_KIT_FUNCTION(conflict, const char*, "const char* conflict() const")
  ILAW_KIT_FUNCTION(inputs, std::uint32_t, "std::uint32_t inputs() const")
  ILAW_KIT_FUNCTION(capabilities, std::uint32_t, "std::uint32_t capabilities() const")
  ILAW_KIT_FUNCTION(permissions, std::uint32_t, "std::uint32_t permissions() const")
  ILAW_KIT_FUNCTION(tells_tangents_apart, bool, "bool tells_tangents_apart() const")
  ILAW_KIT_CHECK(
      !names_prepare<Law> || requires(const Law& law, const step_sizes& s) { law.prepare(s); },
      "prepare must be auto prepare(const step_sizes& step) const")
  ILAW_KIT_CHECK(
      !names_initialise<Law> || requires(const Law& law, initial_node<Law>& n) { law.initialise(n); },
      "initialise must be template <class Node> void initialise(Node& node) const")
  ILAW_KIT_CHECK(
      !names_extension<Law> ||
          requires(const char* s) {
            { Law::extension(s) } -> std::same_as<const void*>;
          },
      "extension must be static const void* extension(const char* name)")
  ILAW_KIT_CHECK(has_amounts_rightly<Law>(),
                 "amounts must be static constexpr amount_card amounts[], at most eight")
  ILAW_KIT_CHECK(has_history_rightly<Law>(),
                 "a history is static constexpr history_card history and window() const with static bool "
                 "adds_to_window(ilaw_status) and clears_window(ilaw_status)")
  return passes;
}

// Checks of the calls with nodes, which need valid names and members.
template <class Law>
constexpr bool passes_nodes() {
  bool passes = true;
  ILAW_KIT_CHECK(state_is<Law>([](const auto& all) {
                   return differ(all, [](const auto& v) { return v.member.place(); });
                 }),
                 "two state variables have the same .member: each needs one of its own")
  ILAW_KIT_CHECK(all_nodes<Law>([](auto call) { return call.steps || call.asks; }),
                 "no step or ask takes the nodes of a form of H that .delassus_forms of the card names")
  ILAW_KIT_CHECK(all_nodes<Law>([](auto call) { return call.step_fits; }),
                 "step must be template <class Node> status_of<V> step(Node& node) const")
  ILAW_KIT_CHECK(all_nodes<Law>([](auto call) { return call.ask_fits; }),
                 "ask must be template <class Node> asked<V> ask(Node& node, problem& open) const")
  ILAW_KIT_CHECK(
      all_nodes<Law>([](auto call) { return call.finish_fits; }),
      "finish must be template <class Node> status_of<V> finish(Node& node, const answer& a) const")
  ILAW_KIT_CHECK(!serves_spins<Law> || (reads<Law>(reads_v_previous) && !has_history<Law> &&
                                        (Law::card.dimensions & ILAW_DIMENSION_3)),
                 "a law with_spins serves dimension 3, reads_v_previous, and has no history")
  ILAW_KIT_CHECK(all_nodes<Law>([](auto call) { return !(call.steps && call.asks) || names_asks<Law>; }),
                 "step and ask take the same nodes: bool asks() const says which parameters need ask")
  ILAW_KIT_CHECK(
      limits_step_rightly<Law>,
      "stable_velocity_step must be V stable_velocity_step(V h_n, V h_t) const, or template <class Node> V "
      "stable_velocity_step(const Node& node) const")
  return passes;
}
#undef ILAW_KIT_CHECK
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
