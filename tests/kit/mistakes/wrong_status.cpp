// A step that returns a status in some branches alone, which compilers see as they make code.
#include <ilaw/kit.hpp>

using namespace ilaw::kit;

template <class V>
// control reaches end of non-void function
struct status_in_some_branches {
  V a;
  static constexpr law_card card{
      .id = "wrong", .title = "A law", .doc = "A mistake.", .delassus_forms = ILAW_DELASSUS_SCALAR};
  static constexpr const char* references[] = {"none"};
  static constexpr parameter<status_in_some_branches> parameters[] = {
      {.member = &status_in_some_branches::a, .name = "a"}};
  template <class Node>
  status_of<V> step(Node& node) const {
    node.impulse.n = a;
    if (node.wants_energy) return status::closed;
  }
};

ILAW_PLUGIN("wrong", "1.0.0", "tests", "BSD-3-Clause", status_in_some_branches)
