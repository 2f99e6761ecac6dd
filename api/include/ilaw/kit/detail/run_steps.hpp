// run_steps.hpp - the steps of a block of nodes: in one loop, for laws with a step for the usual case in that
// first, or, for laws in pack form, in two phases (asked_steps.hpp).
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit/detail/asked_steps.hpp>

namespace ilaw::kit::inline ILAW_KIT_LEVEL::detail {

// GCC vectorises these loops only where each stands alone. Copies, so that no store can alias a parameter or
// a time step.
template <class Law, class Delassus, class Frame, class Layout, scope Scope, class Laws>
[[gnu::noinline, gnu::flatten]] void step_block(const Laws& laws, const node_block<Law>& b) {
  const Laws l = laws;
  const auto run = [&l](const node_block<Law>& own, int i) {
    const auto& law = l.at(i);
    run_node<Law, Delassus, Frame, Layout, Scope>(law, own, i, stepping_alone(law), l.is_valid(i));
  };
  over_nodes<Law, typename Laws::form>(b, run);
}

// Whether a form of a law has a step for the usual case, which says of a node whether that was all. A block
// where it was not at every node is stepped in full; so the bits do not depend on which other nodes there
// are.
template <class Form, class Node>
concept tries_first = requires(const Form& law, Node& node) {
  { law.try_step(node) } -> std::same_as<bool>;
};

template <class Form, class Node>
constexpr bool tries_rightly() {
  if constexpr (requires(Form & law, Node & node) { law.try_step(node); }) return tries_first<Form, Node>;
  return true;
}

// Not where energies are asked, or tangents that the law does without: each is a loop more to compile.
template <class Law, class Frame, scope Scope>
inline constexpr bool is_worth_a_try = !is_for_old_processors && Scope < scope::outputs &&
                                       (!std::is_same_v<Frame, stored_frame> || Law::card.names_tangents);

// What is left of a block: 1 where the try was not all. Floats make GCC write two vectors of doubles at once
// for each operation, so that two chains of divisions and roots go on side by side; worth it where they are
// long, and where there are registers.
template <class Number>
struct alignas(64) left_nodes {
  Number values[block_size];
};
template <class Form>
inline constexpr bool takes_two_packs = register_size == 8 && requires {
  Form::takes_two_packs;
};
template <class Form>
using left_by = left_nodes<std::conditional_t<takes_two_packs<Form>, float, double>>;

template <class Law, class Delassus, class Frame, class Layout, scope Scope, class Laws>
[[gnu::noinline, gnu::flatten]] void try_block(const Laws& laws, const node_block<Law>& b,
                                               left_by<typename Laws::form>& left,
                                               kept_state<Law, Layout>& before) {
  const Laws l = laws;
  const auto run = [&l, &left, &before](const node_block<Law>& own, int i) {
    const auto& law = l.at(i);
    const auto step = [&law, &left, &before, i](auto& node) {
      before.keep(i, node.state);
      left.values[i] = law.try_step(node) ? 0.0 : 1.0;
    };
    run_node<Law, Delassus, Frame, Layout, Scope>(law, own, i, step, l.is_valid(i));
  };
  over_nodes<Law, typename Laws::form>(b, run);
}

// The try of the form that a form names for it, where the parameters allow that one.
template <class Law, class Delassus, class Frame, class Layout, scope Scope, class Laws>
void try_in_form(const Laws& laws, const node_block<Law>& b, left_by<typename Laws::form>& left,
                 kept_state<Law, Layout>& before) {
  using form = typename Laws::form;
  if constexpr (is_one_law<Laws> && requires { typename form::form_of_try; }) {
    if (laws.law.has_form_of_try()) {
      const one_law<typename form::form_of_try> shorter{{laws.law}};
      return try_block<Law, Delassus, Frame, Layout, Scope>(shorter, b, left, before);
    }
  }
  try_block<Law, Delassus, Frame, Layout, Scope>(laws, b, left, before);
}

// Where a block had to be stepped in full, the next one is at once, where the try after that fails the next
// two, and so on: neighbours are often alike.
template <class Law, class Delassus, class Frame, class Layout, scope Scope, class Laws>
void try_first(const Laws& laws, const node_block<Law>& b) {
  if (b.in_full->left > 0) {
    --b.in_full->left;
    return step_block<Law, Delassus, Frame, Layout, Scope>(laws, b);
  }
  left_by<typename Laws::form> left;
  kept_state<Law, Layout> before;
  try_in_form<Law, Delassus, Frame, Layout, Scope>(laws, b, left, before);
  if (!any_one(left.values, b.count)) {
    b.in_full->after_next = 1;
    return;
  }
  b.in_full->left = b.in_full->after_next;
  b.in_full->after_next = b.in_full->left < alike ? 2 * b.in_full->left : alike;
  before.put_back(b, {0, b.count});
  step_block<Law, Delassus, Frame, Layout, Scope>(laws, b);
}

// Whether a law leaves nodes out of reach alone whatever else they are, so that its step need not run, or
// those of them whose state rests.
template <class Law>
inline constexpr bool rests_by_state = requires(const state_t<Law>& state) {
  Law::rests(state);
};
template <class Law>
inline constexpr bool skips_out_of_reach = [] {
  if constexpr (requires { Law::skips_out_of_reach; }) {
    static_assert(!may_act_anywhere<Law>, "skips_out_of_reach is for laws without a state that act in reach");
    return Law::skips_out_of_reach;
  }
  return rests_by_state<Law>;
}();
template <class Law>
bool rests(const state_t<Law>& state) {
  if constexpr (rests_by_state<Law>) return Law::rests(state);
  return true;
}

// Whether the step need not run at a block of nodes out of reach. Not in axes where +0 may turn into -0.
template <class Law, class Frame, class Laws>
inline constexpr bool may_fly = !is_for_old_processors && is_one_law<Laws> && skips_out_of_reach<Law> &&
                                !std::is_same_v<Frame, stored_frame>;

// Whether no gap is closed. The first few most often tell where nodes touch, and the first state who is
// bonded.
template <class Layout>
bool are_open(const double* gap, const double* offset, int nodes) {
  std::uint64_t closed = 0;
  for (int i = 0; i < nodes; ++i) closed |= Layout::at(gap, i) - Layout::at(offset, i) > 0.0 ? 0U : 1U;
  return closed == 0;
}
template <class Layout, class Law>
bool may_be_in_flight(const node_block<Law>& b) {
  constexpr int first = 8;
  return b.count >= first && are_open<Layout>(b.gap, b.gap_offset, first) &&
         rests<Law>(incoming_state<Law, Layout>(b, 0)) && are_open<Layout>(b.gap, b.gap_offset, b.count);
}

// All nodes as if they were out of reach and at rest; reached: 1 where one is not, and is to be stepped.
template <class Law, class Delassus, class Frame, class Layout, scope Scope>
[[gnu::noinline, gnu::flatten]] void fly_block(const node_block<Law>& b, column& reached) {
  const auto run = [&reached](const node_block<Law>& own, int i) {
    const auto step = [&reached, i](auto& node) {
      const bool is_far = is_out_of_reach(node), is_at_rest = rests<Law>(node.state);
      reached.values[i] = (is_far & is_at_rest) ? 0.0 : 1.0;
      node.impulse = {};
      node.status = status::free;
    };
    run_node<Law, Delassus, Frame, Layout, Scope>(0, own, i, step);
  };
  over_nodes<Law, Law>(b, run);
}
template <class Law, class Delassus, class Frame, class Layout, scope Scope>
bool are_in_flight(const node_block<Law>& b) {
  if (!may_be_in_flight<Layout>(b)) return false;
  column reached;
  fly_block<Law, Delassus, Frame, Layout, Scope>(b, reached);
  return !any_one(reached.values, b.count);
}

// Returns how many nodes were solved one by one, as ilaw/ext/draft/profile.h counts them.
template <class Law, class Delassus, class Frame, class Layout, scope Scope, class Laws>
int run_steps(const Laws& laws, const node_block<Law>& b) {
  using form = typename Laws::form;
  static_assert(tries_rightly<form, node_in<Law, Delassus, Frame>>(),
                "try_step must be template <class Node> bool try_step(Node& node) const");
  if constexpr (may_fly<Law, Frame, Laws>)
    if (are_in_flight<Law, Delassus, Frame, Layout, Scope>(b)) return 0;
  if constexpr (asks_first<form, node_in<Law, Delassus, Frame>>) {
    return run_asked<Law, Delassus, Frame, Layout, Scope>(laws, b);
  } else {
    if constexpr (tries_first<form, node_in<Law, Delassus, Frame>> && is_worth_a_try<Law, Frame, Scope>)
      try_first<Law, Delassus, Frame, Layout, Scope>(laws, b);
    else
      step_block<Law, Delassus, Frame, Layout, Scope>(laws, b);
    return remembers<Law, form> ? b.count : 0;
  }
}

}  // namespace ilaw::kit::detail
