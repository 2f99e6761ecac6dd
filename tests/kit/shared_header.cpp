// A law outside any namespace, with a header outside any namespace: r = -c v where closed, c by way of that
// header.
#include "shared_header.hpp"

#include <ilaw/kit.hpp>

template <class V>
struct shared_header {
  V viscosity;

  static constexpr ilaw::kit::law_card card{.id = "shared_header",
                                            .title = "Viscous contact",
                                            .doc = "r = -c v where closed.",
                                            .inputs = ILAW_INPUT_GAP,
                                            .capabilities = ILAW_CAN_ADHERE};
  static constexpr const char* references[] = {"none"};
  static constexpr ilaw::kit::parameter<shared_header> parameters[] = {{.member = &shared_header::viscosity,
                                                                        .name = "viscosity",
                                                                        .unit = "N.s/m",
                                                                        .doc = "c",
                                                                        .default_value = 1.0}};

  template <class Node>
  ilaw::kit::status_of<V> step(Node& n) const {
    const double once = shared_twice(1.0) + 0.0 * shared_series{0.5}.sum(1.0);
    const V c = zero_unless(n.gap <= 0.0, once * viscosity);
    n.impulse = (-c / (1.0 + c * n.delassus.normal())) * n.v_free;
    return select(c > 0.0, ilaw::kit::status::closed, ilaw::kit::status::free);
  }
};

ILAW_PLUGIN("shared_header", "1.0.0", "tests", "BSD-3-Clause", shared_header)
