// twin.cpp - the law of twin.c with the kit: r_N = mu where the gap is closed, unless it breaks a promise.
// SPDX-License-Identifier: BSD-3-Clause
#include <ilaw/kit.hpp>

namespace {

using namespace ilaw::kit;

constexpr const char* no_references[] = {"none"};
constexpr const char* axes[] = {"temperature", "pressure", "time"};
constexpr const char* pressure_and_time[] = {"pressure", "time"};
constexpr const char* choices[] = {"none",   "number", "state",      "large",
                                   "pull",   "far",    "nan_energy", "negative_energy",
                                   "amount", "status", "bad_status", "stable"};

template <class V>
struct twin {
  V pressure, friction, temperature, exponent;
  double count, breaks;

  static constexpr law_card card{.id = "twin",
                                 .title = "Push",
                                 .doc = "",
                                 .dimensions = ILAW_DIMENSION_3,
                                 .delassus_forms = ILAW_DELASSUS_SCALAR | ILAW_DELASSUS_TRANSVERSE,
                                 .inputs = reads_gap | reads_v_previous | reads_area,
                                 .permissions = may_skip_fresh};
  static constexpr auto& references = no_references;
  static constexpr parameter<twin> parameters[] = {
      {.member = &twin::pressure, .name = "pressure", .is_field = true},
      {.member = &twin::friction,
       .name = "friction",
       .required = true,
       .infinity_allowed = true,
       .axes = axes},
      {.member = &twin::temperature,
       .name = "temperature",
       .default_value = 300.0,
       .is_field = true,
       .axes = pressure_and_time},
      {.member = &twin::exponent,
       .name = "exponent",
       .default_value = 1.0,
       .minimum = 0.5,
       .maximum = 2.5,
       .minimum_excluded = true},
      {.member = &twin::count,
       .name = "count",
       .default_value = 1.0,
       .minimum = 1.0,
       .maximum = 4096.0,
       .whole = true},
      {.member = &twin::breaks, .name = "breaks", .choices = choices}};
  struct state {
    V steps;
  };
  static constexpr state_variable<state> state_variables[] = {{.member = &state::steps, .name = "steps"}};
  static constexpr amount_card amounts[] = {{.name = "wear", .unit = "m"}};

  template <class Node>
  status_of<V> step(Node& node) const {
    const auto closed = node.gap <= 0.0;
    node.impulse.n = zero_unless(closed | (breaks == 5.0), friction);
    node.state.steps = node.state.steps + zero_unless(closed, V(1.0));
    if (breaks == 1.0) node.impulse.n = V(not_a_number);
    if (breaks == 2.0) node.state.steps = V(not_a_number);
    if (breaks == 3.0) node.impulse.n = V(0.5 * std::numeric_limits<double>::max());
    if (breaks == 4.0) node.impulse.n = V(-1.0);
    return select(closed, status::closed, status::free);
  }
};

}  // namespace

ILAW_PLUGIN("twin_kit", "1.0.0", "tests", "BSD-3-Clause", twin)
