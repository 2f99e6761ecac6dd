// A law outside any namespace, with a header outside any namespace: r = -c v where closed, c by way of that
// header.
#include "shared_header.hpp"

#include <ilaw/kit.hpp>

struct shared_header {
  double viscosity;

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
  void step(Node& n) const {
    const double c = n.gap <= 0.0 ? shared_twice(viscosity) + 0.0 * shared_series{0.5}.sum(viscosity) : 0.0;
    n.impulse = (-c / (1.0 + c * n.delassus.normal())) * n.v_free;
    n.status = c > 0.0 ? ilaw::kit::status::closed : ilaw::kit::status::free;
  }
};

ILAW_PLUGIN("shared_header", "1.0.0", "tests", "BSD-3-Clause", shared_header)
