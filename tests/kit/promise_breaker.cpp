// A law that breaks what its card promises, as its parameter says. No H but a scalar one is compiled for it.
#include <ilaw/kit.hpp>

namespace {

using namespace ilaw::kit;

constexpr const char* breaks_choices[] = {"none", "status", "half_status", "number", "pull", "far"};

struct promise_breaker {
  double breaks;

  static constexpr law_card card{.id = "promise_breaker",
                                 .title = "A push that breaks a promise",
                                 .doc = "r_N = 1 where the gap is closed, but for what it breaks.",
                                 .delassus_forms = ILAW_DELASSUS_SCALAR};
  static constexpr const char* references[] = {"none"};
  static constexpr parameter<promise_breaker> parameters[] = {{.member = &promise_breaker::breaks,
                                                               .name = "breaks",
                                                               .doc = "Which promise.",
                                                               .choices = breaks_choices,
                                                               .choice_count = 6}};
  template <class Node>
  void step(Node& node) const {
    static_assert(has_transverse_delassus<Node>, "what the card does not serve is not compiled");
    constexpr double gives[] = {1.0, 1.0, 1.0, std::numeric_limits<double>::quiet_NaN(), -1.0, 1.0};
    const bool closed = node.gap <= 0.0;
    const double given = gives[static_cast<int>(breaks)];
    node.impulse.n = closed || breaks == 5.0 ? given : 0.0;
    node.status = closed ? status::closed : status::free;
    if (closed && breaks == 1.0) node.status = 42.0;
    if (closed && breaks == 2.0) node.status = 1.5;
  }
};

}  // namespace

ILAW_PLUGIN("promise_breaker", "1.0.0", "tests", "BSD-3-Clause", promise_breaker)
