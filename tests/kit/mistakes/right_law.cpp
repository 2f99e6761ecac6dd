// A law without a mistake, beside headers of the standard that have some names in common with the kit: the
// compiler says nothing. libm's exp and log give other bits on other processors; both being in sight, the
// kit's are named in full.
#include <ilaw/kit.hpp>
#include <ilaw/kit/window.hpp>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string>
#include <vector>

using namespace ilaw::kit;

struct right_law {
  double rate;

  static constexpr law_card card{.id = "right_law",
                                 .title = "A law",
                                 .doc = "Without a mistake.",
                                 .dimensions = ILAW_DIMENSION_2,
                                 .delassus_forms = ILAW_DELASSUS_SCALAR};
  static constexpr const char* references[] = {"none"};
  static constexpr parameter<right_law> parameters[] = {
      {.member = &right_law::rate, .name = "rate", .fixed = true}};

  template <class Node>
  void step(Node& node) const {
    const double speed = larger(absolute(node.v_free.n), length(node.v_free.t1, node.v_free.t2));
    const double part = power(square_root(speed), 1.5) + ilaw::kit::exp(-speed) + ilaw::kit::log(1.0 + speed);
    const double given = smaller(positive_part(part), rate);
    node.impulse.n = node.gap <= 0.0 && is_finite(given) ? select(given > 0.0, given, 0.0) : 0.0;
    node.status = node.impulse.n > 0.0 ? status::closed : status::free;
  }
};

ILAW_PLUGIN("right_law", "1.0.0", "tests", "BSD-3-Clause", right_law)
