// run_steps.hpp - the steps of a block of nodes: in one loop, for laws with a step for the usual case in that
// first, or, for laws in pack form, in two phases. Phase one asks every node whether a problem is left that
// has no closed form; those are gathered into full packs and solved, and one more loop gives the answers to
// their nodes. So nodes without a problem cost what they cost in any other law, and no lane waits for a node
// that has nothing to do.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit/detail/kernel.hpp>
#include <ilaw/kit/pack.hpp>

namespace ilaw::kit::inline ILAW_KIT_LEVEL::detail {

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

// Step: what is done at node i.
template <class Law, class Form, class Step>
void over_nodes(const node_block<Law>& b, Step step) {
  if constexpr (remembers<Law, Form>) {
    for (int i = 0; i < b.count; ++i) step(b, i);
  } else {
    const node_block<Law> own = b;
    const int at_once = own.ahead ? streams::nodes_at_once : block_size;
    for (int first = 0, end; first < own.count; first = end) {
      if (own.ahead) own.ahead->ask(own.next + first);
      end = first + at_once < own.count ? first + at_once : own.count;
#pragma omp simd
      for (int i = first; i < end; ++i) step(own, i);
    }
  }
}

template <class Struct>
inline constexpr int doubles_in = static_cast<int>(sizeof(Struct) / sizeof(double));

// The problems of a block, and their answers, as columns; open: 1 where there is one, else 0.
template <class Form>
struct asked_block {
  static constexpr int problems = doubles_in<problem_of_form<Form>>,
                       answers = doubles_in<answer_of_form<Form>>;
  column open, problem[problems], answer[answers];
  int nodes[block_size + pack_size];  // those with a problem, and room to fill up the last pack
};

template <class Struct, std::size_t... K>
void to_columns(const Struct& values, column* columns, int i, std::index_sequence<K...>) {
  const auto doubles = std::bit_cast<std::array<double, sizeof...(K)>>(values);
  ((columns[K].values[i] = doubles[K]), ...);
}
template <class Struct, std::size_t... K>
Struct from_columns(const column* columns, int i, std::index_sequence<K...>) {
  return std::bit_cast<Struct>(std::array<double, sizeof...(K)>{columns[K].values[i]...});
}
template <class Struct>
inline constexpr auto places = std::make_index_sequence<static_cast<std::size_t>(doubles_in<Struct>)>{};

template <class Law, class Delassus, class Frame, class Layout, scope Scope, class Laws>
bool ask_node(const Laws& laws, const node_block<Law>& b, int i,
              problem_of_form<typename Laws::form>& problem) {
  auto node = load_node<Law, Delassus, Frame, Layout, Scope>(b, i);
  return laws.at(i).asks(node, problem);
}

template <class Law, class Delassus, class Frame, class Layout, scope Scope, class Laws>
void mark_node(const Laws& laws, const node_block<Law>& b, asked_block<typename Laws::form>& asked, int i) {
  problem_of_form<typename Laws::form> problem{};
  asked.open.values[i] = ask_node<Law, Delassus, Frame, Layout, Scope>(laws, b, i, problem) ? 1.0 : 0.0;
}

template <class Law, class Delassus, class Frame, class Layout, scope Scope, class Laws>
void keep_problem(const Laws& laws, const node_block<Law>& b, asked_block<typename Laws::form>& asked,
                  int i) {
  problem_of_form<typename Laws::form> problem{};
  ask_node<Law, Delassus, Frame, Layout, Scope>(laws, b, i, problem);
  to_columns(problem, asked.problem, i, places<problem_of_form<typename Laws::form>>);
}

// Who has a problem: of asks the compiler keeps what this needs, so that a block without any costs little.
// Structs that were declared in these loops themselves would be arrays of 64 in memory.
template <class Law, class Delassus, class Frame, class Layout, scope Scope, class Laws>
[[gnu::noinline, gnu::flatten]] void mark_block(const Laws& laws, const node_block<Law>& b,
                                                asked_block<typename Laws::form>& asked) {
  const Laws l = laws;
  const node_block<Law> own = b;
#pragma omp simd
  for (int i = 0; i < own.count; ++i) mark_node<Law, Delassus, Frame, Layout, Scope>(l, own, asked, i);
}

template <class Law, class Delassus, class Frame, class Layout, scope Scope, class Laws>
[[gnu::noinline, gnu::flatten]] void keep_problems(const Laws& laws, const node_block<Law>& b,
                                                   asked_block<typename Laws::form>& asked) {
  const Laws l = laws;
  const node_block<Law> own = b;
#pragma omp simd
  for (int i = 0; i < own.count; ++i) keep_problem<Law, Delassus, Frame, Layout, Scope>(l, own, asked, i);
}

// Pack k of a struct of packs: copies of the whole struct would cost as much as solving it.
template <class Packs>
char* place_of(Packs& packs, int k) {
  return reinterpret_cast<char*>(&packs) + static_cast<std::size_t>(k) * sizeof(pack);
}

// The numbers of a pack's nodes, which stand side by side or not.
inline void collect(const double* column, const int* nodes, bool side_by_side, char* pack_of_them) {
  double values[pack_size];
  if (!side_by_side)
    for (int j = 0; j < pack_size; ++j) values[j] = column[nodes[j]];
  __builtin_memcpy(pack_of_them, side_by_side ? column + nodes[0] : values, sizeof(pack));
}

// Solves the problems of a block in packs. The last pack is filled up with its first problem. Returns how
// many were left to be solved alone.
template <class Form>
[[gnu::noinline]] int solve_asked(const Form& law, asked_block<Form>& asked, int count) {
  using problem_type = typename Form::template problem<pack>;
  using answer_type = typename Form::template answer<pack>;
  int alone_count = 0;
  for (int first = 0; first < count; first += pack_size) {
    const int filled = count - first < pack_size ? count - first : pack_size;
    int* nodes = asked.nodes + first;
    for (int j = filled; j < pack_size; ++j) nodes[j] = nodes[0];
    const bool side_by_side = nodes[pack_size - 1] == nodes[0] + pack_size - 1;
    problem_type problem;
    for (int k = 0; k < asked_block<Form>::problems; ++k)
      collect(asked.problem[k].values, nodes, side_by_side, place_of(problem, k));
    answer_type answer{};
    const mask left = law.solve(problem, answer);
    for (int k = 0; k < asked_block<Form>::answers; ++k) {
      double values[pack_size];
      double* answers = asked.answer[k].values;
      __builtin_memcpy(side_by_side ? answers + nodes[0] : values, place_of(answer, k), sizeof(pack));
      for (int j = 0; !side_by_side && j < filled; ++j) answers[nodes[j]] = values[j];
    }
    for (int j = 0; any(left) && j < filled; ++j) {
      if (!left[j]) continue;
      ++alone_count;
      answer_of_form<Form> alone{};
      law.solve_alone(
          from_columns<problem_of_form<Form>>(asked.problem, nodes[j], places<problem_of_form<Form>>), alone);
      to_columns(alone, asked.answer, nodes[j], places<answer_of_form<Form>>);
    }
  }
  return alone_count;
}

// Whether a form's answered() is also what nodes without a problem need, from an answer of zeros.
template <class Form>
concept answers_every_node = Form::answers_every_node;

// A node whose problem, if it had one, is solved.
template <class Law, class Form, class Node>
void step_answered(const Form& law, const asked_block<Form>& asked, int i, Node& node) {
  const auto answer = from_columns<answer_of_form<Form>>(asked.answer, i, places<answer_of_form<Form>>);
  if constexpr (answers_every_node<Form>) {
    law.answered(node, answer);
  } else {
    problem_of_form<Form> problem{};
    Node solved = node;
    law.asks(node, problem);
    law.answered(solved, answer);
    choose(node, solved, asked.open.values[i] != 0.0);
  }
}

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

template <class Law, class Delassus, class Frame, class Layout, scope Scope, class Laws>
[[gnu::noinline, gnu::flatten]] void finish_block(const Laws& laws, const node_block<Law>& b,
                                                  const asked_block<typename Laws::form>& asked) {
  const Laws l = laws;
  const auto run = [&l, &asked](const node_block<Law>& own, int i) {
    const auto& law = l.at(i);
    const auto step = [&law, &asked, i](auto& node) { step_answered<Law>(law, asked, i, node); };
    run_node<Law, Delassus, Frame, Layout, Scope>(law, own, i, step, l.is_valid(i));
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

// A state that a block works on in place, kept for a second step from the same beginning.
template <class Law>
struct kept_state {
  column values[node_block<Law>::states + 1];

  void keep(node_block<Law>& b) {
    for (int k = 0; k < node_block<Law>::states; ++k) {
      if (b.state_in[k] != b.state_out[k]) continue;
      for (int i = 0; i < b.count; ++i) values[k].values[i] = b.state_in[k][i];
      b.state_in[k] = values[k].values;
    }
  }
};

template <class Law, class Delassus, class Frame, class Layout, scope Scope, class Laws>
[[gnu::noinline, gnu::flatten]] void try_block(const Laws& laws, const node_block<Law>& b, column& left) {
  const Laws l = laws;
  const auto run = [&l, &left](const node_block<Law>& own, int i) {
    const auto& law = l.at(i);
    const auto step = [&law, &left, i](auto& node) { left.values[i] = law.try_step(node) ? 0.0 : 1.0; };
    run_node<Law, Delassus, Frame, Layout, Scope>(law, own, i, step, l.is_valid(i));
  };
  over_nodes<Law, typename Laws::form>(b, run);
}

// Where a block had to be stepped in full, those after it are at once: neighbours are often alike.
template <class Law, class Delassus, class Frame, class Layout, scope Scope, class Laws>
void try_first(const Laws& laws, const node_block<Law>& b) {
  constexpr int alike = 8;
  if (*b.in_full > 0) {
    --*b.in_full;
    return step_block<Law, Delassus, Frame, Layout, Scope>(laws, b);
  }
  column left;
  node_block<Law> own = b;
  kept_state<Law> state;
  state.keep(own);
  try_block<Law, Delassus, Frame, Layout, Scope>(laws, own, left);
  std::uint64_t bits = 0;  // of 0.0 and 1.0
  for (int i = 0; i < b.count; ++i) bits |= std::bit_cast<std::uint64_t>(left.values[i]);
  if (bits == 0) return;
  *b.in_full = alike;
  step_block<Law, Delassus, Frame, Layout, Scope>(laws, own);
}

// Returns how many nodes were solved one by one, as ilaw/profile.h counts them.
template <class Law, class Delassus, class Frame, class Layout, scope Scope, class Laws>
int run_steps(const Laws& laws, const node_block<Law>& b) {
  using form = typename Laws::form;
  static_assert(tries_rightly<form, node_in<Law, Delassus, Frame>>(),
                "try_step must be template <class Node> bool try_step(Node& node) const");
  if constexpr (asks_first<form, node_in<Law, Delassus, Frame>>) {
    constexpr scope reads = reading<Scope>;
    asked_block<form> asked;
    for (column& c : asked.answer) c = zeros;
    mark_block<Law, Delassus, Frame, Layout, reads>(laws, b, asked);
    int count = 0;
    for (int i = 0; i < b.count; ++i) {
      asked.nodes[count] = i;
      count += asked.open.values[i] != 0.0 ? 1 : 0;
    }
    int alone_count = 0;
    if (count > 0) {
      keep_problems<Law, Delassus, Frame, Layout, reads>(laws, b, asked);
      alone_count = solve_asked(laws.law, asked, count);
    }
    finish_block<Law, Delassus, Frame, Layout, Scope>(laws, b, asked);
    return alone_count;
  } else {
    if constexpr (tries_first<form, node_in<Law, Delassus, Frame>> && is_worth_a_try<Law, Frame, Scope>)
      try_first<Law, Delassus, Frame, Layout, Scope>(laws, b);
    else
      step_block<Law, Delassus, Frame, Layout, Scope>(laws, b);
    return remembers<Law, form> ? b.count : 0;
  }
}

}  // namespace ilaw::kit::detail
