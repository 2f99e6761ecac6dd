// Rigid, perfectly brittle adhesion that heals under pressure, with contact and friction. See postit.md.
#include <ilaw/kit.hpp>
#include <ilaw/kit/rigid_bond.hpp>
#include <ilaw/kit/roots.hpp>
#include <ilaw/kit/window.hpp>

namespace {

using namespace ilaw::kit;

constexpr const char* rupture_choices[] = {"brittle", "saturated"};
constexpr double saturated = 1.0;

// A pull exactly at the limit holds, whatever the rounding of its windowed sum; the criterion is of its
// square.
constexpr double at_the_limit = 1.0 + 2.0 * window_slack;

template <class V>
struct postit {
  V adhesion_limit;
  V efficiency_decrease;
  double duration;  // of the window
  V tangent_influence;
  V friction;
  double rupture;
  V initial_adhesion;
  double buckets;

  static constexpr law_card card{
      .id = "postit",
      .title = "Healing brittle adhesion with friction",
      .doc =
          "Rigid bond that breaks when the impulses of the last memory exceed its adhesion, and forms again under "
          "pressure, each time less after a rupture; contact with Coulomb friction where it is not bonded.",
      .inputs = reads_gap | reads_v_previous | reads_area,
      .capabilities = can_adhere | can_hold_bonds,
      .permissions = may_skip_free,
      .state_version = 2};

  static constexpr const char* references[] = {
      "LaMCoS / Michelin, 2024, Post-it tests (slides), after hal-04146784: parameters, tests, windowed rupture",
      "J.-J. Moreau, 1988, Unilateral contact and dry friction in finite freedom dynamics"};

  static constexpr parameter<postit> parameters[] = {
      {.member = &postit::adhesion_limit,
       .name = "adhesion_limit",
       .symbol = "R_Y,max",
       .unit = "N.s/m^2",
       .doc = "Largest adhesion per area that pressing can give.",
       .default_value = infinity,
       .infinity_allowed = true},
      {.member = &postit::efficiency_decrease,
       .name = "efficiency_decrease",
       .symbol = "n_b",
       .doc = "Number of ruptures that divides the efficiency of pressing by e: eta = exp(-b/n_b).",
       .default_value = infinity,
       .minimum_excluded = true,
       .infinity_allowed = true},
      memory_parameter(&postit::duration),
      {.member = &postit::tangent_influence,
       .name = "tangent_influence",
       .symbol = "lambda",
       .doc = "Tangential adhesion over normal adhesion; inf: only the normal part breaks the bond.",
       .default_value = infinity,
       .minimum_excluded = true,
       .infinity_allowed = true},
      friction_parameter(&postit::friction),
      {.member = &postit::rupture,
       .name = "rupture",
       .doc =
           "brittle: the breaking step gives no adhesive impulse; saturated: it gives what was left up to the limit.",
       .choices = rupture_choices},
      {.member = &postit::initial_adhesion,
       .name = "initial_adhesion",
       .symbol = "R_Y,0",
       .unit = "N.s/m^2",
       .doc = "Adhesion per area at the start."},
      buckets_parameter(&postit::buckets)};

  struct state {
    V adhesion, ruptures, grace;
  };
  static constexpr state_variable<state> state_variables[] = {
      {.member = &state::adhesion,
       .name = "adhesion",
       .unit = "N.s",
       .doc = "Adhesion of the node; 0 when it is not bonded.",
       .minimum = 0.0},
      {.member = &state::ruptures,
       .name = "ruptures",
       .doc = "Number of ruptures that counted so far.",
       .minimum = 0.0,
       .whole = true},
      {.member = &state::grace,
       .name = "grace",
       .unit = "s",
       .doc = "Time that the bond has yet to hold for its rupture to count; 0: it counts.",
       .minimum = 0.0}};

  // A rupture clears the window; what it then holds is the impulse of this step.
  static constexpr history_card history = window_variable;
  window_size window() const { return {duration, buckets}; }
  static constexpr bool adds_to_window(ilaw_status) { return true; }
  static constexpr bool clears_window(ilaw_status s) { return s == ILAW_BROKEN; }

  std::uint32_t inputs() const {
    const bool has_area = adhesion_limit < infinity || initial_adhesion > 0.0;
    return reads_gap | reads_v_previous | (has_area ? reads_area : 0U);
  }
  // An initial bond holds at any gap.
  std::uint32_t permissions() const { return may_skip_free | (initial_adhesion > 0.0 ? 0U : may_skip_fresh); }
  const char* conflict() const {
    if (initial_adhesion <= adhesion_limit) return nullptr;
    return "parameter 'initial_adhesion' is larger than 'adhesion_limit', expected at most that";
  }
  template <class Node>
  void initialise(Node& node) const {
    node.state.adhesion = initial_adhesion * node.area;
  }

  // Friction in closed form where H is transverse; elsewhere nodes that touch are asked for it.
  template <class Node>
  status_of<V> step(Node& node) const requires is_transverse<Node> {
    const trial bond = tried(node);
    return settle(node, bond, apply_isotropic_friction(node, contact_beside(node, bond), friction));
  }
  using problem = friction_problem<V>;
  using answer = friction_answer<V>;
  template <class Node>
  asked<V> ask(Node& node, problem& open) const requires(!is_transverse<Node>) {
    const trial bond = tried(node);
    const asked<V> pressed = ask_friction(node, contact_beside(node, bond), friction, friction, open);
    return {pressed.open & !bond.holds, settle(node, bond, pressed.status)};
  }
  static mask_of<V> solve(const problem& p, answer& a) { return solve_friction(p, a); }
  static void solve_scalar(const problem& p, answer& a) { solve_friction_exactly(p, a); }
  template <class Node>
  status_of<V> finish(Node& node, const answer& a) const {
    return settle(node, tried(node), finish_friction(node, a));
  }

 private:
  // The bond is tried with r, which stops the node. Where it breaks it keeps a part of it.
  struct trial {
    vector<V> r, kept;
    mask_of<V> holds, breaks;
  };
  template <class Node>
  trial tried(const Node& node) const {
    const V adhesion = node.state.adhesion;
    const vector<V> r = stopping_impulse(node.delassus, node.v_free, node.v_previous);
    const mask_of<V> was_bonded = adhesion > 0.0;
    const mask_of<V> holds = bond_holds(node, was_bonded,
                                        [&]() ILAW_KIT_LAMBDA {
                                          return is_within(node.earlier + r, adhesion, at_the_limit);
                                        }),
                     breaks = was_bonded & !holds;
    vector<V> kept;  // takes the sum to the limit
    const auto within = [&](V part) { return is_within(node.earlier + part * r, adhesion, 1.0); };
    if (rupture == saturated && any(breaks))
      kept = zero_unless(breaks, last_part<V>(within(0.0), within) * r);
    return {r, kept, holds, breaks};
  }
  template <class Node>
  contact_problem<vector<V>> contact_beside(const Node& node, const trial& bond) const {
    vector<V> v = node.v_free;
    if (rupture == saturated) v = v + node.delassus.times(bond.kept);
    return contact_without_bond(node, v);
  }

  // <-S_N>^2 + (<|S_T| - mu <S_N>>/lambda)^2 <= R_Y^2 times a factor near 1, without a division by R_Y: both
  // sides are brought near 1 by a power of two. False where S has overflowed.
  mask_of<V> is_within(vector<V> sum, V adhesion, double factor) const {
    const V of_pull = sum.n + (0.5 + 0.5 * factor) * adhesion;
    if (!any(tangent_influence < infinity)) return of_pull >= 0.0;
    const V scale = power_scale_of(adhesion).down, limit = scale * adhesion;
    const vector<V> s = scale * sum;
    const V pull = positive_part(-s.n), length = square_root(s.t1 * s.t1 + s.t2 * s.t2);
    const V by_lambda = smaller(1.0 / tangent_influence, V(std::numeric_limits<double>::max()));
    V excess = length - friction_limit(friction, s.n);
    if (any(excess != excess))  // both overflowed, beside an adhesion that is as good as none
      excess = select(excess == excess, excess,
                      scale * (sum.tangential_length() - friction_limit(friction, sum.n)));
    const V shear = positive_part(excess) * by_lambda;
    const V of_both = factor * (limit * limit) - (pull * pull + shear * shear);
    return select(tangent_influence == infinity, of_pull, of_both) >= 0.0;
  }

  // The node comes with the impulse of contact, is given that of its bond, and heals.
  template <class Node>
  status_of<V> settle(Node& node, const trial& bond, status_of<V> of_contact) const {
    if (rupture == saturated && any(bond.breaks))
      node.impulse = select(bond.breaks, joined(node, bond.kept, node.impulse), node.impulse);
    count_rupture(node.state, node.velocity_step, bond, node.impulse.n > 0.0);
    node.impulse = select(bond.holds, bond.r, node.impulse);
    const mask_of<V> was_bonded = bond.holds | bond.breaks, heals = heal(node, bond);
    const status_of<V> open = select(bond.breaks, status_of<V>(status::broken), of_contact);
    const status_of<V> given = select(bond.holds, status_of<V>(status::bonded), open);
    return select(heals & !was_bonded, status_of<V>(status::healed), given);
  }

  // Sliding under pressure bonds and breaks in every step. A rupture counts only if the node was free since
  // the last one, or the bond held for the window, and for one step at least.
  void count_rupture(state& s, double step, const trial& bond, mask_of<V> touches) const {
    const double whole = smaller(larger(duration, step), std::numeric_limits<double>::max());
    const V rest = s.grace - step, left = zero_unless(rest > window_slack * step, rest);
    s.ruptures = s.ruptures + zero_unless(bond.breaks & (s.grace == 0.0), V(1.0));
    s.grace = select(bond.breaks, V(whole), select(bond.holds, left, zero_unless(touches, s.grace)));
  }

  // Pressing bonds: R_Y = max(R_Y, min(eta(b) <S_N>, R_Y,max)). A rupture has cleared the window.
  template <class Node>
  mask_of<V> heal(Node& node, const trial& bond) const {
    V efficiency = 1.0;
    if (any(efficiency_decrease < infinity)) efficiency = exp(-node.state.ruptures / efficiency_decrease);
    const V limit = adhesion_limit * node.area;  // not a number: inf, and no area is read
    const V summed = zero_unless(!bond.breaks, node.earlier.n);
    const V pressed = efficiency * (summed + node.impulse.n);
    const V gained = zero_unless(node.impulse.n > 0.0, select(limit < pressed, limit, pressed));
    node.state.adhesion = larger(gained, zero_unless(!bond.breaks, node.state.adhesion));
    return gained > 0.0;
  }
};

}  // namespace

ILAW_PLUGIN("postit", "1.0.0", "ilaw", "BSD-3-Clause", postit)
