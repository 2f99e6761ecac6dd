// law_checks.hpp - what a law must have to be one, each with the line that says what to write. A law that
// fails here is compiled no further, so that nothing of the kit's insides stands in the compiler's message.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit/detail/evaluate.hpp>
#include <ilaw/kit/detail/law_names.hpp>

// A path through a law's step that returns no status: an error in whatever follows this header.
#pragma GCC diagnostic error "-Wreturn-type"

namespace ilaw::kit::inline ILAW_KIT_LEVEL::detail {

// ---- what the names stand for

template <class Law>
constexpr bool has_card() {
  if constexpr (requires { Law::card; }) return std::is_same_v<decltype(Law::card), const law_card>;
  return false;
}

// Parameters. Wide: L<pack>, whose members tell which of them may vary.
template <class Law>
constexpr bool all_parameters(auto is_right) {
  for (const auto& p : Law::parameters)
    if (!is_right(p)) return false;
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

constexpr bool same_text(const char* a, const char* b) {
  while (*a && *a == *b) ++a, ++b;
  return *a == *b;
}
template <class Law>
constexpr bool axes_are_known() {
  for (const auto& p : Law::parameters)
    for (std::uint32_t k = 0; k < p.axes.count && !p.member.is_grid(); ++k) {
      bool is_known = same_text(p.axes.values[k], "time");
      for (const auto& field : Law::parameters)
        is_known = is_known || (field.is_field && same_text(p.axes.values[k], field.name));
      if (!is_known) return false;
    }
  return true;
}

// Structs whose members are V and nothing else grow as V does.
template <class OfPack, class OfTwo>
inline constexpr bool all_of_V =
    sizeof(OfTwo) == 2 * sizeof(OfPack) && std::is_trivially_copy_constructible_v<OfPack>;

template <class Law>
constexpr bool state_is_given() {
  if constexpr (has_state<Law>)
    for (const auto& v : Law::state_variables)
      if (!v.member.is_given() || !v.name) return false;
  return true;
}
template <class Law>
constexpr bool state_is_of_V() {
  if constexpr (has_state<Law>)
    return all_of_V<typename law_on_t<Law, pack>::state, typename law_on_t<Law, pack_of<2>>::state>;
  return true;
}
// Every number of struct state once.
template <class Law>
constexpr bool state_is_covered() {
  if constexpr (has_state<Law>) {
    std::size_t numbers = 0;
    for (const auto& v : Law::state_variables) numbers += static_cast<std::size_t>(v.member.numbers());
    if (numbers * sizeof(double) != sizeof(state_t<Law>)) return false;
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

// The nodes that a law may be given: by form of H, and by what its vectors are.
template <class Law, template <class> class Vector, template <class> class Delassus>
using node_on = node<law_on_t<Law, pack>, Vector<pack>, Delassus<pack>>;

// Calls that only name their types: no body is compiled for them. T&&: a function that takes a copy of its
// node, or one that it may not write, changes nothing.
template <class Law, class Node>
struct calls {
  using node_type = Node;
  using Wide = law_on_t<Law, pack>;
  using V = pack;

  static constexpr bool steps_somehow = requires(Wide & law, Node& n) { law.step(n); };
  static constexpr bool steps = requires(const Wide& law, Node& n) {
    { law.step(n) } -> std::same_as<status_of<V>>;
  }
  &&!requires(const Wide& law, Node& n) { law.step(static_cast<Node&&>(n)); };
  template <class W>
  static constexpr bool asks_of() {
    if constexpr (requires { typename W::problem; })
      return requires(W & law, Node & n, typename W::problem & p) { law.ask(n, p); };
    return false;
  }
  static constexpr bool asks_somehow = asks_of<Wide>();
  template <class W>
  static constexpr bool asks_rightly() {
    if constexpr (asks_of<W>()) return requires(const W& law, Node& n, typename W::problem& p) {
        { law.ask(n, p) } -> std::same_as<asked<V>>;
      }
    &&!requires(const W& law, Node& n, typename W::problem& p) { law.ask(static_cast<Node&&>(n), p); };
    return true;
  }
  template <class W>
  static constexpr bool finishes_rightly() {
    if constexpr (asks_of<W>() && requires { typename W::answer; })
      return requires(const W& law, Node& n, const typename W::answer& a) {
        { law.finish(n, a) } -> std::same_as<status_of<V>>;
      }
    &&!requires(const W& law, Node& n, const typename W::answer& a) {
      law.finish(static_cast<Node&&>(n), a);
    };
    return true;
  }
  static constexpr bool ask_fits = asks_rightly<Wide>(), finish_fits = finishes_rightly<Wide>();
  static constexpr bool is_served = steps_somehow || asks_somehow;
  // Where both serve a node, asks() chooses; else step were never called.
  static constexpr bool is_decided = !(steps_somehow && asks_somehow) || names_asks<Law>;
};
template <class Law>
constexpr bool all_nodes(auto is_right) {
  bool right = true;
  if constexpr (serves_transverse<Law>) {
    right = right && is_right(calls<Law, node_on<Law, vector, transverse>>{});
    if constexpr (needs_no_tangents<Law>)
      right = right && is_right(calls<Law, node_on<Law, projected, transverse>>{});
  }
  if constexpr (serves_full<Law>) right = right && is_right(calls<Law, node_on<Law, vector, full>>{});
  if constexpr (serves_spins<Law>) {
    right = right && is_right(calls<Law, node_on<Law, vector, transverse_spin>>{});
    if constexpr (needs_no_tangents<Law>)
      right = right && is_right(calls<Law, node_on<Law, projected, transverse_spin>>{});
  }
  return right;
}
template <class Law>
constexpr bool any_node(auto is_so) {
  return !all_nodes<Law>([is_so](auto call) { return !is_so(call); });
}

template <class Law>
constexpr bool has_whole_solver() {
  constexpr int parts = names_problem<Law> + names_answer<Law> + names_ask<Law> + names_solve<Law> +
                        names_solve_scalar<Law> + names_finish<Law>;
  return parts == 0 || parts == 6;
}
template <class Law>
constexpr bool problems_are_of_V() {
  if constexpr (names_ask<Law>) {
    using narrow = law_on_t<Law, pack>;
    using two = law_on_t<Law, pack_of<2>>;
    return all_of_V<typename narrow::problem, typename two::problem> &&
           all_of_V<typename narrow::answer, typename two::answer>;
  }
  return true;
}
// Either may take what prepare gave as well.
template <class Law>
constexpr bool solves_rightly() {
  if constexpr (names_ask<Law>) {
    using two = law_on_t<Law, pack_of<2>>;
    using lanes = mask_of<pack_of<2>>;
    constexpr bool solves_packs =
        requires(const two& law, const typename two::problem& p, typename two::answer& a) {
      { law.solve(p, a) } -> std::same_as<lanes>;
    }
    || requires(const two& law, const typename two::problem& p, typename two::answer& a,
                const prepared_t<two>& own) {
      { law.solve(p, a, own) } -> std::same_as<lanes>;
    };
    constexpr bool solves_one =
        requires(const Law& law, const typename Law::problem& p, typename Law::answer& a) {
      law.solve_scalar(p, a);
    }
    || requires(const Law& law, const typename Law::problem& p, typename Law::answer& a,
                const prepared_t<Law>& own) {
      law.solve_scalar(p, a, own);
    };
    return solves_packs && solves_one;
  }
  return true;
}

template <class Law>
inline constexpr bool limits_step_rightly =
    !names_stable_velocity_step<Law> ||
    kernel<Law, pack, double, local_frame, transverse>::steps::by_delassus || any_node<Law>([](auto call) {
      using W = typename decltype(call)::Wide;
      return requires(const W& law, const typename decltype(call)::node_type& n) {
        law.stable_velocity_step(n);
      };
    });
template <class Law>
concept has_window_rightly = requires(const Law& law) {
  { law.window().duration } -> std::convertible_to<double>;
  { Law::adds_to_window(ilaw_status{}) } -> std::same_as<bool>;
  { Law::clears_window(ilaw_status{}) } -> std::same_as<bool>;
};
template <class Law>
constexpr bool has_history_rightly() {
  if constexpr (has_history<Law>)
    return has_window_rightly<Law>;
  else
    return !(names_window<Law> || names_adds_to_window<Law> || names_clears_window<Law>);
}
template <class Law>
constexpr bool has_amounts_rightly() {
  if constexpr (names_amounts<Law>)
    return std::is_same_v<std::remove_cvref_t<decltype(Law::amounts[0])>, amount_card> &&
           amount_count<Law> <= most_amounts;
  return true;
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
  ILAW_KIT_CHECK(all_parameters<Law>([](const auto& p) { return p.member.is_given() && p.name; }),
                 "a parameter needs .member = &Law::name and .name = \"name\"")
  ILAW_KIT_CHECK(members_differ<Wide>(), "two parameters have the same .member: each needs one of its own")
  ILAW_KIT_CHECK(sizeof(Law) == sizeof(double) * std::size(Law::parameters),
                 "a law's members are its parameters, V, double or grid: each needs an entry of parameters[]")
  ILAW_KIT_CHECK(parameter_count<Law> <= most_parameters, "a law has at most 32 parameters")
  ILAW_KIT_CHECK(all_parameters<Wide>(
                     [](const auto& p) { return !(p.choices.count > 0 || p.whole) || !p.member.may_vary(); }),
                 "a choice or whole number is the same at all nodes: its member is a double, not a V")
  ILAW_KIT_CHECK(all_parameters<Wide>([](const auto& p) { return !p.is_field || p.member.may_vary(); }),
                 "a field differs from node to node: its member is a V")
  ILAW_KIT_CHECK(axes_are_known<Law>(),
                 "a table is over \"time\" or a field, a parameter with .is_field = true")
  ILAW_KIT_CHECK(state_is_of_V<Law>(),
                 "the members of struct state must be V, vector<V> or tangential_vector<V>")
  ILAW_KIT_CHECK(state_is_given<Law>(), "a state variable needs .member = &state::name and .name = \"name\"")
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
  ILAW_KIT_CHECK(state_is_apart<Law>(),
                 "two state variables have the same .member: each needs one of its own")
  ILAW_KIT_CHECK(all_nodes<Law>([](auto call) { return call.is_served; }),
                 "no step or ask takes the nodes of a form of H that .delassus_forms of the card names")
  ILAW_KIT_CHECK(all_nodes<Law>([](auto call) { return !call.steps_somehow || call.steps; }),
                 "step must be template <class Node> status_of<V> step(Node& node) const")
  ILAW_KIT_CHECK(all_nodes<Law>([](auto call) { return call.ask_fits; }),
                 "ask must be template <class Node> asked<V> ask(Node& node, problem& open) const")
  ILAW_KIT_CHECK(
      all_nodes<Law>([](auto call) { return call.finish_fits; }),
      "finish must be template <class Node> status_of<V> finish(Node& node, const answer& a) const")
  ILAW_KIT_CHECK(!serves_spins<Law> || (reads<Law>(reads_v_previous) && !has_history<Law> &&
                                        (Law::card.dimensions & ILAW_DIMENSION_3)),
                 "a law with_spins serves dimension 3, reads_v_previous, and has no history")
  ILAW_KIT_CHECK(all_nodes<Law>([](auto call) { return call.is_decided; }),
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
