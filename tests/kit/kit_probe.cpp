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
                                 .capabilities = ILAW_CAN_ACT_AT_DISTANCE};
  static constexpr const char* references[] = {"none"};
  static constexpr parameter<kit_probe> parameters[] = {
      {.member = &kit_probe::viscosity, .name = "viscosity", .unit = "N.s/m", .doc = "c", .required = true}};
  struct state {
    double count;
    double sum_n, sum_t1, sum_t2;
    double slip_1, slip_2;
  };
  static constexpr state_variable state_variables[] = {
      {.name = "count", .doc = "steps", .minimum = 0.0, .maximum = 1e6, .whole = true},
      {.name = "sum", .unit = "N.s", .doc = "impulses", .kind = ILAW_STATE_VECTOR},
      {.name = "slip", .unit = "m", .doc = "of closed steps", .kind = ILAW_STATE_TANGENTIAL}};
  static constexpr state_variable history_variable{
      .name = "last", .doc = "last two v_N", .kind = ILAW_STATE_HISTORY, .internal = true};
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
    n.impulse = factor * n.v_free - 0.125 * vector{n.history[0], n.state.sum_t1, n.state.sum_t2} -
                0.25 * vector{0.0, n.state.slip_1, n.state.slip_2};
    n.state.count += 1.0;
    n.state.sum_n += n.impulse.n;
    n.state.sum_t1 += n.impulse.t1;
    n.state.sum_t2 += n.impulse.t2;
    const vector v = n.v_free + n.delassus.times(n.impulse);
    n.state.slip_1 += c > 0.0 ? n.position_step * v.t1 : 0.0;
    n.state.slip_2 += c > 0.0 ? n.position_step * v.t2 : 0.0;
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
