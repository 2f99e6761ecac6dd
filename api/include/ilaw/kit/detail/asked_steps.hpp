// asked_steps.hpp - the steps of a block for laws in pack form, in two phases. Phase one asks every node
// whether a problem is left that has no closed form; those are gathered into full packs and solved, and one
// more loop gives the answers to their nodes. So nodes without a problem cost what they cost in any other
// law, and no lane waits for a node that has nothing to do.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit/detail/one_step.hpp>
#include <ilaw/kit/pack.hpp>

namespace ilaw::kit::inline ILAW_KIT_LEVEL::detail {

template <class Struct>
inline constexpr int doubles_in = static_cast<int>(sizeof(Struct) / sizeof(double));

// Columns behind each other in one array, so that a pack may be read from any node on.
template <int Count>
struct alignas(64) column_row {
  double values[Count * block_size + pack_size];

  double* operator[](int k) { return values + k * block_size; }
  const double* operator[](int k) const { return values + k * block_size; }
};

// Stands for V, with a size that no other member has.
struct any_v {
  double numbers[3];
  friend bool operator<(const any_v&, const any_v&);  // as mask_of wants it
};
template <class Form>
inline constexpr bool are_of_v = sizeof(typename Form::template problem<any_v>) ==
                                     3 * sizeof(problem_of_form<Form>) &&
                                 sizeof(typename Form::template answer<any_v>) ==
                                     3 * sizeof(answer_of_form<Form>);

// The problems of a block, and their answers; open: 1 where there is one, else 0.
template <class Form>
struct asked_block {
  static_assert(are_of_v<Form>, "the members of problem and answer must all be of type V");
  static constexpr int problems = doubles_in<problem_of_form<Form>>,
                       answers = doubles_in<answer_of_form<Form>>;
  column open;
  column_row<problems> problem;
  column_row<answers> answer;
  int nodes[block_size + pack_size];  // those with a problem, and room to fill up the last pack
};

template <class Struct, class Columns, std::size_t... K>
void to_columns(const Struct& values, Columns& columns, int i, std::index_sequence<K...>) {
  const auto doubles = std::bit_cast<std::array<double, sizeof...(K)>>(values);
  ((columns[static_cast<int>(K)][i] = doubles[K]), ...);
}
template <class Struct, class Columns, std::size_t... K>
Struct from_columns(const Columns& columns, int i, std::index_sequence<K...>) {
  return std::bit_cast<Struct>(std::array<double, sizeof...(K)>{columns[static_cast<int>(K)][i]...});
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
  asked.open.values[i] = ask_node<Law, Delassus, Frame, Layout, Scope>(laws, b, i, problem) ? 1.0 : 0.0;
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
[[gnu::noinline, gnu::flatten]] void keep_problems(const Laws& laws, const node_block<Law>& b, span nodes,
                                                   asked_block<typename Laws::form>& asked) {
  const Laws l = laws;
  const node_block<Law> own = b;
#pragma omp simd
  for (int i = nodes.first; i < nodes.end; ++i)
    keep_problem<Law, Delassus, Frame, Layout, Scope>(l, own, asked, i);
}

// Pack k of a struct of packs: copies of the whole struct would cost as much as solving it.
template <class Packs>
char* place_of(Packs& packs, int k) {
  return reinterpret_cast<char*>(&packs) + static_cast<std::size_t>(k) * sizeof(pack);
}

// Lane by lane: what goes through memory one by one is not there yet where it is read as a whole.
template <int... K>
lanes listed_lanes(const double* column, const int* nodes, std::integer_sequence<int, K...> /*lanes*/) {
  return lanes{column[nodes[K]]...};
}

// The nodes whose problems make a pack. The last pack of a block is filled up with its first problem.
struct nodes_of_pack {
  const int* nodes;
  int filled;
  bool side_by_side;

  nodes_of_pack(int* listed, int left) : nodes(listed), filled(left < pack_size ? left : pack_size) {
    side_by_side = nodes[filled - 1] == nodes[0] + filled - 1;
    for (int j = filled; j < pack_size; ++j) listed[j] = listed[0];
  }
  mask own_lanes() const {
    alignas(64) double lane[pack_size];
    for (int j = 0; j < pack_size; ++j) lane[j] = j;
    return pack::load(lane) < pack(filled);
  }
  // From a column to a pack's place, and back.
  void read(const double* column, char* place) const {
    if (side_by_side) {
      __builtin_memcpy(place, column + nodes[0], sizeof(pack));
      if (filled == pack_size) return;
      const pack own = select(own_lanes(), pack::load(column + nodes[0]), column[nodes[0]]);
      __builtin_memcpy(place, &own, sizeof own);
    } else {
      for (int k = 0; k < pack_registers; ++k) {
        const lanes part = listed_lanes(column, nodes + k * register_size, each_lane);
        __builtin_memcpy(place + k * static_cast<int>(sizeof part), &part, sizeof part);
      }
    }
  }
  void write(const char* place, double* column) const {
    constexpr int one = sizeof(double);
    if (side_by_side && filled == pack_size)
      __builtin_memcpy(column + nodes[0], place, sizeof(pack));
    else
      for (int j = 0; j < filled; ++j) __builtin_memcpy(column + nodes[j], place + j * one, one);
  }
};

// Number by number: of all at once compilers make a loop over bytes, which takes long to begin.
template <class Struct>
void clear(Struct& packs) {
  for (int k = 0; k < static_cast<int>(sizeof packs / sizeof(pack)); ++k)
    __builtin_memset(place_of(packs, k), 0, sizeof(pack));
}

// Solves the problems of a block in packs. Returns how many were left to be solved alone.
template <class Form>
[[gnu::noinline, gnu::flatten]] int solve_asked(const Form& law, asked_block<Form>& asked, int count) {
  using problem_type = typename Form::template problem<pack>;
  using answer_type = typename Form::template answer<pack>;
  int alone_count = 0;
  for (int first = 0; first < count; first += pack_size) {
    const nodes_of_pack in_pack(asked.nodes + first, count - first);
    problem_type problem;
    for (int k = 0; k < asked_block<Form>::problems; ++k)
      in_pack.read(asked.problem[k], place_of(problem, k));
    answer_type answer;
    clear(answer);
    const mask left = law.solve(problem, answer);
    for (int k = 0; k < asked_block<Form>::answers; ++k) in_pack.write(place_of(answer, k), asked.answer[k]);
    for (int j = 0; any(left) && j < in_pack.filled; ++j) {
      if (!left[j]) continue;
      ++alone_count;
      const int node = in_pack.nodes[j];
      answer_of_form<Form> alone{};
      law.solve_alone(from_columns<problem_of_form<Form>>(asked.problem, node, places<problem_of_form<Form>>),
                      alone);
      to_columns(alone, asked.answer, node, places<answer_of_form<Form>>);
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

template <class Law, class Delassus, class Frame, class Layout, scope Scope, class Laws>
[[gnu::noinline, gnu::flatten]] void finish_nodes(const Laws& laws, const node_block<Law>& b, span nodes,
                                                  const asked_block<typename Laws::form>& asked) {
  const Laws l = laws;
  const auto run = [&l, &asked](const node_block<Law>& own, int i) {
    const auto& law = l.at(i);
    const auto step = [&law, &asked, i](auto& node) { step_answered<Law>(law, asked, i, node); };
    run_node<Law, Delassus, Frame, Layout, Scope>(law, own, i, step, l.is_valid(i));
  };
  over_nodes<Law, typename Laws::form>(b, nodes, run);
}

// Whether a form's asks() changes no state, so that a block may be asked twice from where it is.
template <class Form>
concept asks_leave_state = Form::asks_leave_state;

// All nodes as if none had a problem, and who has one.
template <class Law, class Delassus, class Frame, class Layout, scope Scope, class Laws>
[[gnu::noinline, gnu::flatten]] void ask_block(const Laws& laws, const node_block<Law>& b, column& open,
                                               kept_state<Law, Layout>& before) {
  using form = typename Laws::form;
  const Laws l = laws;
  const auto run = [&](const node_block<Law>& own, int i) {
    const auto& law = l.at(i);
    const auto step = [&, i](auto& node) {
      problem_of_form<form> problem{};
      if constexpr (!asks_leave_state<form>) before.keep(i, node.state);
      open.values[i] = law.asks(node, problem) ? 1.0 : 0.0;
    };
    run_node<Law, Delassus, Frame, Layout, Scope>(law, own, i, step, l.is_valid(i));
  };
  over_nodes<Law, form>(b, run);
}

// The problems of a block; returns how many there are, and lists their nodes.
template <class Form>
int list_open(asked_block<Form>& asked, int nodes) {
  constexpr int some = 8;  // most often none of them has one
  const auto bits = [&asked](int i) { return std::bit_cast<std::uint64_t>(asked.open.values[i]); };
  int count = 0;
  for (int first = 0; first < nodes; first += some) {
    const int end = first + some < nodes ? first + some : nodes;
    std::uint64_t found = 0;
    for (int i = first; i < end; ++i) found |= bits(i);
    for (int i = first; found != 0 && i < end; ++i) {
      asked.nodes[count] = i;
      count += bits(i) != 0 ? 1 : 0;
    }
  }
  return count;
}
template <class Form>
span open_nodes(const asked_block<Form>& asked, int count) {
  return {asked.nodes[0], asked.nodes[count - 1] + 1};
}

// Whether so many of a block have a problem that those after it are asked at once for all of theirs.
inline bool are_many(span open, int nodes) {
  constexpr int few = 4;  // one in so many
  return few * (open.end - open.first) > nodes;
}

// First as if no node had a problem, which is all where none has; then from the first to the last that have
// one. Where those are many, the blocks after this one are not stepped so.
template <class Law, class Delassus, class Frame, class Layout, scope Scope, class Laws>
int run_where_few_ask(const Laws& laws, const node_block<Law>& b, asked_block<typename Laws::form>& asked) {
  kept_state<Law, Layout> before;
  ask_block<Law, Delassus, Frame, Layout, Scope>(laws, b, asked.open, before);
  const int count = list_open(asked, b.count);
  if (count == 0) return 0;
  const span open = open_nodes(asked, count);
  if (are_many(open, b.count)) b.in_full->left = alike;
  if constexpr (!asks_leave_state<typename Laws::form>) before.put_back(b, open);
  keep_problems<Law, Delassus, Frame, Layout, reading<Scope>>(laws, b, open, asked);
  const int alone_count = solve_asked(laws.law, asked, count);
  finish_nodes<Law, Delassus, Frame, Layout, Scope>(laws, b, open, asked);
  return alone_count;
}

// Lists the problems of a block and keeps them; returns how many there are. Asked twice, once who has one and
// once which, where they are few.
template <class Law, class Delassus, class Frame, class Layout, scope Scope, class Laws>
int list_problems(const Laws& laws, const node_block<Law>& b, asked_block<typename Laws::form>& asked) {
  if (b.in_full->left > 0) {
    --b.in_full->left;
    keep_problems<Law, Delassus, Frame, Layout, Scope>(laws, b, {0, b.count}, asked);
    return list_open(asked, b.count);
  }
  mark_block<Law, Delassus, Frame, Layout, Scope>(laws, b, asked);
  const int count = list_open(asked, b.count);
  if (count == 0) return 0;
  const span open = open_nodes(asked, count);
  if (are_many(open, b.count)) b.in_full->left = alike;
  keep_problems<Law, Delassus, Frame, Layout, Scope>(laws, b, open, asked);
  return count;
}

template <class Law, class Delassus, class Frame, class Layout, scope Scope, class Laws>
int run_asked(const Laws& laws, const node_block<Law>& b) {
  using form = typename Laws::form;
  asked_block<form> asked;
  if constexpr (!answers_every_node<form> && !remembers<Law, form>) {
    if (b.in_full->left == 0) return run_where_few_ask<Law, Delassus, Frame, Layout, Scope>(laws, b, asked);
  } else {
    for (int k = 0; k < asked_block<form>::answers; ++k)
      for (int i = 0; i < b.count; ++i) asked.answer[k][i] = 0.0;
  }
  const int count = list_problems<Law, Delassus, Frame, Layout, reading<Scope>>(laws, b, asked);
  const int alone_count = solve_asked(laws.law, asked, count);
  finish_nodes<Law, Delassus, Frame, Layout, Scope>(laws, b, {0, b.count}, asked);
  return alone_count;
}

}  // namespace ilaw::kit::detail
