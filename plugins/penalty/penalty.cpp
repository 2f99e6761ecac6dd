// Penalised contact with regularised friction, explicit and locally implicit. See penalty.md for the
// equations.
#include "compression.hpp"

#include <ilaw/kit.hpp>

namespace {

using namespace ilaw::kit;

constexpr const char* integration_choices[] = {"explicit", "implicit"};
constexpr double implicitly = 1.0;

struct penalty {
  double stiffness;
  double damping;
  double exponent;
  double friction;
  double tangential_stiffness;
  double integration;

  static constexpr law_card card{
      .id = "penalty",
      .title = "Penalised contact with regularised friction",
      .doc =
          "A spring (linear, or of Hertz's kind) with a Kelvin-Voigt damper instead of contact, and a "
          "tangential "
          "spring that slides on the cone. Explicit as most codes have it, or locally implicit: then any "
          "stiffness, infinite too, leaves the critical time step as it is.",
      .inputs = reads_gap | reads_v_previous,
      .capabilities = ILAW_CAN_STORE_ENERGY | ILAW_CAN_REST};

  static constexpr const char* references[] = {
      "H. Hertz, 1882, Ueber die Beruehrung fester elastischer Koerper",
      "P. Wriggers, T. Vu Van, E. Stein, 1990, Finite element formulation of large deformation "
      "impact-contact "
      "problems with friction",
      "J. C. Simo, T. J. R. Hughes, 1998, Computational inelasticity: return mapping"};

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
      {.member = &penalty::friction,
       .name = "friction",
       .symbol = "mu",
       .doc = "Coefficient of friction.",
       .infinity_allowed = true},
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
       .doc = "explicit: forces from the gap and slip of the step; implicit: from those it leads to.",
       .choices = integration_choices,
       .choice_count = 2}};

  struct state {
    double normal, slip_1, slip_2;  // normal is always zero
  };
  static constexpr state_variable state_variables[] = {
      {.name = "spring",
       .unit = "m",
       .doc = "Elastic part of the slip; normal component zero.",
       .kind = ILAW_STATE_VECTOR}};

  std::uint32_t inputs() const {
    return reads_gap | (integration != implicitly && damping > 0.0 ? reads_v_previous : 0U);
  }
  const char* conflict() const {
    if (integration == implicitly) return nullptr;
    if (stiffness == infinity) return "parameter 'stiffness' must be finite where 'integration' is explicit";
    if (friction > 0.0 && tangential_stiffness == infinity)
      return "parameter 'tangential_stiffness' must be finite where 'integration' is explicit and 'friction' "
             "> 0";
    return nullptr;
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
    return smaller(closed, 2.0 / square_root(tangential_stiffness * largest_tangential(node.delassus)));
  }

  template <class Run>
  void in_form(Run run) const;
  template <class Node>
  void step(Node& node) const {
    in_form([&node](const auto& form) { form.step(node); });
  }

 protected:
  // Not below the largest inverse mass in the tangent plane, with what H couples to the normal.
  static double largest_tangential(const scalar_delassus& h) { return h.h; }
  static double largest_tangential(const diagonal_delassus& h) { return larger(h.t1, h.t2); }
  static double largest_tangential(const full_delassus& h) {
    return larger(h.t11 + absolute(h.n1), h.t22 + absolute(h.n2)) + absolute(h.t12);
  }

  template <bool Linear>
  double spring_force(double penetration) const {
    if constexpr (Linear) return stiffness * penetration;
    return stiffness * power(penetration, exponent);
  }
  // Energy of the normal spring; none when it is rigid.
  template <bool Linear>
  double potential(double penetration) const {
    const double spring = spring_force<Linear>(penetration) * penetration / (exponent + 1.0);
    return stiffness < infinity ? spring : 0.0;
  }
  double tangential_potential(vector slip, vector other) const {
    return tangential_stiffness < infinity ? 0.5 * tangential_stiffness * tangential_product(slip, other)
                                           : 0.0;
  }

  // Gives the node a normal impulse that is known already, and the tangential one -q/softness within the
  // cone.
  template <class Node>
  void rub(Node& node, double normal, vector q, double softness) const {
    q.n = -normal;
    const auto result = solve_contact_friction(diagonal_delassus{1.0, softness, softness}, -1.0, q, friction);
    node.impulse = result.impulse;
    const double rubbed = result.slips ? double{ILAW_SLIP} : double{ILAW_STICK};
    const double closed = friction > 0.0 ? rubbed : double{ILAW_CLOSED};
    node.status = normal > 0.0 ? closed : double{ILAW_FREE};
  }

  template <bool Linear, class Node>
  void step_implicitly(Node& node) const {
    const double rate = 1.0 / node.position_step;
    const vector spring{0.0, node.state.slip_1, node.state.slip_2};
    const double softness = rate / (node.velocity_step * tangential_stiffness);
    const vector q = node.v_free + rate * spring;
    if (friction > 0.0 && node.delassus.anisotropy() != 0.0)
      rub_any<Linear>(node, q, softness);
    else
      rub(node, normal_impulse<Linear>(node), q, node.delassus.tangential() + softness);

    const double compliance = node.position_step * softness;
    node.state = {0.0, 0.0 - compliance * node.impulse.t1, 0.0 - compliance * node.impulse.t2};
    const vector strained{0.0, node.state.slip_1, node.state.slip_2};
    const vector v = node.v_free + node.delassus.times(node.impulse);
    const double normal = potential<Linear>(positive_part(-(node.gap + node.position_step * v.n)));
    const double tangential = tangential_potential(strained, strained);
    node.normal_gain = normal - potential<Linear>(positive_part(-node.gap));
    node.tangential_gain = tangential - tangential_potential(spring, spring);
    node.stored = normal + tangential;
  }

  // The same for any H: springs are inverse masses beside its own, which makes this Coulomb's local problem.
  // Where H couples the normal to the tangents, the normal spring must be one as well: linear and without
  // damper.
  template <bool Linear, class Node>
  void rub_any(Node& node, vector q, double softness) const {
    local_coulomb problem = problem_of(node.delassus);
    problem.h[1] += softness;
    problem.h[2] += softness;
    problem.q[1] = q.t1;
    problem.q[2] = q.t2;
    problem.mu[0] = problem.mu[1] = friction;
    const bool couples = absolute(problem.h[3]) + absolute(problem.h[4]) > rounding_of(node.delassus);
    const bool is_inverse_mass = stiffness == infinity || (Linear && damping == 0.0);
    if (is_inverse_mass) {
      problem.h[0] += 1.0 / (node.velocity_step * node.position_step * stiffness);
      problem.q[0] = node.v_free.n + acting_gap(node) * (1.0 / node.position_step);
    } else {
      problem.h[3] = problem.h[4] = 0.0;
      problem.q[0] = -problem.h[0] * normal_impulse<Linear>(node);
    }
    apply_local_coulomb(node, stiffness > 0.0 ? -1.0 : 1.0, problem);
    if (couples && !is_inverse_mass) node.refused = anisotropic_delassus;
  }

  // A rigid spring does not push out what has penetrated already.
  template <class Node>
  double acting_gap(const Node& node) const {
    return stiffness < infinity ? node.gap : positive_part(node.gap);
  }

  // r = h <k <-g'>^p - c v_N> where the next gap g' = g + h v_N, v_N = v_free + H r, is closed; else r keeps
  // it from opening, if anything does.
  template <bool Linear, class Node>
  double normal_impulse(const Node& node) const {
    const double gap = acting_gap(node);
    const penalty_law::compression problem{.velocity = node.v_free.n,
                                           .reach = node.v_free.n + gap * (1.0 / node.position_step),
                                           .delassus = node.delassus.normal(),
                                           .velocity_step = node.velocity_step,
                                           .position_step = node.position_step};
    if constexpr (Linear) return problem.linear(gap, stiffness, damping);
    return problem.power_law(stiffness, damping, exponent);
  }

  // Forces of the configuration and the half step before: the stiffness eats the critical time step. The
  // spring is kept as the motion of this step will strain it, so that the next step finds it ready.
  template <bool Linear, class Node>
  void step_explicitly(Node& node) const {
    const double penetration = positive_part(-node.gap), h = node.velocity_step;
    const double elastic = h * spring_force<Linear>(penetration);
    const double viscous = penetration > 0.0 ? h * damping * node.v_previous.n : 0.0;
    const double shear = friction > 0.0 ? h * tangential_stiffness : 0.0;
    const vector spring{0.0, node.state.slip_1, node.state.slip_2};
    rub(node, positive_part(elastic - viscous), shear * spring, 1.0);

    const double per_impulse = shear > 0.0 ? 1.0 / shear : 0.0;
    const double moves = shear > 0.0 ? node.position_step : 0.0;
    const double strains = node.impulse.n > 0.0 ? moves : 0.0;
    const vector v = node.v_free + node.delassus.times(node.impulse);
    const vector kept{0.0, 0.0 - per_impulse * node.impulse.t1, 0.0 - per_impulse * node.impulse.t2};
    const vector next{0.0, kept.t1 + strains * v.t1, kept.t2 + strains * v.t2};
    node.state = {0.0, next.t1, next.t2};

    // Levels as in the discrete energy of the central-difference scheme, 1/2 k g_n g_{n+1}; see penalty.md.
    const vector mean = node.v_previous + v;
    const double normal = potential<Linear>(penetration) - 0.5 * elastic / h * node.position_step * v.n;
    node.stored = positive_part(normal + tangential_potential(kept, next));
    node.normal_gain = -0.5 * elastic * mean.n;
    node.tangential_gain = tangential_product(node.impulse, (1.0 / h) * (spring - kept) - 0.5 * mean);
  }
};

// The four forms, chosen per batch: loops without a power vectorise.
template <bool Implicit, bool Linear>
struct penalty_form : penalty {
  template <class Node>
  void step(Node& node) const {
    if constexpr (Implicit)
      step_implicitly<Linear>(node);
    else
      step_explicitly<Linear>(node);
  }
};

template <class Run>
void penalty::in_form(Run run) const {
  const bool is_implicit = integration == implicitly;
  const bool is_linear = exponent == 1.0 || stiffness == infinity;
  if (is_implicit && is_linear) run(penalty_form<true, true>{*this});
  if (is_implicit && !is_linear) run(penalty_form<true, false>{*this});
  if (!is_implicit && is_linear) run(penalty_form<false, true>{*this});
  if (!is_implicit && !is_linear) run(penalty_form<false, false>{*this});
}

}  // namespace

ILAW_PLUGIN("penalty", "1.0.0", "ilaw", "BSD-3-Clause", penalty)
