// A law with scalar and vector state and a history: it remembers the sum of its tangential impulses in its
// frame.
#include <ilaw/kit.hpp>

#include <cstring>

namespace {

using namespace ilaw::kit;

struct kit_probe {
  double viscosity;

  static constexpr law_card card{.id = "kit_probe",
                                 .title = "Viscous contact that counts and sums",
                                 .doc = "r = -c v where closed; remembers what it gave.",
                                 .inputs = reads_gap,
                                 .capabilities = ILAW_CAN_ADHERE | ILAW_CAN_ACT_AT_DISTANCE};
  static constexpr const char* references[] = {"none"};
  static constexpr parameter<kit_probe> parameters[] = {
      {.member = &kit_probe::viscosity, .name = "viscosity", .unit = "N.s/m", .doc = "c", .required = true}};
  // Described in another order than it has here: entries name their members.
  struct state {
    tangential_vector slip;
    double count;
    vector sum;
  };
  static constexpr state_variable<state> state_variables[] = {
      {.member = &state::count,
       .name = "count",
       .doc = "steps",
       .minimum = 0.0,
       .maximum = 1e6,
       .whole = true},
      {.member = &state::sum, .name = "sum", .unit = "N.s", .doc = "impulses"},
      {.member = &state::slip, .name = "slip", .unit = "m", .doc = "of closed steps"}};
  static constexpr history_card history_variable{.name = "last", .doc = "last two v_N", .internal = true};
  std::int64_t history_size() const { return 2; }
  static const void* extension(const char* name) {
    return std::strcmp(name, "tests.answer/1") == 0 ? &answer : nullptr;
  }
  static constexpr int answer = 42;

  // r = -c (v_free + H r), solved for r, plus a pull along the remembered sum so that memory matters.
  template <class Node>
  void step(Node& n) const {
    const double c = n.gap <= 0.0 ? viscosity : 0.0;
    const double h = n.delassus.normal();
    const double factor = -c / (1.0 + c * h);
    n.impulse = factor * n.v_free - 0.125 * vector{n.history[0], n.state.sum.t1, n.state.sum.t2} -
                0.25 * static_cast<vector>(n.state.slip);
    n.state.count += 1.0;
    n.state.sum = n.state.sum + n.impulse;
    const vector v = n.v_free + n.delassus.times(n.impulse);
    n.state.slip.t1 += c > 0.0 ? n.position_step * v.t1 : 0.0;
    n.state.slip.t2 += c > 0.0 ? n.position_step * v.t2 : 0.0;
    n.status = c > 0.0 ? status::closed : status::free;
  }
  template <class Node>
  void record(const Node& n, history own) const {
    own[1] = own[0];
    own[0] = n.v_free.n;
  }
};

}  // namespace

ILAW_PLUGIN("kit_probe", "1.0.0", "tests", "BSD-3-Clause", kit_probe)
