// one_step.hpp - what the loops over the steps of a block share: a step of one node, the law at a node, and
// the loop itself.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit/detail/kernel.hpp>

namespace ilaw::kit::inline ILAW_KIT_LEVEL::detail {

// Calls run with the form of a law that its parameters ask for: a struct with a shorter step.
template <class Law, class Run>
void in_its_form(const Law& law, Run run) {
  if constexpr (requires { law.in_form(run); })
    law.in_form(run);
  else
    run(law);
}

template <class Form>
using problem_of_form = typename Form::template problem<double>;
template <class Form>
using answer_of_form = typename Form::template answer<double>;

// Whether a form of a law is in pack form for nodes of this kind.
template <class Form, class Node>
concept asks_first = requires(const Form& law, Node& node, problem_of_form<Form>& problem) {
  law.asks(node, problem);
};

inline void choose(double& a, double b, bool second) { a = second ? b : a; }
inline void choose(vector& a, vector b, bool second) {
  choose(a.n, b.n, second);
  choose(a.t1, b.t1, second);
  choose(a.t2, b.t2, second);
}
inline void choose(projected_vector& a, projected_vector b, bool second) {
  choose(a.n, b.n, second);
  choose(a.x, b.x, second);
  choose(a.y, b.y, second);
  choose(a.z, b.z, second);
}

// What a step writes, number by number: a choice between structs is a branch, which does not vectorise.
template <class Node>
void choose(Node& a, const Node& b, bool second) {
  choose(a.impulse, b.impulse, second);
  choose(a.stored, b.stored, second);
  choose(a.normal_gain, b.normal_gain, second);
  choose(a.tangential_gain, b.tangential_gain, second);
  choose(a.rupture, b.rupture, second);
  choose(a.status, b.status, second);
  choose(a.refused, b.refused, second);
  using state = decltype(a.state);
  if constexpr (!std::is_same_v<state, stateless>) {
    using doubles = std::array<double, sizeof(state) / sizeof(double)>;
    auto x = std::bit_cast<doubles>(a.state);
    const auto y = std::bit_cast<doubles>(b.state);
    for (std::size_t k = 0; k < x.size(); ++k) choose(x[k], y[k], second);
    a.state = std::bit_cast<state>(x);
  }
}

// One node, with the same bits as in a pack.
template <class Form, class Node>
void step_alone(const Form& law, Node& node) {
  if constexpr (asks_first<Form, Node>) {
    Node solved = node;
    problem_of_form<Form> problem{};
    if (!law.asks(node, problem)) return;
    answer_of_form<Form> answer{};
    if (law.solve(problem, answer)) law.solve_alone(problem, answer);
    law.answered(solved, answer);
    choose(node, solved, true);
  } else {
    law.step(node);
  }
}
template <class Form>
auto stepping_alone(const Form& law) {
  return [&law](auto& node) { step_alone(law, node); };
}

// The law at the nodes of a block: the same at all of them, or law_per_node (node_parameters.hpp).
template <class Form>
struct one_law {
  using form = Form;
  Form law;
  const Form& at(int /*i*/) const { return law; }
  static constexpr bool is_valid(int /*i*/) { return true; }
};
template <class Laws>
inline constexpr bool is_one_law = std::is_same_v<Laws, one_law<typename Laws::form>>;

// Nodes of a block.
struct span {
  int first, end;
};

// Step: what is done at node i.
template <class Law, class Form, class Step>
void over_nodes(const node_block<Law>& b, span nodes, Step step) {
  if constexpr (remembers<Law, Form>) {
    for (int i = nodes.first; i < nodes.end; ++i) step(b, i);
  } else {
    const node_block<Law> own = b;
    const int at_once = own.ahead ? streams::nodes_at_once : block_size;
    for (int first = nodes.first, end; first < nodes.end; first = end) {
      if (own.ahead) own.ahead->ask(own.next + first);
      end = first + at_once < nodes.end ? first + at_once : nodes.end;
#pragma omp simd
      for (int i = first; i < end; ++i) step(own, i);
    }
  }
}
template <class Law, class Form, class Step>
void over_nodes(const node_block<Law>& b, Step step) {
  over_nodes<Law, Form>(b, {0, b.count}, step);
}

// Where a block had to be stepped in full, those after it are at once: neighbours are often alike.
inline constexpr int alike = 8;

// The states that a block came with, kept for a second step from the same beginning: by its first step, which
// has them at hand, and put back where they are worked on in place.
template <class Law, class Layout>
struct kept_state {
  column values[node_block<Law>::states + 1];

  void keep(int i, const state_t<Law>& state) {
    if constexpr (has_state<Law>) keep_all(i, state, every_double);
  }
  void put_back(const node_block<Law>& b, span nodes) const {
    if constexpr (has_state<Law>) put_all(b, nodes, every_double);
  }

 private:
  static constexpr auto every_double = std::make_index_sequence<state_doubles<Law>>{};

  template <std::size_t... K>
  void keep_all(int i, const state_t<Law>& state, std::index_sequence<K...> /*doubles*/) {
    const auto doubles = std::bit_cast<std::array<double, sizeof...(K)>>(state);
    ((values[K].values[i] = doubles[K]), ...);
  }
  template <std::size_t... K>
  void put_all(const node_block<Law>& b, span nodes, std::index_sequence<K...> /*doubles*/) const {
    for (int i = nodes.first; i < nodes.end; ++i)
      (put_state_number<Law, Layout, static_cast<int>(K)>(b.state_out, i, values[K].values[i]), ...);
  }
};

}  // namespace ilaw::kit::detail
