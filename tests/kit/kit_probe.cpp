// Laws with every feature of the kit, made for these tests alone.
#include <ilaw/kit.hpp>

#include <cstring>

namespace {

using namespace ilaw::kit;

constexpr const char* no_references[] = {"none"};

// Entries of state_variables[] may be in another order than the members: they name them.
template <class V>
struct sums {
  tangential_vector<V> slip;  // of closed steps
  V count;
  vector<V> sum;  // of impulses
};
// r = -c (v_free + H r), solved for r, plus a pull along the remembered sum, so that memory matters. Solves
// for H of any form as if it were its normal entry alone.
template <class V, class Node>
status_of<V> sum_up(Node& node, V viscosity, V last) {
  const auto closed = node.gap <= 0.0;
  const V c = zero_unless(closed, viscosity), factor = -c / (1.0 + c * node.delassus.normal());
  const vector<V> slip = node.state.slip;
  node.impulse = factor * node.v_free - V(0.125) * vector<V>{last, node.state.sum.t1, node.state.sum.t2} -
                 V(0.25) * slip;
  node.state.count += 1.0;
  node.state.sum = node.state.sum + node.impulse;
  const vector<V> v = node.v_free + node.delassus.times(node.impulse);
  node.state.slip.t1 += zero_unless(c > 0.0, node.position_step * v.t1);
  node.state.slip.t2 += zero_unless(c > 0.0, node.position_step * v.t2);
  return select(c > 0.0, status::closed, status::free);
}

// Every kind of state.
template <class V>
struct kit_probe {
  V viscosity;

  static constexpr law_card card{.id = "kit_probe",
                                 .title = "Viscous contact that counts and sums",
                                 .doc = "r = -c v where closed; remembers what it gave.",
                                 .inputs = reads_gap,
                                 .capabilities = can_adhere};
  static constexpr auto& references = no_references;
  static constexpr parameter<kit_probe> parameters[] = {
      {.member = &kit_probe::viscosity, .name = "viscosity", .unit = "N.s/m", .doc = "c", .required = true}};
  struct state {
    tangential_vector<V> slip;  // of closed steps
    V count, last, before_last;
    vector<V> sum;  // of impulses
  };
  static constexpr state_variable<state> state_variables[] = {
      {.member = &state::count,
       .name = "count",
       .doc = "steps",
       .minimum = 0.0,
       .maximum = 1e6,
       .whole = true},
      {.member = &state::sum, .name = "sum", .unit = "N.s", .doc = "impulses"},
      {.member = &state::slip, .name = "slip", .unit = "m", .doc = "of closed steps"},
      {.member = &state::last, .name = "last", .unit = "m/s", .doc = "v_N before", .internal = true},
      {.member = &state::before_last,
       .name = "before_last",
       .unit = "m/s",
       .doc = "v_N before that",
       .internal = true}};
  static const void* extension(const char* name) {
    return std::strcmp(name, "tests.answer/1") == 0 ? &answer_to_all : nullptr;
  }
  static constexpr int answer_to_all = 42;

  template <class Node>
  status_of<V> step(Node& node) const {
    const V last = node.state.last;
    node.state.before_last = last;
    node.state.last = node.v_free.n;
    return sum_up<V>(node, viscosity, last);
  }
};

// In packs: a field, a table over it, an amount, numbers that a batch shares, a first state, refusals,
// permissions.
constexpr const char* yes_or_no[] = {"no", "yes"};
constexpr const char* over_temperature[] = {"time", "temperature", "hardness"};

template <class V>
struct pack_probe {
  V viscosity;
  V temperature;
  V hardness;
  V rate;
  double rests;

  static constexpr law_card card{.id = "pack_probe",
                                 .title = "Viscous contact that counts and sums, in packs",
                                 .doc = "r = -c v where closed; remembers what it gave, which fades.",
                                 .inputs = reads_gap | reads_area | reads_v_previous,
                                 .capabilities = can_adhere};
  static constexpr auto& references = no_references;
  static constexpr parameter<pack_probe> parameters[] = {
      {.member = &pack_probe::viscosity,
       .name = "viscosity",
       .unit = "N.s/m",
       .doc = "c",
       .required = true,
       .infinity_allowed = false,
       .axes = over_temperature},
      {.member = &pack_probe::temperature,
       .name = "temperature",
       .unit = "K",
       .default_value = 300.0,
       .is_field = true},
      {.member = &pack_probe::hardness,
       .name = "hardness",
       .default_value = 1.0,
       .minimum_excluded = true,
       .is_field = true},
      {.member = &pack_probe::rate,
       .name = "rate",
       .unit = "1/s",
       .doc = "the memory fades at",
       .default_value = 100.0},
      {.member = &pack_probe::rests, .name = "rests", .choices = yes_or_no}};
  struct state {
    tangential_vector<V> slip;
    V count;
    vector<V> sum;
    V last;
  };
  static constexpr state_variable<state> state_variables[] = {
      {.member = &state::count, .name = "count", .minimum = 0.0, .maximum = 1e6, .whole = true},
      {.member = &state::sum, .name = "sum", .unit = "N.s"},
      {.member = &state::last, .name = "last", .unit = "m/s"},
      {.member = &state::slip, .name = "slip", .unit = "m"}};
  static constexpr amount_card amounts[] = {{.name = "heat", .unit = "J"}, {.name = "wear", .unit = "m"}};

  std::uint32_t permissions() const { return rests == 1.0 ? may_skip_free : 0U; }
  const char* conflict() const {
    return viscosity > 1e6 * hardness ? "parameter 'viscosity' is above 1e6 'hardness'" : nullptr;
  }
  struct shared {
    V left;
  };
  shared prepare(const step_sizes& step) const { return {exp(-rate * step.velocity_step)}; }
  template <class Node>
  void initialise(Node& node) const {
    node.state.last = -0.5 * node.area * temperature;
  }

  template <class Node>
  status_of<V> step(Node& node) const {
    const V last = node.prepared.left * node.state.last, heated = 1.0 + 0.001 * (temperature - 300.0);
    const status_of<V> found = sum_up<V>(node, viscosity * heated, last);
    const vector<V> v = node.v_free + node.delassus.times(node.impulse);
    node.state.last = v.n + 0.125 * node.v_previous.n;
    node.amounts[0] = viscosity * v.n * v.n;
    node.amounts[1] = node.area * absolute(v.t1);
    node.refuse(node.state.count > 1000.0, refusal::impossible_state);
    node.refuse(node.state.last > 1e3, refusal::no_solution);
    return found;
  }
};

// A solver whose packs leave a third of the problems to the scalar fallback: r = -(v_free + e^-|v_free|)/H
// where v_free < 0, by Newton's method on x, x exp(x) = w, so that lanes take different numbers of steps.
template <class V>
struct solver_probe {
  V offset;

  static constexpr law_card card{.id = "solver_probe",
                                 .title = "Impulse from Lambert's function",
                                 .doc = "h_N r exp(r) = offset - v_free, where closed and that is positive.",
                                 .inputs = reads_gap,
                                 .capabilities = can_store_energy,
                                 .permissions = may_skip_fresh | may_skip_free};
  static constexpr auto& references = no_references;
  static constexpr parameter<solver_probe> parameters[] = {
      {.member = &solver_probe::offset, .name = "offset"}};
  struct state {
    V total;
  };
  static constexpr state_variable<state> state_variables[] = {
      {.member = &state::total, .name = "total", .unit = "N.s"}};
  static constexpr amount_card amounts[] = {{.name = "wear", .unit = "m"}};

  struct problem {
    V w;
  };
  struct answer {
    V x, steps;
  };
  template <class Node>
  asked<V> ask(Node& node, problem& open) const {
    open.w = (offset - node.v_free.n) / node.delassus.normal();
    return {(node.gap <= 0.0) & (open.w > 0.0), status::free};
  }
  static V newton(V x, V w) {
    const V e = exp(-x);
    return (x * x + w * e) / (1.0 + x);
  }
  static mask_of<V> solve(const problem& p, answer& a) {
    a.x = select(p.w > 1.0, log(1.0 + p.w), p.w);
    for (int k = 0; k < 40; ++k) a.x = newton(a.x, p.w);
    a.steps = 40.0;
    return p.w > 2.0;
  }
  static void solve_scalar(const problem& p, answer& a) {
    a.x = log(p.w);
    for (int k = 0; k < 60; ++k) a.x = newton(a.x, p.w);
    a.steps = 60.0;
  }
  template <class Node>
  status_of<V> finish(Node& node, const answer& a) const {
    node.impulse.n = a.x;
    node.state.total = node.state.total + a.x;
    node.stored = 0.5 * a.x;
    node.amounts[0] = a.steps;
    return select(a.steps > 50.0, status::stick, status::slip);
  }
};

// Stable steps: by H alone, and node by node.
template <class V>
struct limit_probe {
  V stiffness;

  static constexpr law_card card{
      .id = "limit_probe", .title = "Spring that limits the step", .doc = "h = 2/sqrt(k h_N), where closed"};
  static constexpr auto& references = no_references;
  static constexpr parameter<limit_probe> parameters[] = {
      {.member = &limit_probe::stiffness, .name = "stiffness", .default_value = 1.0}};
  template <class Node>
  status_of<V> step(Node&) const {
    return status::free;
  }
  template <class Node>
  V stable_velocity_step(const Node& node) const {
    return select(node.gap <= 0.0, 2.0 / square_root(stiffness * node.delassus.normal()), V(infinity));
  }
};

// Breaks what its card promises, as its parameter says. No H but a scalar one is compiled for it.
constexpr const char* breaks_choices[] = {"none", "number", "pull", "far"};

template <class V>
struct promise_breaker {
  double breaks;

  static constexpr law_card card{.id = "promise_breaker",
                                 .title = "A push that breaks a promise",
                                 .doc = "r_N = 1 where the gap is closed, but for what it breaks.",
                                 .delassus_forms = ILAW_DELASSUS_SCALAR,
                                 .permissions = may_skip_fresh};
  static constexpr auto& references = no_references;
  static constexpr parameter<promise_breaker> parameters[] = {{.member = &promise_breaker::breaks,
                                                               .name = "breaks",
                                                               .doc = "Which promise.",
                                                               .choices = breaks_choices}};
  template <class Node>
  status_of<V> step(Node& node) const {
    static_assert(is_transverse<Node>, "what the card does not serve is not compiled");
    constexpr double gives[] = {1.0, not_a_number, -1.0, 1.0};
    const auto closed = node.gap <= 0.0;
    node.impulse.n = zero_unless(closed | (breaks == 3.0), V(gives[static_cast<int>(breaks)]));
    return select(closed, status::closed, status::free);
  }
};

// Remembers one direction in the plane of contact: nothing in one dimension.
template <class V>
struct path_probe {
  V factor;

  static constexpr law_card card{.id = "path_probe", .title = "A path", .doc = "Adds v_T up."};
  static constexpr auto& references = no_references;
  static constexpr parameter<path_probe> parameters[] = {
      {.member = &path_probe::factor, .name = "factor", .doc = "Of v_T.", .default_value = 1.0}};
  struct state {
    tangential_vector<V> path;
  };
  static constexpr state_variable<state> state_variables[] = {
      {.member = &state::path, .name = "path", .unit = "m/s", .doc = "Sum of v_T."}};
  template <class Node>
  status_of<V> step(Node& node) const {
    node.state.path.t1 = node.state.path.t1 + factor * node.v_free.t1;
    node.state.path.t2 = node.state.path.t2 + factor * node.v_free.t2;
    return status::free;
  }
};

// Its impulse is a plain copy of an input.
template <class V>
struct copy_probe {
  V factor;

  static constexpr law_card card{.id = "copy_probe",
                                 .title = "A copy",
                                 .doc = "r = v_free",
                                 .capabilities = can_adhere,
                                 .is_isotropic = true};
  static constexpr auto& references = no_references;
  static constexpr parameter<copy_probe> parameters[] = {
      {.member = &copy_probe::factor, .name = "factor", .doc = "Not read.", .default_value = 1.0}};
  template <class Node>
  status_of<V> step(Node& node) const {
    node.impulse = node.v_free;
    return status::closed;
  }
};

}  // namespace

ILAW_PLUGIN("kit_probe", "1.0.0", "tests", "BSD-3-Clause", kit_probe, pack_probe, solver_probe, limit_probe,
            promise_breaker, path_probe, copy_probe)
