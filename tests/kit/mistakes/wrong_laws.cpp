// Laws with one mistake each, and what the compiler is to say of it: the comment above the law. Never built:
// mistakes_test.cpp has its syntax checked, and reads the answer.
#include <ilaw/kit.hpp>

using namespace ilaw::kit;

// What all of them have, in three parts.
#define CARD                                                                                         \
  static constexpr law_card card{                                                                    \
      .id = "wrong", .title = "A law", .doc = "A mistake.", .delassus_forms = ILAW_DELASSUS_SCALAR}; \
  static constexpr const char* references[] = {"none"}
#define PARAMETER(law) \
  static constexpr parameter<law> parameters[] = {{.member = &law::a, .name = "a", .whole = true}}
#define STEP            \
  template <class Node> \
  void step(Node&) const {}

// every member of struct state needs an entry of state_variables[]; members are double, vector or
// tangential_vector
struct larger_state {
  double a;
  CARD;
  PARAMETER(larger_state);
  STEP;
  struct state {
    double damage, forgotten;
  };
  static constexpr state_variable<state> state_variables[] = {{.member = &state::damage, .name = "damage"}};
};

// every member of struct state needs an entry of state_variables[]; members are double, vector or
// tangential_vector
struct state_with_int {
  double a;
  CARD;
  PARAMETER(state_with_int);
  STEP;
  struct state {
    double damage;
    int count;
  };
  static constexpr state_variable<state> state_variables[] = {{.member = &state::damage, .name = "damage"}};
};

// a member of struct state is a double, a vector or a tangential_vector
struct described_int {
  double a;
  CARD;
  PARAMETER(described_int);
  STEP;
  struct state {
    double damage;
    int count;
  };
  static constexpr state_variable<state> state_variables[] = {{.member = &state::damage, .name = "damage"},
                                                              {.member = &state::count, .name = "count"}};
};

// two state variables have the same .member: each needs one of its own
struct one_state_twice {
  double a;
  CARD;
  PARAMETER(one_state_twice);
  STEP;
  struct state {
    double damage, slip;
  };
  static constexpr state_variable<state> state_variables[] = {{.member = &state::damage, .name = "damage"},
                                                              {.member = &state::damage, .name = "slip"}};
};

// a state variable needs .member = &state::name and .name = "name"
struct state_without_member {
  double a;
  CARD;
  PARAMETER(state_without_member);
  STEP;
  struct state {
    double damage;
  };
  static constexpr state_variable<state> state_variables[] = {{.name = "damage"}};
};

// a memory is struct state and static constexpr state_variable<state> state_variables[]
struct state_without_description {
  double a;
  CARD;
  PARAMETER(state_without_description);
  STEP;
  struct state {
    double damage;
  };
};

// two parameters have the same .member: each needs one of its own
struct one_member_twice {
  double a, b;
  CARD;
  STEP;
  static constexpr parameter<one_member_twice> parameters[] = {{.member = &one_member_twice::a, .name = "a"},
                                                               {.member = &one_member_twice::a, .name = "b"}};
};

// a parameter needs .member = &Law::name and .name = "name"
struct parameter_without_member {
  double a;
  CARD;
  STEP;
  static constexpr parameter<parameter_without_member> parameters[] = {{.name = "a"}};
};

// a law's members are its parameters, all double: each needs an entry of parameters[]
struct member_without_parameter {
  double a, b;
  CARD;
  PARAMETER(member_without_parameter);
  STEP;
};

// the kit calls no 'initialize': write 'initialise'
struct initialize_for_initialise {
  double a;
  CARD;
  PARAMETER(initialize_for_initialise);
  STEP;
  template <class Node>
  void initialize(Node&) const {}
};

// the kit calls no 'capabilites': write 'capabilities'
struct capabilites_for_capabilities {
  double a;
  CARD;
  PARAMETER(capabilites_for_capabilities);
  STEP;
  std::uint32_t capabilites() const { return 0; }
};

// the kit calls no 'conflicts': write 'conflict'
struct conflicts_for_conflict {
  double a;
  CARD;
  PARAMETER(conflicts_for_conflict);
  STEP;
  const char* conflicts() const { return nullptr; }
};

// inputs must be std::uint32_t inputs() const
struct mutable_inputs {
  double a;
  CARD;
  PARAMETER(mutable_inputs);
  STEP;
  std::uint32_t inputs() { return reads_gap; }
};

// inputs must be std::uint32_t inputs() const
struct inputs_of_bool {
  double a;
  CARD;
  PARAMETER(inputs_of_bool);
  STEP;
  bool inputs() const { return true; }
};

// initialise must be template <class Node> void initialise(Node& node) const
struct mutable_initialise {
  double a;
  CARD;
  PARAMETER(mutable_initialise);
  STEP;
  template <class Node>
  void initialise(Node&) {}
};

// step must be const: template <class Node> void step(Node& node) const
struct mutable_step {
  double a;
  CARD;
  PARAMETER(mutable_step);
  template <class Node>
  void step(Node&) {}
};

// a law needs template <class Node> void step(Node& node) const
struct no_step {
  double a;
  CARD;
  PARAMETER(no_step);
};

// a history is static constexpr history_card history_variable, std::int64_t history_size() const and record
struct history_without_size {
  double a;
  CARD;
  PARAMETER(history_without_size);
  STEP;
  static constexpr history_card history_variable{.name = "past"};
  template <class Node>
  void record(const Node&, history) const {}
};

// record must be template <class Node> void record(const Node& node, history own) const; a window has static
// bool adds_to_window(double status) and clears_window(double status) in its place
struct window_that_is_never_emptied {
  double a;
  CARD;
  PARAMETER(window_that_is_never_emptied);
  STEP;
  static constexpr history_card history_variable{.name = "past"};
  std::int64_t history_size() const { return window::doubles(a, 4.0); }
  window_in_step window_in(step_interval step) const { return {a, 4.0, step}; }
  static bool adds_to_window(double) { return true; }
};

// solve and solve_alone must be static, and their problem carry the parameters: they may come per node
struct solve_with_a_parameter {
  double a;
  CARD;
  PARAMETER(solve_with_a_parameter);
  template <class V>
  struct problem {
    V x;
  };
  template <class V>
  struct answer {
    V y;
  };
  template <class Node>
  bool asks(Node&, problem<double>&) const {
    return true;
  }
  template <class V>
  mask_of<V> solve(const problem<V>& p, answer<V>& found) const {
    found.y = a * p.x;
    return mask_of<V>(false);
  }
  void solve_alone(const problem<double>&, answer<double>&) const {}
  template <class Node>
  void answered(Node&, const answer<double>&) const {}
};

// step must take its node by reference: template <class Node> void step(Node& node) const
struct step_of_a_copy {
  double a;
  CARD;
  PARAMETER(step_of_a_copy);
  template <class Node>
  void step(Node node) const {
    node.impulse.n = a;
  }
};

// a card that serves a diagonal H serves a full one, too: in the host's axes it is full
struct diagonal_alone {
  double a;
  static constexpr law_card card{
      .id = "wrong", .title = "A law", .doc = "A mistake.", .delassus_forms = ILAW_DELASSUS_DIAGONAL};
  static constexpr const char* references[] = {"none"};
  PARAMETER(diagonal_alone);
  STEP;
};

// What laws in pack form have, but for what asks and answers.
#define SOLVE                                                      \
  template <class V>                                               \
  struct problem {                                                 \
    V x;                                                           \
  };                                                               \
  template <class V>                                               \
  struct answer {                                                  \
    V y;                                                           \
  };                                                               \
  template <class V>                                               \
  static mask_of<V> solve(const problem<V>& p, answer<V>& found) { \
    found.y = p.x;                                                 \
    return mask_of<V>(false);                                      \
  }                                                                \
  static void solve_alone(const problem<double>&, answer<double>&) {}

// asks must be template <class Node> bool asks(Node& node, problem<double>& open) const
struct mutable_asks {
  double a;
  CARD;
  PARAMETER(mutable_asks);
  SOLVE
  template <class Node>
  bool asks(Node&, problem<double>&) {
    return true;
  }
  template <class Node>
  void answered(Node&, const answer<double>&) const {}
};

// answered must be template <class Node> void answered(Node& node, const answer<double>& a) const
struct mutable_answered {
  double a;
  CARD;
  PARAMETER(mutable_answered);
  SOLVE
  template <class Node>
  bool asks(Node&, problem<double>&) const {
    return true;
  }
  template <class Node>
  void answered(Node&, const answer<double>&) {}
};

// answered must be template <class Node> void answered(Node& node, const answer<double>& a) const
struct never_answered {
  double a;
  CARD;
  PARAMETER(never_answered);
  SOLVE
  template <class Node>
  bool asks(Node&, problem<double>&) const {
    return true;
  }
};

// The compiler looks at each.
#define SEEN(law) auto* const seen_##law = &detail::library_of<law>::describe
SEEN(larger_state);
SEEN(state_with_int);
SEEN(described_int);
SEEN(one_state_twice);
SEEN(state_without_member);
SEEN(state_without_description);
SEEN(one_member_twice);
SEEN(parameter_without_member);
SEEN(member_without_parameter);
SEEN(initialize_for_initialise);
SEEN(capabilites_for_capabilities);
SEEN(conflicts_for_conflict);
SEEN(mutable_inputs);
SEEN(inputs_of_bool);
SEEN(mutable_initialise);
SEEN(mutable_step);
SEEN(no_step);
SEEN(history_without_size);
SEEN(window_that_is_never_emptied);
SEEN(solve_with_a_parameter);
SEEN(step_of_a_copy);
SEEN(diagonal_alone);
SEEN(mutable_asks);
SEEN(mutable_answered);
SEEN(never_answered);
