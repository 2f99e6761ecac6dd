// A law without a mistake, beside headers of the standard that have some names in common with the kit: the
// compiler says nothing. libm's exp and log give other bits on other processors, and do not take a V.
#include <ilaw/kit.hpp>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string>
#include <vector>

using namespace ilaw::kit;

template <class V>
struct right_law {
  V rate;
  double limit;

  static constexpr law_card card{.id = "right_law",
                                 .title = "A law",
                                 .doc = "Without a mistake.",
                                 .dimensions = ILAW_DIMENSION_2,
                                 .delassus_forms = ILAW_DELASSUS_SCALAR};
  static constexpr const char* references[] = {"none"};
  static constexpr parameter<right_law> parameters[] = {{.member = &right_law::rate, .name = "rate"},
                                                        {.member = &right_law::limit, .name = "limit"}};

  template <class Node>
  status_of<V> step(Node& node) const {
    const V speed = larger(absolute(node.v_free.n), length(node.v_free.t1, node.v_free.t2));
    const V part = power(square_root(speed), 1.5) + ilaw::kit::exp(-speed) + ilaw::kit::log(1.0 + speed);
    const V given = smaller(positive_part(part), rate);
    node.impulse.n = zero_unless((node.gap <= 0.0) & (given <= limit), given);
    return select(node.impulse.n > 0.0, status::closed, status::free);
  }
};

ILAW_PLUGIN("right_law", "1.0.0", "tests", "BSD-3-Clause", right_law)
