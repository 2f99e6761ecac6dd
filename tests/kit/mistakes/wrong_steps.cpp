// The same for mistakes within a function of a law, which compilers look at where there is no other. Never
// built: mistakes_test.cpp has its syntax checked, and reads the answer.
#include <ilaw/kit.hpp>

using namespace ilaw::kit;

// What all of them have, in two parts.
#define CARD                                                                                         \
  static constexpr law_card card{                                                                    \
      .id = "wrong", .title = "A law", .doc = "A mistake.", .delassus_forms = ILAW_DELASSUS_SCALAR}; \
  static constexpr const char* references[] = {"none"}
#define PARAMETER(law) \
  static constexpr parameter<law> parameters[] = {{.member = &law::a, .name = "a", .whole = true}}

// the law reads gap: write reads_gap among .inputs of its card
struct gap_not_declared {
  double a;
  static constexpr law_card card{.id = "wrong",
                                 .title = "A law",
                                 .doc = "A mistake.",
                                 .delassus_forms = ILAW_DELASSUS_SCALAR,
                                 .inputs = 0};
  static constexpr const char* references[] = {"none"};
  PARAMETER(gap_not_declared);
  template <class Node>
  void step(Node& node) const {
    node.impulse.n = node.gap;
  }
};

// the law reads area: write reads_area among .inputs of its card
struct area_not_declared {
  double a;
  CARD;
  PARAMETER(area_not_declared);
  template <class Node>
  void step(Node& node) const {
    node.impulse.n = node.area;
  }
};

// the law reads v_previous: write reads_v_previous among .inputs of its card
struct contact_without_v_previous {
  double a;
  CARD;
  PARAMETER(contact_without_v_previous);
  template <class Node>
  void step(Node& node) const {
    apply_plain_contact(node, node.v_free, a);
  }
};

// assignment of member 'ilaw::kit::vector::n' in read-only object
struct writes_v_free {
  double a;
  CARD;
  PARAMETER(writes_v_free);
  template <class Node>
  void step(Node& node) const {
    node.v_free.n = 0.0;
  }
};

// try_step must be template <class Node> bool try_step(Node& node) const
struct changes_as_it_tries {
  double a;
  CARD;
  PARAMETER(changes_as_it_tries);
  template <class Node>
  void step(Node& node) const {
    node.impulse.n = a;
  }
  template <class Node>
  bool try_step(Node& node) {
    node.impulse.n = a;
    return true;
  }
};

// the members of problem and answer must all be of type V
struct problem_with_a_number {
  double a;
  CARD;
  PARAMETER(problem_with_a_number);
  template <class V>
  struct problem {
    V x;
    double number;
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
  static mask_of<V> solve(const problem<V>& p, answer<V>& found) {
    found.y = p.x;
    return mask_of<V>(false);
  }
  static void solve_alone(const problem<double>&, answer<double>&) {}
  template <class Node>
  void answered(Node&, const answer<double>&) const {}
};

// The compiler looks at each.
#define SEEN(law) auto* const seen_##law = &detail::library_of<law>::describe
SEEN(gap_not_declared);
SEEN(area_not_declared);
SEEN(contact_without_v_previous);
SEEN(writes_v_free);
SEEN(changes_as_it_tries);
SEEN(problem_with_a_number);
