// Rigid, perfectly brittle adhesion that heals under pressure, with contact and friction. See postit.md.
#include <ilaw/kit.hpp>
#include <ilaw/kit/window.hpp>

namespace {

using namespace ilaw::kit;

constexpr const char* rupture_choices[] = {"brittle", "saturated"};
constexpr double saturated = 1.0;

// A pull exactly at the limit holds, whatever the rounding of its windowed sum; the criterion is of its
// square.
constexpr double at_the_limit = 1.0 + 2.0 * window_slack;

struct postit {
  double adhesion_limit;
  double efficiency_decrease;
  double duration;  // of the window
  double tangent_influence;
  double friction;
  double rupture;
  double initial_adhesion;
  double buckets;

  static constexpr law_card card{
      .id = "postit",
      .title = "Healing brittle adhesion with friction",
      .doc =
          "Rigid bond that breaks when the impulses of the last memory exceed its adhesion, and forms again "
          "under "
          "pressure, each time less after a rupture; contact with Coulomb friction where it is not bonded.",
      .inputs = reads_gap | reads_v_previous | reads_area,
      .capabilities = ILAW_CAN_ADHERE | ILAW_CAN_ACT_AT_DISTANCE | ILAW_CAN_REST};

  static constexpr const char* references[] = {
      "LaMCoS / Michelin, 2024, Post-it tests (slides), after hal-04146784: parameters, tests, windowed "
      "rupture",
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
       .doc = "brittle: the breaking step gives no adhesive impulse; saturated: it gives what was left up to "
              "the "
              "limit.",
       .choices = rupture_choices,
       .choice_count = 2},
      {.member = &postit::initial_adhesion,
       .name = "initial_adhesion",
       .symbol = "R_Y,0",
       .unit = "N.s/m^2",
       .doc = "Adhesion per area at the start."},
      buckets_parameter(&postit::buckets)};

  struct state {
    double adhesion, ruptures, grace;
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
  static constexpr history_card history_variable = window_variable;

  std::uint32_t inputs() const {
    return reads_gap | reads_v_previous |
           (adhesion_limit < infinity || initial_adhesion > 0.0 ? reads_area : 0U);
  }
  // What is bonded from the start holds at any gap.
  std::uint32_t capabilities() const {
    return std::uint32_t{ILAW_CAN_ADHERE | ILAW_CAN_REST} |
           (initial_adhesion > 0.0 ? std::uint32_t{ILAW_CAN_ACT_AT_DISTANCE} : 0U);
  }
  const char* conflict() const {
    return initial_adhesion > adhesion_limit
               ? "parameter 'initial_adhesion' is larger than 'adhesion_limit', expected "
                 "at most that"
               : nullptr;
  }
  std::int64_t history_size() const { return window::doubles(duration, buckets); }

  template <class Node>
  void initialise(Node& node) const {
    node.state.adhesion = initial_adhesion > 0.0 ? initial_adhesion * node.area : 0.0;
  }

  template <class Node>
  void step(Node& node) const {
    const window::reading earlier = sums().before(node.history, interval_of(node));
    node.refused = earlier.refused;
    if (node.refused != not_refused) return;
    if (node.state.adhesion > 0.0)
      step_bonded(node, earlier.sum);
    else
      step_unbonded(node);
    heal(node, node.status == status::broken ? vector{} : earlier.sum);
  }

  // A rupture clears the window; what it then holds is the impulse of this step.
  template <class Node>
  void record(const Node& node, history own) const {
    if (node.status == status::broken) sums().clear(own);
    sums().add(own, interval_of(node), node.impulse);
  }

 private:
  window sums() const { return {duration, buckets}; }

  // (<-S_N>/R_Y)^2 + (<|S_T| - mu <S_N>>/(lambda R_Y))^2, which exceeds 1 at rupture.
  double criterion(vector sum, double adhesion) const {
    const double pull = positive_part(-sum.n) / adhesion;
    const double held_by_friction = friction_limit(friction, sum.n);
    const double shear =
        positive_part(sum.tangential_length() - held_by_friction) / (tangent_influence * adhesion);
    return pull * pull + shear * shear;
  }

  // Free: the next rupture counts.
  template <class Node>
  void step_unbonded(Node& node) const {
    touch(node, node.v_free, {});
    if (node.status == status::free) node.state.grace = 0.0;
  }

  template <class Node>
  void step_bonded(Node& node, vector earlier) const {
    const vector trial = stopping_impulse(node);
    if (criterion(earlier + trial, node.state.adhesion) <= at_the_limit) {
      node.impulse = trial;
      node.status = status::bonded;
      node.state.grace = still_to_hold(node.state.grace, node.velocity_step);
      return;
    }
    const vector held =
        rupture == saturated ? held_part(earlier, trial, node.state.adhesion) * trial : vector{};
    node.state.adhesion = 0.0;
    count_rupture(node.state, node.velocity_step);
    touch(node, node.v_free + node.delassus.times(held), held);
    node.status = status::broken;
  }

  // Sliding under pressure bonds and breaks in every step. A rupture counts only if the node was free since
  // the last one, or the bond held for the window, and for one step at least.
  void count_rupture(state& s, double step) const {
    if (s.grace == 0.0) s.ruptures += 1.0;
    s.grace = smaller(larger(duration, step), std::numeric_limits<double>::max());
  }
  static double still_to_hold(double grace, double step) {
    const double rest = grace - step;
    return rest > window_slack * step ? rest : 0.0;
  }

  // The part of the trial impulse that takes the sum to the limit; bisection to the last bit.
  double held_part(vector earlier, vector trial, double adhesion) const {
    double holds = 0.0, breaks = 1.0;
    if (criterion(earlier, adhesion) > 1.0) return 0.0;
    for (double middle = 0.5; middle > holds && middle < breaks; middle = 0.5 * (holds + breaks))
      (criterion(earlier + middle * trial, adhesion) <= 1.0 ? holds : breaks) = middle;
    return holds;
  }

  // Contact and friction, on top of what a breaking bond still gave.
  template <class Node>
  void touch(Node& node, vector velocity, vector held) const {
    apply_plain_contact(node, velocity, friction);
    node.impulse = node.impulse + held;
  }

  // Pressing bonds: R_Y = max(R_Y, min(eta(b) <S_N>, R_Y,max)).
  template <class Node>
  void heal(Node& node, vector earlier) const {
    if (!(node.impulse.n > 0.0)) return;
    const double efficiency =
        efficiency_decrease < infinity ? exp(-node.state.ruptures / efficiency_decrease) : 1.0;
    const double limit = adhesion_limit < infinity ? adhesion_limit * node.area : infinity;
    const double gained = smaller(efficiency * positive_part(earlier.n + node.impulse.n), limit);
    const bool forms = node.state.adhesion == 0.0 && gained > 0.0 && node.status != status::broken;
    node.state.adhesion = larger(node.state.adhesion, gained);
    if (forms) node.status = status::healed;
  }
};

}  // namespace

ILAW_PLUGIN("postit", "1.0.0", "ilaw", "BSD-3-Clause", postit)
