// Laws with one mistake each, and what the compiler is to say of it: the comment above the law. Never built:
// mistakes_test.py has its syntax checked, and reads the answer.
#include <ilaw/kit.hpp>

using namespace ilaw::kit;

// The part that all laws have, in three macros.
#define CARD                                                                                         \
  static constexpr law_card card{                                                                    \
      .id = "wrong", .title = "A law", .doc = "A mistake.", .delassus_forms = ILAW_DELASSUS_SCALAR}; \
  static constexpr const char* references[] = {"none"}
#define PARAMETER(law) static constexpr parameter<law> parameters[] = {{.member = &law::a, .name = "a"}}
#define STEP                           \
  template <class Node>                \
  status_of<V> step(Node& node) const { \
    node.impulse.n = a;                \
    return status::free;               \
  }
#define WRONG(law)      \
  template <class V>    \
  struct law {          \
    V a;                \
    CARD;               \
    PARAMETER(law);
// And what those with a solver have.
#define PROBLEM    \
  struct problem { \
    V x;           \
  };               \
  struct answer {  \
    V y;           \
  };
#define SOLVE                                                       \
  static mask_of<V> solve(const problem&, answer&) { return V{} < 0.0; } \
  static void solve_scalar(const problem&, answer&) {}
#define ASK                                            \
  template <class Node>                                \
  asked<V> ask(Node&, problem&) const {                \
    return {V{} < 0.0, status::free};                  \
  }
#define FINISH                                         \
  template <class Node>                                \
  status_of<V> finish(Node&, const answer&) const {    \
    return status::free;                               \
  }

// ---- memory

// every member of struct state needs an entry of state_variables[]
WRONG(larger_state)
  STEP
  struct state {
    V damage, forgotten;
  };
  static constexpr state_variable<state> state_variables[] = {{.member = &state::damage, .name = "damage"}};
};

// the members of struct state must be V, vector<V> or tangential_vector<V>
WRONG(state_with_int)
  STEP
  struct state {
    V damage;
    int count;
  };
  static constexpr state_variable<state> state_variables[] = {{.member = &state::damage, .name = "damage"}};
};

// the members of struct state must be V, vector<V> or tangential_vector<V>
WRONG(state_with_double)
  STEP
  struct state {
    V damage;
    double count;
  };
  static constexpr state_variable<state> state_variables[] = {{.member = &state::damage, .name = "damage"},
                                                              {.member = &state::count, .name = "count"}};
};

// the members of struct state must be V, vector<V> or tangential_vector<V>
WRONG(described_int)
  STEP
  struct state {
    V damage;
    int count;
  };
  static constexpr state_variable<state> state_variables[] = {{.member = &state::damage, .name = "damage"},
                                                              {.member = &state::count, .name = "count"}};
};

// two state variables have the same .member: each needs one of its own
WRONG(one_state_twice)
  STEP
  struct state {
    V damage, slip;
  };
  static constexpr state_variable<state> state_variables[] = {{.member = &state::damage, .name = "damage"},
                                                              {.member = &state::damage, .name = "slip"}};
};

// a state variable needs .member = &state::name and .name = "name"
WRONG(state_without_member)
  STEP
  struct state {
    V damage;
  };
  static constexpr state_variable<state> state_variables[] = {{.name = "damage"}};
};

// a memory is struct state and static constexpr state_variable<state> state_variables[]
WRONG(state_without_description)
  STEP
  struct state {
    V damage;
  };
};

// a history is static constexpr history_card history and window() const with static bool adds_to_window(ilaw_status) and clears_window(ilaw_status)
WRONG(history_without_size)
  STEP
  static constexpr history_card history{.name = "past"};
};

// a history is static constexpr history_card history and window() const with static bool adds_to_window(ilaw_status) and clears_window(ilaw_status)
WRONG(window_that_is_never_emptied)
  STEP
  static constexpr history_card history{.name = "past"};
  struct size {
    double duration, buckets;
  };
  size window() const { return {1.0, 4.0}; }
  static bool adds_to_window(ilaw_status) { return true; }
};

// ---- parameters

template <class V>
// two parameters have the same .member: each needs one of its own
struct one_member_twice {
  V a, b;
  CARD;
  STEP
  static constexpr parameter<one_member_twice> parameters[] = {{.member = &one_member_twice::a, .name = "a"},
                                                               {.member = &one_member_twice::a, .name = "b"}};
};

template <class V>
// a parameter needs .member = &Law::name and .name = "name"
struct parameter_without_member {
  V a;
  CARD;
  STEP
  static constexpr parameter<parameter_without_member> parameters[] = {{.name = "a"}};
};

template <class V>
// a law's members are its parameters, V, double or grid: each needs an entry of parameters[]
struct member_without_parameter {
  V a, b;
  CARD;
  PARAMETER(member_without_parameter);
  STEP
};

template <class V>
// a choice or whole number is the same at all nodes: its member is a double, not a V
struct choice_per_node {
  V a;
  CARD;
  STEP
  static constexpr const char* texts[] = {"yes", "no"};
  static constexpr parameter<choice_per_node> parameters[] = {
      {.member = &choice_per_node::a, .name = "a", .choices = texts}};
};

template <class V>
// a field differs from node to node: its member is a V
struct field_of_a_batch {
  double a;
  CARD;
  STEP
  static constexpr parameter<field_of_a_batch> parameters[] = {
      {.member = &field_of_a_batch::a, .name = "temperature", .is_field = true}};
};

// ---- names

// the kit calls no 'initialize': write 'initialise'
WRONG(initialize_for_initialise)
  STEP
  template <class Node>
  void initialize(Node&) const {}
};

// the kit calls no 'prepared': write 'prepare'
WRONG(prepared_for_prepare)
  STEP
  auto prepared(const step_sizes& s) const { return s.time; }
};

// the kit calls no 'is_isotropic': write .is_isotropic = true in the card
WRONG(option_beside_the_card)
  STEP
  static constexpr bool is_isotropic = false;
};

template <class V>
// 'const ilaw::kit::law_card' has no non-static data member named 'isotropic'
struct misspelt_option {
  V a;
  static constexpr law_card card{.id = "wrong", .title = "A law", .doc = "A mistake.", .isotropic = true};
  static constexpr const char* references[] = {"none"};
  PARAMETER(misspelt_option);
  STEP
};

// ---- functions

// inputs must be std::uint32_t inputs() const
WRONG(mutable_inputs)
  STEP
  std::uint32_t inputs() { return reads_gap; }
};

// inputs must be std::uint32_t inputs() const
WRONG(inputs_of_bool)
  STEP
  bool inputs() const { return true; }
};

// permissions must be std::uint32_t permissions() const
WRONG(permissions_beside_the_card)
  STEP
  static constexpr std::uint32_t permissions = may_skip_free;
};

// prepare must be auto prepare(const step_sizes& step) const
WRONG(prepares_without_steps)
  STEP
  double prepare() const { return 1.0; }
};

// initialise must be template <class Node> void initialise(Node& node) const
WRONG(mutable_initialise)
  STEP
  template <class Node>
  void initialise(Node&) {}
};

// stable_velocity_step must be template <class Node> V stable_velocity_step(const Node& node) const
WRONG(stable_step_of_nothing)
  STEP
  V stable_velocity_step() const { return a; }
};

// step must be template <class Node> status_of<V> step(Node& node) const
WRONG(mutable_step)
  template <class Node>
  status_of<V> step(Node&) {
    return status::free;
  }
};

// step must be template <class Node> status_of<V> step(Node& node) const
WRONG(step_of_a_copy)
  template <class Node>
  status_of<V> step(Node node) const {
    node.impulse.n = a;
    return status::free;
  }
};

// step must be template <class Node> status_of<V> step(Node& node) const
WRONG(step_without_status)
  template <class Node>
  void step(Node& node) const {
    node.impulse.n = a;
  }
};

// step must be template <class Node> status_of<V> step(Node& node) const
WRONG(status_that_is_a_number)
  template <class Node>
  V step(Node&) const {
    return 1.0;
  }
};

// a law needs template <class Node> status_of<V> step(Node& node) const
WRONG(no_step)
};

template <class V>
// a card that serves a diagonal H serves a full one, too: in the host's axes it is full
struct diagonal_alone {
  V a;
  static constexpr law_card card{
      .id = "wrong", .title = "A law", .doc = "A mistake.", .delassus_forms = ILAW_DELASSUS_DIAGONAL};
  static constexpr const char* references[] = {"none"};
  PARAMETER(diagonal_alone);
  STEP
};

template <class V>
// no step or ask takes the nodes of a form of H that .delassus_forms of the card names
struct full_unserved {
  V a;
  static constexpr law_card card{.id = "wrong", .title = "A law", .doc = "A mistake."};
  static constexpr const char* references[] = {"none"};
  PARAMETER(full_unserved);
  template <class Node>
  status_of<V> step(Node&) const
    requires is_transverse<Node>
  {
    return status::free;
  }
};

// ---- solvers

// solve must be mask_of<V> solve(const problem& p, answer& a) const, and solve_scalar the same without result; both may take what prepare gave as well
WRONG(mutable_solve)
  PROBLEM
  ASK
  FINISH
  mask_of<V> solve(const problem& p, answer& found) {
    found.y = a * p.x;
    return V{} < 0.0;
  }
  void solve_scalar(const problem&, answer&) const {}
};

// ask must be template <class Node> asked<V> ask(Node& node, problem& open) const
WRONG(mutable_ask)
  PROBLEM
  SOLVE
  FINISH
  template <class Node>
  asked<V> ask(Node&, problem&) {
    return {V{} < 0.0, status::free};
  }
};

// ask must be template <class Node> asked<V> ask(Node& node, problem& open) const
WRONG(ask_without_status)
  PROBLEM
  SOLVE
  FINISH
  template <class Node>
  mask_of<V> ask(Node&, problem&) const {
    return V{} < 0.0;
  }
};

// finish must be template <class Node> status_of<V> finish(Node& node, const answer& a) const
WRONG(mutable_finish)
  PROBLEM
  SOLVE
  ASK
  template <class Node>
  status_of<V> finish(Node&, const answer&) {
    return status::free;
  }
};

// a solver is problem, answer, ask, solve, solve_scalar and finish: one of them is missing
WRONG(never_finished)
  PROBLEM
  SOLVE
  ASK
};

template <class V>
// the members of problem and answer must all be of type V
struct problem_with_a_number {
  V a;
  CARD;
  PARAMETER(problem_with_a_number);
  struct problem {
    V x;
    double number;
  };
  struct answer {
    V y;
  };
  SOLVE
  ASK
  FINISH
};

// step and ask take the same nodes: bool asks() const says which parameters need ask
WRONG(undecided)
  STEP
  PROBLEM
  SOLVE
  ASK
  FINISH
};

// asks chooses between step and ask: the law has one of them alone
WRONG(asks_nothing)
  STEP
  bool asks() const { return true; }
};

// The compiler looks at each.
#define SEEN(law) auto* const seen_##law = &detail::library_of<law>::describe
SEEN(larger_state);
SEEN(state_with_int);
SEEN(state_with_double);
SEEN(described_int);
SEEN(one_state_twice);
SEEN(state_without_member);
SEEN(state_without_description);
SEEN(history_without_size);
SEEN(window_that_is_never_emptied);
SEEN(one_member_twice);
SEEN(parameter_without_member);
SEEN(member_without_parameter);
SEEN(choice_per_node);
SEEN(field_of_a_batch);
SEEN(initialize_for_initialise);
SEEN(prepared_for_prepare);
SEEN(option_beside_the_card);
SEEN(misspelt_option);
SEEN(mutable_inputs);
SEEN(inputs_of_bool);
SEEN(permissions_beside_the_card);
SEEN(prepares_without_steps);
SEEN(mutable_initialise);
SEEN(stable_step_of_nothing);
SEEN(mutable_step);
SEEN(step_of_a_copy);
SEEN(step_without_status);
SEEN(status_that_is_a_number);
SEEN(no_step);
SEEN(diagonal_alone);
SEEN(full_unserved);
SEEN(mutable_solve);
SEEN(mutable_ask);
SEEN(ask_without_status);
SEEN(mutable_finish);
SEEN(never_finished);
SEEN(problem_with_a_number);
SEEN(undecided);
SEEN(asks_nothing);
