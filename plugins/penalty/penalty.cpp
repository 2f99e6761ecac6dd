// Penalised contact with regularised friction, explicit and locally implicit. See penalty.md.
#include "alone.hpp"

#include <ilaw/kit.hpp>

namespace {

using namespace ilaw::kit;

constexpr const char* integration_choices[] = {"explicit", "implicit"};
constexpr double implicitly = 1.0;
using penalty_law::spring_kind, penalty_law::is_linear, penalty_law::is_plain, penalty_law::is_smooth;

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
      .capabilities = ILAW_CAN_STORE_ENERGY | can_rest};

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
    return card.capabilities & ~(lets_go_early ? can_rest : 0U);
  }

  template <class Node>
  double stable_velocity_step(const Node& node) const {
    if (integration == implicitly) return infinity;
    return exponent == 1.0
               ? stable_with(node, stiffness)
               : stable_with(node, stiffness * exponent * power(positive_part(-node.gap), exponent - 1.0));
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
  // For the normal stiffness as it is now.
  template <class Node>
  double stable_with(const Node& node, double tangent) const {
    const double closed = penalty_law::stable_step(node.delassus.normal(), tangent, damping);
    const double rubs = kept_if(friction > 0.0, tangential_stiffness);  // none: 2/0 limits nothing
    const double sliding = 2.0 / square_root(rubs * penalty_law::largest_tangential(node.delassus));
    return smaller(sliding, closed);
  }
  // Energy of the normal spring; none when it is rigid.
  template <spring_kind Kind>
  double potential(double penetration) const {
    return kept_if(stiffness < infinity, penalty_law::potential<Kind>(stiffness, exponent, penetration));
  }
  double tangential_potential(vector a, vector b) const {
    return kept_if(tangential_stiffness < infinity, 0.5 * tangential_stiffness * tangential_product(a, b));
  }

  // Gives the node a known normal impulse and the tangential one -q/softness in the cone; says if it slides.
  template <class Node>
  bool rub(Node& node, double normal, vector q, double softness) const {
    const auto result = penalty_law::rub_apart(normal, q, softness, friction);
    node.impulse = result.impulse;
    return tell(node, result.slips);
  }
  // The status of a node that has its impulse. Who has no cone slides.
  template <class Node>
  bool tell(Node& node, bool slips) const {
    const double normal = node.impulse.n, rubbed = slips ? status::slip : status::stick;
    const double closed = friction > 0.0 ? rubbed : status::closed;
    node.status = normal > 0.0 ? closed : status::free;
    return slips | !(friction * normal > 0.0);
  }

  template <class Node>
  bool acts_on(const Node& node) const {
    const bool enters =
        !is_out_of_reach(node) & (node.gap + 0.5 * node.position_step * node.v_previous.n <= 0.0);
    return (node.state.indentation > 0.0) | enters;
  }
  // Whether a stick is rigid: known of most before their loop, each of which leaves something out.
  template <spring_kind Kind>
  bool sticks_rigidly() const {
    if constexpr (is_plain(Kind) || penalty_law::sticks_rigidly(Kind))
      return penalty_law::sticks_rigidly(Kind);
    return tangential_stiffness == infinity;
  }
  // q + H/2 r is the mean velocity of what slips, of which a rigid stick gives back a part. Twice that, and
  // twice what the spring adds to H/2.
  template <spring_kind Kind, class Node>
  vector sliding_velocity(const Node& node, double given_back) const {
    const bool rigid = sticks_rigidly<Kind>();  // then no spring is strained
    const vector sum = node.v_free + (rigid ? given_back : 1.0) * node.v_previous;
    if constexpr (penalty_law::sticks_rigidly(Kind)) return sum;
    return sum + kept_if(!rigid, 4.0 / node.velocity_step) *
                     vector{0.0, node.state.spring.t1, node.state.spring.t2};
  }
  template <class Node>
  double softness_of(const Node& node) const {
    return 4.0 / node.velocity_step / (node.velocity_step * tangential_stiffness);
  }
  template <class Node>
  double indentation_of(const Node& node) const {
    return kept_if(stiffness < infinity, node.state.indentation);
  }

  // The mean over the step of forces that the step ends with, so that springs give back what they took: see
  // penalty.md. Here for a linear normal spring.
  template <spring_kind Kind, class Node>
  void step_implicitly(Node& node, double damping_ratio) const {
    const auto spring = spring_of(node.velocity_step, damping_ratio);
    const double delassus = node.delassus.normal();
    penalty_law::compression<double, is_plain(Kind)> normal{spring,   node.v_free.n,        node.v_previous.n,
                                                            delassus, indentation_of(node), {}};
    if constexpr (!is_plain(Kind)) normal.damping = spring.damper(delassus);
    const auto found = normal.linear();
    const bool acts = acts_on(node);
    give<Kind>(node, kept_if(acts, found.impulse), kept_if(acts, normal.next(found.impulse, found.opens)));
  }

  // Gives the node what its normal spring gives, and what friction makes of it.
  template <spring_kind Kind, class Node>
  void give(Node& node, double impulse, double indentation) const {
    if constexpr (is_smooth(Kind)) {
      node.impulse = {impulse, 0.0, 0.0};
      tell(node, false);
      store<Kind>(node, indentation, {});
    } else {
      const double softness = node.delassus.tangential() + softness_of(node);
      const double turned = penalty_law::turned_part(node.v_free, node.v_previous);
      const bool slides = rub(node, impulse, sliding_velocity<Kind>(node, turned), softness);
      store<Kind>(node, indentation, strained<Kind>(node, slides));
    }
  }

  // What the step leaves in the tangential spring. One that sticks moves along; one that slides keeps no more
  // than its force holds, in the direction of its end.
  template <spring_kind Kind, class Node>
  vector strained(const Node& node, bool slides) const {
    if constexpr (penalty_law::sticks_rigidly(Kind)) return {};
    const double h = node.velocity_step, per_impulse = 1.0 / (h * tangential_stiffness);
    const vector spring{0.0, node.state.spring.t1, node.state.spring.t2}, r = node.impulse;
    const vector v = node.v_free + node.delassus.times(r), moved = spring + (0.5 * h) * (node.v_previous + v);
    const double most = per_impulse * friction_limit(friction, r.n), length = moved.tangential_length();
    const bool is_stiff = h * h * tangential_stiffness * node.delassus.tangential() > 4.0;
    const double kept = (slides & (length > most)) ? most / length : 1.0;
    const bool by_force = is_stiff & !slides, holds = tangential_stiffness < infinity && friction > 0.0;
    const auto next = [&](double before, double after, double impulse) {
      const double end = by_force ? 0.0 - 2.0 * per_impulse * impulse - before : kept * after;
      return kept_if(holds, end) + 0.0;  // never -0: a node at rest keeps its bits
    };
    return {0.0, next(spring.t1, moved.t1, r.t1), next(spring.t2, moved.t2, r.t2)};
  }
  template <spring_kind Kind, class Node>
  void store(Node& node, double indentation, vector slip) const {
    const vector before{0.0, node.state.spring.t1, node.state.spring.t2};
    const double stored_normal = potential<Kind>(indentation);
    const double stored_tangential = tangential_potential(slip, slip);
    node.normal_gain = stored_normal - potential<Kind>(node.state.indentation);
    node.tangential_gain = stored_tangential - tangential_potential(before, before);
    node.stored = stored_normal + stored_tangential;
    node.state = {indentation, slip};
  }

  penalty_law::normal_spring spring_of(double step, double damping_ratio) const {
    return {.step = step,
            .stiffness = stiffness,
            .exponent = exponent,
            .lead = 1.0 / (1.0 + restitution) - 0.5,
            .damping = kept_if(stiffness < infinity, damping),
            .ratio = damping_ratio};
  }

  // Forces of the configuration and the half step before: the stiffness eats the critical time step. The
  // spring is kept as the motion of this step will strain it, so that the next step finds it ready.
  template <spring_kind Kind, class Node>
  void step_explicitly(Node& node) const {
    const double penetration = positive_part(-node.gap), h = node.velocity_step;
    const double elastic = h * penalty_law::spring_force<Kind>(stiffness, exponent, penetration);
    const double viscous = penetration > 0.0 ? h * damping * node.v_previous.n : 0.0;
    const vector spring{0.0, node.state.spring.t1, node.state.spring.t2};
    vector kept{}, next{};
    node.impulse = {positive_part(elastic - viscous), 0.0, 0.0};
    if constexpr (is_smooth(Kind)) {
      tell(node, false);
    } else {
      // One too soft for 1/shear to be a number is none.
      const double rate = h * tangential_stiffness, shear = friction > 0.0 && rate >= 0x1p-1022 ? rate : 0.0;
      rub(node, node.impulse.n, shear * spring, 1.0);
      const double per_impulse = shear > 0.0 ? 1.0 / shear : 0.0;
      const double moves = shear > 0.0 ? node.position_step : 0.0;
      const double strains = node.impulse.n > 0.0 ? moves : 0.0;
      const vector v = node.v_free + node.delassus.times(node.impulse);
      kept = {0.0, 0.0 - per_impulse * node.impulse.t1, 0.0 - per_impulse * node.impulse.t2};
      next = {0.0, kept.t1 + strains * v.t1, kept.t2 + strains * v.t2};
    }
    if (node.state.indentation != 0.0) node.refused = impossible_state;
    node.state = {0.0, next};
    // Levels as in the discrete energy of the central-difference scheme, 1/2 k g_n g_{n+1}; see penalty.md.
    const vector v = node.v_free + node.delassus.times(node.impulse), mean = node.v_previous + v;
    const double normal = potential<Kind>(penetration) - 0.5 * elastic / h * node.position_step * v.n;
    node.stored = positive_part(normal + tangential_potential(kept, next));
    node.normal_gain = -0.5 * elastic * mean.n;
    node.tangential_gain = tangential_product(node.impulse, (1.0 / h) * (spring - kept) - 0.5 * mean);
  }
};

template <bool Implicit, spring_kind Kind>
struct penalty::form : penalty {
  double damping_ratio;

  static constexpr bool is_always_stable = Implicit, needs_previous = Implicit;
  template <class Node>
  double stable_velocity_step(const Node& node) const {
    if constexpr (Kind == spring_kind::any) return penalty::stable_velocity_step(node);
    if constexpr (Kind == spring_kind::smooth) return stable_step_at(step_falls_with(node));
    if constexpr (is_linear(Kind)) return stable_with(node, stiffness);
    return stable_with(node, 1.5 * stiffness * square_root(positive_part(-node.gap)));
  }
  template <class Node>
  double step_falls_with(const Node& node) const requires(Kind == spring_kind::smooth) {
    return node.delassus.normal();
  }
  double stable_step_at(double h) const { return penalty_law::stable_step(h, stiffness, damping); }

  // What has a root to find is solved in packs: springs that are not linear, and friction where H has more
  // than one tangential entry.
  static constexpr bool may_stick_rigidly = penalty_law::sticks_rigidly(Kind) || Kind == spring_kind::any;
  template <class V>
  using rubbing =
      std::conditional_t<may_stick_rigidly, penalty_law::rigid_rubbing<V>, penalty_law::rubbing<V>>;
  template <class V>
  using problem = std::conditional_t<is_smooth(Kind), penalty_law::pressing<V>, rubbing<V>>;
  template <class V>
  using answer = std::conditional_t<is_smooth(Kind), penalty_law::pressed<V>, penalty_law::rubbed<V>>;
  static constexpr bool answers_every_node = true;
  template <class Node>
  static constexpr bool finds_roots =
      Implicit&& Kind != spring_kind::smooth && !(is_linear(Kind) && has_transverse_delassus<Node>);

  template <class Node>
  void step(Node& node) const requires(!finds_roots<Node>) {
    if constexpr (Implicit)
      step_implicitly<Kind>(node, damping_ratio);
    else
      step_explicitly<Kind>(node);
  }

  template <class Node>
  bool asks(Node& node, problem<double>& open) const requires finds_roots<Node> {
    open.step = node.velocity_step;
    open.free = node.v_free.n;
    open.previous = node.v_previous.n;
    open.delassus = node.delassus.normal();
    open.indentation = indentation_of(node);
    if constexpr (!is_smooth(Kind) && !has_transverse_delassus<Node>) {
      const vector q = 0.5 * sliding_velocity<Kind>(node, 0.0);
      penalty_law::couple(open, node.delassus, q, 0.5 * softness_of(node));
      if constexpr (may_stick_rigidly) {
        const bool rigid = sticks_rigidly<Kind>();
        open.before1 = kept_if(rigid, node.v_previous.t1);
        open.before2 = kept_if(rigid, node.v_previous.t2);
      }
    }
    const bool acts = acts_on(node), may_push = penalty_law::may_push<is_plain(Kind)>(open);
    answered(node, {});
    return acts & may_push;
  }
  template <class Problem, class Answer>
  auto solve(const Problem& p, Answer& a) const {
    const mask_of<decltype(p.step)> all(true);
    if constexpr (Kind == spring_kind::any) return all;
    if (stiffness == infinity) return all;
    const auto spring = spring_of(penalty_law::first_of(p.step), damping_ratio);
    return penalty_law::solve<is_linear(Kind), is_plain(Kind)>(spring, friction, p, a);
  }
  void solve_alone(const problem<double>& p, answer<double>& a) const {
    if constexpr (may_stick_rigidly) {
      if (!is_like_scalar(p)) return stick_alone(p, a);
      a = penalty_law::stick_like_scalar(p, [this](const penalty_law::rubbing<double>& held) {
        return solve_by_brackets({held, 0.0, 0.0});
      });
    } else if constexpr (is_smooth(Kind)) {
      const auto found = solve_by_brackets({p, 0.0, 0.0});
      a = {found.impulse, found.indentation};
    } else {
      a = solve_by_brackets({p, 0.0, 0.0});
    }
  }
  penalty_law::rubbed<double> solve_by_brackets(const penalty_law::rigid_rubbing<double>& p) const {
    const auto spring = spring_of(p.step, damping_ratio);
    return penalty_law::solve_alone(spring, friction, restitution, p);
  }
  // By the solver of packs while one e_T after the other will do.
  void stick_alone(const problem<double>& p, answer<double>& a) const {
    if (Kind == spring_kind::any || stiffness == infinity) {
      a = solve_by_brackets(p);
      return;
    }
    const auto solve_held = [this](const penalty_law::rubbing<double>& held) { return solve_regular(held); };
    const auto found = penalty_law::stick(p, solve_held);
    a = found.settled ? found.answer : solve_by_brackets(p);
  }
  // Not inlined: most nodes are solved in packs.
  [[gnu::noinline]] penalty_law::rubbed<double> solve_regular(penalty_law::rubbing<double> p) const {
    penalty_law::rubbed<double> a{};
    if (solve(p, a)) a.outcome = penalty_law::has_none;
    return a;
  }
  template <class Node>
  void answered(Node& node, const answer<double>& a) const {
    if constexpr (!is_smooth(Kind)) {
      const bool fails = a.outcome == penalty_law::has_none;
      node.refused = larger(node.refused, fails ? no_solution : not_refused);
    }
    if constexpr (is_smooth(Kind) || has_transverse_delassus<Node>) {
      give<Kind>(node, a.impulse, a.indentation);
    } else {
      node.impulse = {a.impulse, a.t1, a.t2};
      store<Kind>(node, a.indentation, strained<Kind>(node, tell(node, a.outcome != penalty_law::sticks)));
    }
  }
};

template <class Run>
void penalty::in_form(Run run) const {
  const double ratio = restitution < 1.0 ? penalty_law::damping_ratio(restitution) : 0.0;
  const bool loses = restitution < 1.0 || damping > 0.0, is_soft = exponent == 1.0 && stiffness < infinity;
  const bool implicit = integration == implicitly, rubs = friction > 0.0;
  const bool sticks_rigidly = implicit && rubs && tangential_stiffness == infinity;
  const bool keeps = is_soft && implicit && !loses && stiffness > 0.0;
  const auto run_kind = [&]<spring_kind Kind>() {
    implicit ? run(form<true, Kind>{*this, ratio}) : run(form<false, Kind>{*this, ratio});
  };
  if (is_soft && !rubs && !(implicit && loses)) return run_kind.template operator()<spring_kind::smooth>();
  if (keeps && sticks_rigidly) return run(form<true, spring_kind::sticking_plain>{*this, ratio});
  if (keeps) return run(form<true, spring_kind::plain>{*this, ratio});
  const bool is_linear = exponent == 1.0 || stiffness == infinity;
  if (is_linear && sticks_rigidly) return run(form<true, spring_kind::sticking_linear>{*this, ratio});
  if (is_linear) return run_kind.template operator()<spring_kind::linear>();
  if (exponent == 1.5 && implicit && !rubs) return run(form<true, spring_kind::smooth_hertz>{*this, ratio});
  if (exponent == 1.5 && sticks_rigidly) return run(form<true, spring_kind::sticking_hertz>{*this, ratio});
  if (exponent == 1.5) return run_kind.template operator()<spring_kind::hertz>();
  run_kind.template operator()<spring_kind::any>();
}

}  // namespace

ILAW_PLUGIN("penalty", "1.0.0", "ilaw", "BSD-3-Clause", penalty)
