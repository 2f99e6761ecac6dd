// Penalised contact with regularised friction, explicit and locally implicit. See penalty.md.
#include "compression.hpp"

#include <ilaw/kit.hpp>

namespace {

using namespace ilaw::kit;

constexpr const char* integration_choices[] = {"explicit", "implicit"};
constexpr double implicitly = 1.0;
enum class spring_kind { linear, hertz, any };

struct penalty {
  double stiffness;
  double damping;
  double exponent;
  double restitution;
  double friction;
  double tangential_stiffness;
  double integration;

  static constexpr law_card card{
      .id = "penalty",
      .title = "Penalised contact with regularised friction",
      .doc =
          "A spring (linear, or of Hertz's kind) with a Kelvin-Voigt damper instead of contact, and a "
          "tangential spring that slides on the cone. Explicit as most codes have it, or locally implicit: "
          "then any stiffness, infinite too, leaves the critical time step as it is and gives back the "
          "energy of an impact, or what a coefficient of restitution leaves of it.",
      .inputs = reads_gap | reads_v_previous,
      .capabilities = ILAW_CAN_STORE_ENERGY | ILAW_CAN_REST};

  static constexpr const char* references[] = {
      "H. Hertz, 1882, Ueber die Beruehrung fester elastischer Koerper",
      ("P. Wriggers, T. Vu Van, E. Stein, 1990, Finite element formulation of large deformation "
       "impact-contact problems with friction"),
      "J. C. Simo, T. J. R. Hughes, 1998, Computational inelasticity: return mapping",
      "J. C. Simo, N. Tarnow, 1992, The discrete energy-momentum method",
      "T. Schwager, T. Poeschel, 2007, Coefficient of restitution and linear-dashpot model revisited"};

  static constexpr parameter<penalty> parameters[] = {
      {.member = &penalty::stiffness,
       .name = "stiffness",
       .symbol = "k",
       .unit = "N/m^p",
       .doc = "Stiffness of a node against penetration; inf (implicit only): contact.",
       .required = true,
       .infinity_allowed = true},
      {.member = &penalty::damping,
       .name = "damping",
       .symbol = "c",
       .unit = "N.s/m",
       .doc = "Kelvin-Voigt damping of a node while it penetrates."},
      {.member = &penalty::exponent,
       .name = "exponent",
       .symbol = "p",
       .doc = "The force is k times the penetration to this power: 1 linear, 1.5 Hertz.",
       .default_value = 1.0,
       .minimum = 1.0,
       .maximum = 8.0},
      restitution_parameter(&penalty::restitution)
          .with_doc(
              "Part of the normal velocity that an impact gives back (implicit; explicit: 1, see damping).")
          .with_default(1.0),
      friction_parameter(&penalty::friction),
      {.member = &penalty::tangential_stiffness,
       .name = "tangential_stiffness",
       .symbol = "k_T",
       .unit = "N/m",
       .doc = "Stiffness of a sticking node against slip; inf (implicit only): no slip at all.",
       .default_value = infinity,
       .minimum_excluded = true,
       .infinity_allowed = true},
      {.member = &penalty::integration,
       .name = "integration",
       .doc = "explicit: forces from the gap and slip of the step; implicit: from their mean over the step.",
       .choices = integration_choices,
       .choice_count = 2}};

  struct state {
    double indentation;
    vector spring;  // its normal component is always zero
  };
  static constexpr state_variable<state> state_variables[] = {
      {.member = &state::indentation,
       .name = "indentation",
       .unit = "m",
       .doc = "Of the implicit normal spring since it closed.",
       .minimum = 0.0},
      {.member = &state::spring,
       .name = "spring",
       .unit = "m",
       .doc = "Elastic part of the slip; normal component zero."}};

  std::uint32_t inputs() const {
    return reads_gap | (integration == implicitly || damping > 0.0 ? reads_v_previous : 0U);
  }
  const char* conflict() const {
    if (restitution < 1.0 && (damping > 0.0 || exponent != 1.0))
      return "parameter 'restitution' below 1 sets the damper of a linear spring: it needs 'damping' 0 and "
             "'exponent' 1";
    if (integration == implicitly) return nullptr;
    if (restitution < 1.0)
      return "parameter 'restitution' must be 1 where 'integration' is explicit; 'damping' takes energy there";
    if (stiffness == infinity) return "parameter 'stiffness' must be finite where 'integration' is explicit";
    if (friction > 0.0 && tangential_stiffness == infinity)
      return "parameter 'tangential_stiffness' must be finite where 'integration' is explicit and 'friction' "
             "> 0";
    return nullptr;
  }

  // A damper lets the node go before the spring is at rest: such a node is free, and may push once more.
  static constexpr bool rests_by_parameters = true;
  std::uint32_t capabilities() const {
    const bool lets_go_early = integration == implicitly && (damping > 0.0 || restitution < 1.0);
    return card.capabilities & ~(lets_go_early ? std::uint32_t{ILAW_CAN_REST} : 0U);
  }

  // Explicit springs with a damper that lags: omega h = 2 (sqrt(1 + zeta^2) - zeta), zeta = c H/(2 omega)
  // (Belytschko, Liu, Moran 2000, eq. 6.2.31). The normal spring is taken as closed, and as stiff as it is
  // now.
  template <class Node>
  double stable_velocity_step(const Node& node) const {
    if (integration == implicitly) return infinity;
    const double penetration = positive_part(-node.gap), normal = node.delassus.normal();
    const double tangent =
        exponent == 1.0 ? stiffness : stiffness * exponent * power(penetration, exponent - 1.0);
    const double pace = square_root(tangent * normal), half_damper = 0.5 * damping * normal;
    const double closed = 2.0 / (length(pace, half_damper) + half_damper);
    if (!(friction > 0.0)) return closed;
    return smaller(closed,
                   2.0 / square_root(tangential_stiffness * penalty_law::largest_tangential(node.delassus)));
  }

  // Explicit or implicit, and the kind of spring: loops without a choice of powers vectorise.
  template <bool Implicit, spring_kind Kind>
  struct form;
  template <class Run>
  void in_form(Run run) const;
  template <class Node>
  void step(Node& node) const {
    in_form([&node](const auto& chosen) { step_alone(chosen, node); });
  }

 private:
  template <spring_kind Kind>
  double spring_force(double penetration) const {
    if constexpr (Kind == spring_kind::linear) return stiffness * penetration;
    if constexpr (Kind == spring_kind::hertz) return stiffness * (penetration * square_root(penetration));
    return stiffness * power(penetration, exponent);
  }
  // Energy of the normal spring; none when it is rigid.
  template <spring_kind Kind>
  double potential(double penetration) const {
    const double energy = spring_force<Kind>(penetration) * penetration / (exponent + 1.0);
    return kept_if(stiffness < infinity, energy);
  }
  double tangential_potential(vector slip, vector other) const {
    return kept_if(tangential_stiffness < infinity,
                   0.5 * tangential_stiffness * tangential_product(slip, other));
  }

  // Gives the node a normal impulse that is known already, and the tangential one -q/softness within the
  // cone.
  // Says whether it slides.
  template <class Node>
  bool rub(Node& node, double normal, vector q, double softness) const {
    q.n = -normal;
    const auto result = solve_contact_friction(diagonal_delassus{1.0, softness, softness}, -1.0, q, friction);
    node.impulse = result.impulse;
    const double rubbed = result.slips ? status::slip : status::stick;
    const double closed = friction > 0.0 ? rubbed : status::closed;
    node.status = normal > 0.0 ? closed : status::free;
    return result.slips | !(friction * normal > 0.0);
  }

  // The mean over the step of forces that the step ends with, so that springs give back what they took: see
  // penalty.md.
  template <spring_kind Kind, class Node>
  void step_implicitly(Node& node, double damping_ratio) const {
    penalty_law::compression normal = compression_of(node, damping_ratio);
    const bool acts = acts_on(node);
    if (friction > 0.0 && node.delassus.anisotropy() != 0.0) {
      const auto found = rub_any<Kind>(node, acts, normal, sliding_velocity(node), softness_of(node));
      strain<Kind>(node, acts ? normal.next(found) : 0.0, node.status != status::stick);
    } else {
      give<Kind>(node, normal, Kind == spring_kind::linear ? normal.linear() : normal.power_law(), acts);
    }
  }

  template <class Node>
  bool acts_on(const Node& node) const {
    const bool enters =
        !is_out_of_reach(node) & (node.gap + 0.5 * node.position_step * node.v_previous.n <= 0.0);
    return (node.state.indentation > 0.0) | enters;
  }
  // q + H/2 r is the mean velocity of what slips.
  template <class Node>
  vector sliding_velocity(const Node& node) const {
    const vector spring{0.0, node.state.spring.t1, node.state.spring.t2};
    return 0.5 * (node.v_free + held(node) * node.v_previous) + (2.0 / node.velocity_step) * spring;
  }
  template <class Node>
  double softness_of(const Node& node) const {
    return 2.0 / node.velocity_step / (node.velocity_step * tangential_stiffness);
  }

  // Gives the node what its normal spring gives, and what friction makes of it.
  template <spring_kind Kind, class Node>
  void give(Node& node, const penalty_law::compression& normal, penalty_law::compression::solution found,
            bool acts) const {
    found.impulse = acts ? found.impulse : 0.0;
    const double softness = 0.5 * node.delassus.tangential() + softness_of(node);
    const bool slides = rub(node, found.impulse, sliding_velocity(node), softness);
    strain<Kind>(node, acts ? normal.next(found) : 0.0, slides);
  }

  // What the step leaves in the springs. One that sticks moves along; one that slides keeps no more than its
  // force holds, in the direction of its end.
  template <spring_kind Kind, class Node>
  void strain(Node& node, double indentation, bool slides) const {
    const double h = node.velocity_step, per_impulse = 1.0 / (h * tangential_stiffness);
    const vector spring{0.0, node.state.spring.t1, node.state.spring.t2}, r = node.impulse;
    const vector v = node.v_free + node.delassus.times(r);
    const vector moved = spring + (0.5 * h) * (node.v_previous + v);
    const double most = per_impulse * r.tangential_length(), length = moved.tangential_length();
    const bool is_stiff = h * h * tangential_stiffness * node.delassus.tangential() > 4.0;
    const double kept = (slides & (length > most)) ? most / length : 1.0;
    const bool by_force = is_stiff & !slides, holds = tangential_stiffness < infinity && friction > 0.0;
    const auto next = [&](double before, double after, double impulse) {
      const double end = by_force ? 0.0 - 2.0 * per_impulse * impulse - before : kept * after;
      return kept_if(holds, end) + 0.0;  // never -0: a node at rest keeps its bits
    };
    const vector strained{0.0, next(spring.t1, moved.t1, r.t1), next(spring.t2, moved.t2, r.t2)};
    const double stored_normal = potential<Kind>(indentation);
    const double stored_tangential = tangential_potential(strained, strained);
    node.normal_gain = stored_normal - potential<Kind>(node.state.indentation);
    node.tangential_gain = stored_tangential - tangential_potential(spring, spring);
    node.stored = stored_normal + stored_tangential;
    node.state = {indentation, strained};
  }

  template <class Node>
  penalty_law::compression compression_of(const Node& node, double damping_ratio) const {
    const double h = node.velocity_step, delassus = node.delassus.normal();
    const double pace = h * square_root(stiffness) * square_root(delassus);
    const double reached =
        2.0 * damping_ratio * (pace / (h * delassus)) / (1.0 + (0.25 + 0.5 * damping_ratio) * pace);
    const double damper = damping / (1.0 + 0.5 * h * damping * delassus);
    return {.free = node.v_free.n,
            .previous = node.v_previous.n,
            .delassus = delassus,
            .step = h,
            .indentation = stiffness < infinity ? node.state.indentation : 0.0,
            .stiffness = stiffness,
            .exponent = exponent,
            .damping = stiffness < infinity ? reached + damper : 0.0,
            .lead = 1.0 / (1.0 + restitution) - 0.5};
  }

  // How much of the velocity before a step counts for a spring's mean: all; where it is rigid what of it the
  // free velocity has turned round, so that stopping it does no work.
  template <class Node>
  double held(const Node& node) const {
    const double speed = tangential_product(node.v_previous, node.v_previous);
    const double turned = 0.0 - tangential_product(node.v_free, node.v_previous);
    const double part = turned > 0.0 ? turned / larger(turned, speed) : 0.0;
    return tangential_stiffness < infinity ? 1.0 : part;
  }

  // The same for any H. Tangents with a normal impulse that is known are Coulomb's local problem without
  // coupling, the tangential spring an inverse mass beside H; what their impulse does to the normal leaves
  // one equation for one unknown. A rigid spring has none to find: Coulomb's local problem as it is.
  template <spring_kind Kind, class Node>
  penalty_law::compression::solution rub_any(Node& node, bool acts, penalty_law::compression& normal,
                                             vector q, double softness) const {
    local_coulomb problem{};
    fill(problem, node.delassus);
    const double coupling_1 = problem.h[3], coupling_2 = problem.h[4], nn = problem.h[0];
    for (double& entry : problem.h) entry *= 0.5;
    problem.h[1] += softness;
    problem.h[2] += softness;
    problem.mu[0] = problem.mu[1] = friction;
    problem.q[1] = q.t1;
    problem.q[2] = q.t2;
    if (stiffness == infinity) {
      problem.q[0] = 0.5 * (normal.free + (normal.previous < 0.0 ? restitution : 1.0) * normal.previous);
      apply_local_coulomb(node, acts ? -1.0 : 1.0, problem);
      return {node.impulse.n, 0.0};
    }
    problem.h[3] = problem.h[4] = 0.0;
    const double free = normal.free;
    const auto tangents = [&](double r) {
      problem.q[0] = -problem.h[0] * r;
      problem.q[1] = q.t1 + 0.5 * coupling_1 * r;
      problem.q[2] = q.t2 + 0.5 * coupling_2 * r;
      apply_local_coulomb(node, -1.0, problem);
      node.impulse.n = r;
      return free + coupling_1 * node.impulse.t1 + coupling_2 * node.impulse.t2;
    };
    penalty_law::compression::solution found{0.0, 0.0};
    if (acts && coupling_1 == 0.0 && coupling_2 == 0.0)
      found = Kind == spring_kind::linear ? normal.linear() : normal.power_law();
    else if (acts)
      found.impulse = normal.impulse_where([&](double r) { return normal.given(tangents(r) + nn * r) - r; });
    normal.free = tangents(acts ? found.impulse : 0.0);
    if (!is_finite(found.impulse)) node.refused = no_solution;
    found.opens = normal.travel(normal.free + nn * found.impulse) > normal.indentation ? 1.0 : 0.0;
    return found;
  }

  // Forces of the configuration and the half step before: the stiffness eats the critical time step. The
  // spring is kept as the motion of this step will strain it, so that the next step finds it ready.
  template <spring_kind Kind, class Node>
  void step_explicitly(Node& node) const {
    const double penetration = positive_part(-node.gap), h = node.velocity_step;
    const double elastic = h * spring_force<Kind>(penetration);
    const double viscous = penetration > 0.0 ? h * damping * node.v_previous.n : 0.0;
    const double shear = friction > 0.0 ? h * tangential_stiffness : 0.0;
    const vector spring{0.0, node.state.spring.t1, node.state.spring.t2};
    rub(node, positive_part(elastic - viscous), shear * spring, 1.0);

    const double per_impulse = shear > 0.0 ? 1.0 / shear : 0.0;
    const double moves = shear > 0.0 ? node.position_step : 0.0;
    const double strains = node.impulse.n > 0.0 ? moves : 0.0;
    const vector v = node.v_free + node.delassus.times(node.impulse);
    const vector kept{0.0, 0.0 - per_impulse * node.impulse.t1, 0.0 - per_impulse * node.impulse.t2};
    const vector next{0.0, kept.t1 + strains * v.t1, kept.t2 + strains * v.t2};
    if (node.state.indentation != 0.0) node.refused = impossible_state;
    node.state = {0.0, next};

    // Levels as in the discrete energy of the central-difference scheme, 1/2 k g_n g_{n+1}; see penalty.md.
    const vector mean = node.v_previous + v;
    const double normal = potential<Kind>(penetration) - 0.5 * elastic / h * node.position_step * v.n;
    node.stored = positive_part(normal + tangential_potential(kept, next));
    node.normal_gain = -0.5 * elastic * mean.n;
    node.tangential_gain = tangential_product(node.impulse, (1.0 / h) * (spring - kept) - 0.5 * mean);
  }
};

template <bool Implicit, spring_kind Kind>
struct penalty::form : penalty {
  double damping_ratio;

  // Springs with a root to find are solved in packs, of Hertz's exponent alone; others one by one.
  template <class V>
  using problem = penalty_law::compression_of_any<V>;
  template <class V>
  struct answer {
    V impulse, opens;
  };
  static constexpr bool answers_every_node = true, is_linear = Kind == spring_kind::linear;
  template <class Node>
  static constexpr bool finds_roots = !is_linear && Implicit && has_transverse_delassus<Node>;

  template <class Node>
  void step(Node& node) const requires(!finds_roots<Node>) {
    if constexpr (Implicit)
      step_implicitly<Kind>(node, damping_ratio);
    else
      step_explicitly<Kind>(node);
  }

  template <class Node>
  bool asks(Node& node, problem<double>& open) const requires finds_roots<Node> {
    open = compression_of(node, damping_ratio);
    const bool acts = acts_on(node);
    answered(node, {0.0, 0.0});
    return acts;
  }
  template <class V>
  static mask_of<V> solve(const problem<V>& p, answer<V>& a) {
    const auto found = p.power_law();
    a = {found.impulse, found.opens};
    if constexpr (std::is_same_v<V, double>) return false;
    return p.exponent != 1.5;
  }
  static void solve_alone(const problem<double>& p, answer<double>& a) { solve(p, a); }
  template <class Node>
  void answered(Node& node, const answer<double>& a) const {
    give<Kind>(node, compression_of(node, damping_ratio), {a.impulse, a.opens}, acts_on(node));
  }
};

template <class Run>
void penalty::in_form(Run run) const {
  const double ratio = penalty_law::damping_ratio(restitution);
  const auto run_kind = [&]<spring_kind Kind>() {
    integration == implicitly ? run(form<true, Kind>{*this, ratio}) : run(form<false, Kind>{*this, ratio});
  };
  if (exponent == 1.0 || stiffness == infinity) return run_kind.template operator()<spring_kind::linear>();
  if (exponent == 1.5) return run_kind.template operator()<spring_kind::hertz>();
  run_kind.template operator()<spring_kind::any>();
}

}  // namespace

ILAW_PLUGIN("penalty", "1.0.0", "ilaw", "BSD-3-Clause", penalty)
