// Penalised contact with regularised friction, explicit and locally implicit. See penalty.md.
#include "friction.hpp"

#include <ilaw/kit.hpp>
#include <ilaw/kit/tangential_spring.hpp>

namespace {

using namespace ilaw::kit;
using namespace penalty_law;

constexpr const char* integration_choices[] = {"explicit", "implicit"};
constexpr double implicitly = 1.0;

template <class V>
struct penalty {
  V stiffness, damping, exponent, restitution, friction, tangential_stiffness, heat_partition,
      wear_coefficient;
  double integration;

  static constexpr law_card card{
      .id = "penalty",
      .title = "Penalised contact with regularised friction",
      .doc =
          "A spring (linear, or of Hertz's kind) with a Kelvin-Voigt damper instead of contact, and a "
          "tangential spring that slides on the cone. Explicit as most codes have it, or locally implicit: "
          "then any stiffness, infinite too, leaves the critical time step as it is and gives back the "
          "energy of an impact, or what a coefficient of restitution leaves of it.",
      .inputs = reads_gap | reads_v_previous | reads_v_smooth,
      .capabilities = can_store_energy,
      .permissions = may_skip_fresh};

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
      {&penalty::damping, "damping", "c", "N.s/m", "Kelvin-Voigt damping of a node while it penetrates."},
      {&penalty::exponent, "exponent", "p", "1",
       "The force is k times the penetration to this power: 1 linear, 1.5 Hertz.", 1.0, 1.0, 8.0},
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
       .choices = integration_choices},
      heat_partition_parameter(&penalty::heat_partition),
      wear_coefficient_parameter(&penalty::wear_coefficient)};

  struct state {
    V indentation;
    tangential_vector<V> spring;
    V withheld;
  };
  static constexpr state_variable<state> state_variables[] = {
      {&state::indentation, "indentation", "m", "Of the implicit normal spring since it closed.", false, 0.0},
      {&state::spring, "spring", "m", "Elastic part of the slip."},
      {&state::withheld, "withheld", "J", "Work that restitution gives back unless the spring opens.", false,
       0.0}};

  std::uint32_t inputs() const {
    if (integration == implicitly) return card.inputs;
    return reads_gap | (damping > 0.0 ? reads_v_previous : 0U);
  }
  // A damper lets the node go before the spring is at rest: such a node is free, and may push once more.
  std::uint32_t permissions() const {
    const bool lets_go_early = integration == implicitly && (damping > 0.0 || restitution < 1.0);
    return may_skip_fresh | (lets_go_early ? 0U : may_skip_free);
  }
  const char* conflict() const {
    const bool is_explicit = integration != implicitly;
    if (restitution < 1.0 && (damping > 0.0 || exponent != 1.0))
      return "parameter 'restitution' below 1 sets the damper of a linear spring: it needs 'damping' 0 and "
             "'exponent' 1";
    if (is_explicit && restitution < 1.0)
      return "parameter 'restitution' must be 1 where 'integration' is explicit; 'damping' takes energy there";
    if (is_explicit && stiffness == infinity)
      return "parameter 'stiffness' must be finite where 'integration' is explicit";
    if (is_explicit && friction > 0.0 && tangential_stiffness == infinity)
      return "parameter 'tangential_stiffness' must be finite where 'integration' is explicit and 'friction' > 0";
    return nullptr;
  }

  // The limit of explicit springs, the normal one closed and as stiff as it is now, with a damper that lags:
  // omega h = 2 (sqrt(1 + zeta^2) - zeta), zeta = c H/(2 omega) (Belytschko, Liu, Moran 2000, eq. 6.2.31).
  template <class Node>
  V stable_velocity_step(const Node& node) const {
    if (integration == implicitly) return infinity;
    const V h_n = node.delassus.normal(), h_t = node.delassus.largest_tangential();
    V slope = stiffness;
    if (const auto is_linear = exponent == 1.0; any(!is_linear))
      slope =
          select(is_linear, slope, exponent * slope * to_exponent(positive_part(-node.gap), exponent - 1.0));
    V omega = square_root(larger(slope * h_n, zero_unless(friction > 0.0, tangential_stiffness) * h_t));
    if (any(damping > 0.0)) {
      const V half_damper = 0.5 * damping * h_n;
      omega = larger(omega, square_root(slope * h_n + half_damper * half_damper) + half_damper);
    }
    return 2.0 / omega;
  }

  // Values that all nodes of a batch share.
  struct numbers {
    bool loses, withholds, rubs;
    V step, lead, ratio;  // h, tau, zeta
    tangential_spring<V> tangent;
  };
  numbers prepare(const step_sizes& step) const {
    const double h = step.velocity_step;
    const mask_of<V> rubs = friction > 0.0;
    const mask_of<V> acts =
        (integration == implicitly) | (rubs & tangential_spring<V>::counts(h, tangential_stiffness));
    return {.loses = any((restitution < 1.0) | (damping > 0.0) | (stiffness == infinity) | (exponent != 1.0)),
            .withholds = any(restitution < 1.0),
            .rubs = any(rubs),
            .step = h,
            .lead = 1.0 / (1.0 + restitution) - 0.5,
            .ratio = any(restitution < 1.0) ? damping_ratio(restitution) : V(0.0),
            .tangent = {h, tangential_stiffness, rubs, acts}};
  }

  using problem = penalty_law::problem<V>;
  using answer = penalty_law::answer<V>;

  // Explicit and implicit linear springs have a closed form, with friction where H has one tangential entry.
  bool asks(bool is_transverse_form) const {
    const bool is_linear = exponent == 1.0 || stiffness == infinity;
    return integration == implicitly && !(is_linear && (is_transverse_form || friction == 0.0));
  }
  template <class Node>
  status_of<V> step(Node& node) const {
    if (integration != implicitly) return step_explicitly(node);
    const problem p = normal_problem(node);
    const mask_of<V> acts = acts_on(node);
    spring_solution<V> found;
    if (node.prepared.loses)
      found = spring_of<V>(p, p.free, node.prepared).linear();
    else
      found = spring_of<sure_zero>(p, p.free, node.prepared).linear();
    return give(node, zero_unless(acts, found.impulse), zero_unless(acts, found.end));
  }
  template <class Node>
  asked<V> ask(Node& node, problem& open) const {
    open = normal_problem(node);
    if constexpr (!is_transverse<Node>) {
      const tangential_spring<V>& tangent = node.prepared.tangent;
      const vector<V> q = 0.5 * tangent.slip(node, node.state.spring, 0.0);
      const V softness = 0.5 * tangent.softness;
      const full<V>& h = node.delassus;
      const mask_of<V> is_rigid = tangential_stiffness == infinity;
      open.c1 = h.n1, open.c2 = h.n2;
      open.a11 = 0.5 * h.t11 + softness, open.a22 = 0.5 * h.t22 + softness, open.a12 = 0.5 * h.t12;
      open.q1 = q.t1, open.q2 = q.t2;
      open.before1 = zero_unless(is_rigid, node.v_previous.t1);
      open.before2 = zero_unless(is_rigid, node.v_previous.t2);
    }
    const mask_of<V> may_push = (open.indentation > 0.0) | (open.free + open.previous < 0.0);
    const mask_of<V> pushes = acts_on(node) & may_push;
    return {pushes, keep(node, 0.0, may_push & !may_push)};
  }
  mask_of<V> solve(const problem& p, answer& a, const numbers& shared) const {
    const auto solve_with = [&]<class Loss>(Loss) ILAW_KIT_LAMBDA {
      const auto spring_at = [&](V free) ILAW_KIT_LAMBDA { return spring_of<Loss>(p, free, shared); };
      return penalty_law::solve(p, friction, stiffness == infinity, spring_at, a);
    };
    return shared.loses ? solve_with(V(0.0)) : solve_with(sure_zero{});
  }
  void solve_scalar(const problem& p, answer& a, const numbers& shared) const {
    a = scalar_friction{p, spring_of<V>(p, p.free, shared), friction}.solve();
  }
  template <class Node>
  status_of<V> finish(Node& node, const answer& a) const {
    node.refuse(a.status == no_solution, refusal::no_solution);
    if (is_transverse<Node>) return give(node, a.normal, a.indentation);
    mask_of<V> slides = a.status == status::slip.code;
    vector<V> impulse{a.normal, a.t1, a.t2};
    const mask_of<V> is_apart = a.status == status::closed.code;
    if (any(is_apart) && node.prepared.rubs) {
      slides = slides | (is_apart & rub_on_spring(node, a.normal));
      impulse = select(is_apart, node.impulse, impulse);
    }
    node.impulse = impulse;
    return keep(node, a.indentation, slides);
  }

 private:
  // Energy of the normal spring; none where it is rigid.
  V potential(V x) const {
    return zero_unless(stiffness < infinity, stiffness * to_exponent(x, exponent) * x / (exponent + 1.0));
  }
  template <class Node>
  mask_of<V> rub_on_spring(Node& node, V normal) const {
    return node.prepared.tangent.rub(node, normal, node.state.spring, normal, friction);
  }
  template <class Node>
  status_of<V> status_of_pressed(const Node& node, mask_of<V> slides) const {
    const status_of<V> rubbed = select(slides, status::slip, status::stick);
    return select(node.impulse.n > 0.0, select(friction > 0.0, rubbed, status::closed), status::free);
  }

  // ---- implicit: the mean force over the step, so that springs give back what they took

  template <class Node>
  mask_of<V> acts_on(const Node& node) const {
    const V middle = node.gap + 0.5 * node.position_step * node.v_previous.n;
    return (node.state.indentation > 0.0) | ((!is_out_of_reach(node)) & (middle <= 0.0));
  }
  template <class Node>
  problem normal_problem(const Node& node) const {
    const V x = zero_unless(stiffness < infinity, node.state.indentation);
    problem p{node.v_free.n, node.v_previous.n, node.delassus.normal(), x};
    p.withheld = zero_unless(x > 0.0, node.state.withheld);
    return p;
  }
  // Loss: see normal_spring. With the damper of the step.
  template <class Loss>
  normal_spring<V, Loss> spring_of(const problem& p, V free, const numbers& shared) const {
    const V h = shared.step, ratio = shared.ratio, h_n = p.delassus, root = square_root(h_n);
    Loss damper{}, lead{}, withheld{};
    if constexpr (std::is_same_v<Loss, V>) {
      const mask_of<V> is_soft = stiffness < infinity;
      const V k = zero_unless(is_soft, stiffness), c = zero_unless(is_soft, damping);
      const V fading = root * (1.0 + (0.25 + 0.5 * ratio) * (h * square_root(k) * root));
      damper = (2.0 * ratio * square_root(k) + c) / select(ratio > 0.0, fading, 1.0 + 0.5 * h * c * h_n);
      lead = shared.lead;
      withheld = p.withheld;
    }
    return {h, stiffness, exponent, free, p.previous, h_n, p.indentation, damper, lead, withheld};
  }

  // Gives the node what its normal spring gives, and what friction makes of it.
  template <class Node>
  status_of<V> give(Node& node, V normal, V indentation) const {
    mask_of<V> slides = normal < 0.0;
    node.impulse.n = normal;
    if (node.prepared.rubs) slides = rub_on_spring(node, normal);
    return keep(node, indentation, slides);
  }
  template <class Node>
  status_of<V> keep(Node& node, V indentation, mask_of<V> slides) const {
    const tangential_spring<V>& tangent = node.prepared.tangent;
    const vector<V> before = node.state.spring;
    vector<V> slip{};
    if (tangent.is_soft) {
      const vector<V> r = node.impulse, v = node.v_free + node.delassus.times(r);
      slip =
          tangent.strained(before, r, node.v_previous + v, node.delassus.tangential(),
                           friction_limit(friction, r.n), slides | !(friction * r.n > 0.0), friction > 0.0);
    }
    const V withheld = withheld_by(node, indentation);
    if (node.wants_energy) {
      const V normal = potential(indentation) + withheld, tangential = tangent.energy(slip, slip);
      node.normal_gain = normal - (potential(node.state.indentation) + node.state.withheld);
      node.tangential_gain = tangential - tangent.energy(before, before);
      node.stored = normal + tangential;
    }
    node.state = {indentation, {slip.t1, slip.t2}, withheld};
    return status_of_pressed(node, slides);
  }
  // At most what lifts the zero of the spring, in the middle of the next step, back to the surface.
  template <class Node>
  V withheld_by(const Node& node, V indentation) const {
    if (!node.prepared.withholds) return 0.0;
    const V v = (node.v_free + node.delassus.times(node.impulse)).n;
    const V depth = positive_part(0.0 - (node.gap + 0.5 * node.position_step * v + indentation));
    const problem p = normal_problem(node);
    const V most = zero_unless(indentation > 0.0, stiffness * indentation) * depth;
    return spring_of<V>(p, p.free, node.prepared).withheld_after(v, indentation, most);
  }
  // ---- explicit: forces of the configuration and the half step before

  // The spring is kept as the motion of this step will strain it, so that the next step finds it ready.
  template <class Node>
  status_of<V> step_explicitly(Node& node) const {
    const tangential_spring<V>& tangent = node.prepared.tangent;
    const V h = node.velocity_step, x = positive_part(-node.gap);
    const V elastic = h * (stiffness * to_exponent(x, exponent));
    const V normal = positive_part(elastic - zero_unless(x > 0.0, h * damping * node.v_previous.n));
    const vector<V> spring = node.state.spring;
    vector<V> kept{}, next{};
    mask_of<V> slides = normal < 0.0;
    node.impulse.n = normal;
    if (node.prepared.rubs) {
      slides = rub_against(node, normal, tangent.rate * spring, V(1.0), normal, friction);
      const V strains = zero_unless((normal > 0.0) & (tangent.rate > 0.0), V(node.position_step));
      kept = node.impulse.against(0.0, tangent.per_rate);
      next = kept + strains * (node.v_free + node.delassus.times(node.impulse));
    }
    node.refuse((node.state.indentation != 0.0) | (node.state.withheld != 0.0), refusal::impossible_state);
    node.state = {0.0, {next.t1, next.t2}, 0.0};
    if (node.wants_energy) {
      // Levels as in the discrete energy of the central-difference scheme, 1/2 k g_n g_{n+1}; see penalty.md.
      const vector<V> v = node.v_free + node.delassus.times(node.impulse), mean = node.v_previous + v;
      const V level = potential(x) - 0.5 * elastic / h * node.position_step * v.n;
      node.stored = positive_part(level + tangent.energy(kept, next));
      node.normal_gain = -0.5 * elastic * mean.n;
      node.tangential_gain = tangential_product(node.impulse, V(1.0 / h) * (spring - kept) - V(0.5) * mean);
    }
    return status_of_pressed(node, slides);
  }
};

}  // namespace

ILAW_PLUGIN("penalty", "1.0.0", "ilaw", "BSD-3-Clause", penalty)
