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
      .capabilities = ILAW_CAN_ADHERE | acts_at_distance | can_rest,
      .state_version = 2};

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

  static constexpr std::uint32_t always_reads = reads_gap | reads_v_previous;
  std::uint32_t inputs() const {
    return always_reads | (adhesion_limit < infinity || initial_adhesion > 0.0 ? reads_area : 0U);
  }
  // What is bonded from the start holds at any gap.
  std::uint32_t capabilities() const {
    return ILAW_CAN_ADHERE | can_rest | (initial_adhesion > 0.0 ? acts_at_distance : 0U);
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

  // Brittle or saturated: what is left of a bond that breaks is one more root to find. A bond that does not
  // wear needs no exponential.
  template <bool Saturated, bool Wears>
  struct form;
  template <class Run>
  void in_form(Run run) const;
  template <class Node>
  void step(Node& node) const {
    in_form([&node](const auto& chosen) { step_alone(chosen, node); });
  }

  window_in_step window_in(step_interval step) const { return {duration, buckets, step}; }
  // Neither bonded nor waiting for a rupture to count: out of reach it stays so.
  static bool rests(const state& s) { return (s.adhesion == 0.0) & (s.grace == 0.0); }
  // A rupture clears the window; what it then holds is the impulse of this step.
  static bool adds_to_window(double /*s*/) { return true; }
  static bool clears_window(double s) { return s == status::broken; }

 private:
  // -S_N <= R_Y times the root of a factor near 1: what an infinite lambda leaves of the criterion below.
  static double margin_of_pull(double sum_n, double adhesion, double factor) {
    return sum_n + (0.5 + 0.5 * factor) * adhesion;
  }
  // <-S_N>^2 + (<|S_T| - mu <S_N>>/lambda)^2 <= R_Y^2 times a factor, without a division by R_Y: both sides
  // are brought near 1 by a power of two. False where S has overflowed.
  bool is_within(vector sum, double adhesion, double factor) const {
    constexpr double largest = std::numeric_limits<double>::max();
    const double of_pull = margin_of_pull(sum.n, adhesion, factor);
    const double scale = power_scale_of(adhesion).down, limit = scale * adhesion;
    const vector s = scale * sum;
    const double pull = positive_part(-s.n), held_by_friction = friction_limit(friction, s.n);
    const double length = square_root(s.t1 * s.t1 + s.t2 * s.t2);
    const double shear = positive_part(length - held_by_friction) * smaller(1.0 / tangent_influence, largest);
    const double of_both = factor * (limit * limit) - (pull * pull + shear * shear);
    return chosen(tangent_influence == infinity, of_pull, of_both) >= 0.0;
  }

  template <class Node>
  bool holds(const Node& node, vector trial) const {
    const double adhesion = node.state.adhesion;
    return (adhesion > 0.0) & is_within(node.earlier + trial, adhesion, at_the_limit);
  }

  // The part of the trial impulse that takes the sum to the limit; bisection to the last bit.
  double held_part(vector earlier, vector trial, double adhesion) const {
    double holds = 0.0, breaks = 1.0;
    if (!is_within(earlier, adhesion, 1.0)) return 0.0;
    for (double middle = 0.5; middle > holds && middle < breaks; middle = 0.5 * (holds + breaks))
      (is_within(earlier + middle * trial, adhesion, 1.0) ? holds : breaks) = middle;
    return holds;
  }

  // The largest part up to 1 of r that may join what is held, so that the work of both, which is
  // (held + r).(v^- + v_free + H (held + r))/2, is not positive; that of what is held alone counts as none.
  template <class Node>
  static double joining_part(const Node& node, vector held, vector r) {
    const auto product = [](vector a, vector b) { return normal_product(a, b) + tangential_product(a, b); };
    const vector of_held = node.delassus.times(held), motion = node.v_previous + node.v_free + of_held;
    const double c2 = product(r, node.delassus.times(r)), c1 = product(r, motion + of_held);
    const fraction<double> root = root_of_work(c2, c1, smaller(product(held, motion), 0.0));
    return root.over < root.under ? root.over / root.under : 1.0;
  }
  // What is held and then contact and friction do no positive work each, and yet may together: friction is
  // scaled first, as where there is no bond, and then contact with it, if that was not enough.
  template <class Node>
  static vector joined(const Node& node, vector held, vector r) {
    const vector rubs{0.0, r.t1, r.t2};
    r = vector{r.n, 0.0, 0.0} + joining_part(node, held + vector{r.n, 0.0, 0.0}, rubs) * rubs;
    return held + joining_part(node, held, r) * r;
  }

  // What the step makes of the bond: the node comes with the impulse of contact, is given the trial impulse
  // where its bond holds, and heals.
  template <bool Wears, class Node>
  void settle(Node& node, vector trial, bool holds) const {
    const bool was_bonded = node.state.adhesion > 0.0, breaks = was_bonded & !holds;
    const bool is_free = !(node.impulse.n > 0.0);
    node.impulse = {holds ? trial.n : node.impulse.n, holds ? trial.t1 : node.impulse.t1,
                    holds ? trial.t2 : node.impulse.t2};
    node.status = holds ? status::bonded : (breaks ? status::broken : node.status);
    count_rupture(node.state, node.velocity_step, breaks, holds, is_free);
    const double summed = breaks ? 0.0 : node.earlier.n;
    heal<Wears>(node, summed, was_bonded, breaks);
  }

  // Sliding under pressure bonds and breaks in every step. A rupture counts only if the node was free since
  // the last one, or the bond held for the window, and for one step at least.
  void count_rupture(state& s, double step, bool breaks, bool holds, bool is_free) const {
    const double whole = smaller(larger(duration, step), std::numeric_limits<double>::max());
    const double rest = s.grace - step, left = rest > window_slack * step ? rest : 0.0;
    s.ruptures = s.ruptures + kept_if(breaks & (s.grace == 0.0), 1.0);
    const double held = chosen(holds, left, kept_if(!is_free, s.grace));
    s.grace = chosen(breaks, whole, held);
  }

  // Pressing bonds: R_Y = max(R_Y, min(eta(b) <S_N>, R_Y,max)). A rupture has cleared the window.
  template <bool Wears, class Node>
  void heal(Node& node, double summed, bool was_bonded, bool breaks) const {
    double efficiency = 1.0;
    if constexpr (Wears) efficiency = exp(-node.state.ruptures / efficiency_decrease);
    const double limit = adhesion_limit * node.area;  // not a number: inf, and no area is read
    const double pressed = efficiency * (summed + node.impulse.n);
    const double gained = kept_if(node.impulse.n > 0.0, limit < pressed ? limit : pressed);
    node.state.adhesion = larger(gained, kept_if(!breaks, node.state.adhesion));
    const bool forms = !was_bonded & (gained > 0.0);
    node.status = forms ? status::healed : node.status;
  }
};

// Nodes that touch are asked for their friction, for any H; a transverse H has a closed form.
template <bool Saturated, bool Wears>
struct postit::form : postit, friction_in_packs {
  // What only a pull breaks has a shorter step in the usual case.
  struct pulled;
  using form_of_try = pulled;
  bool has_form_of_try() const { return tangent_influence == infinity; }

  template <class Node>
  void step(Node& node) const requires(Saturated || has_transverse_delassus<Node>) {
    const vector trial = stopping_impulse(node);
    const bool holds = this->holds(node, trial);
    if constexpr (Saturated) {
      const bool breaks = node.state.adhesion > 0.0 && !holds;
      const vector held = breaks ? held_part(node.earlier, trial, node.state.adhesion) * trial : vector{};
      apply_plain_contact(node, node.v_free + node.delassus.times(held), friction);
      if (breaks) node.impulse = joined(node, held, node.impulse);
    } else {
      apply_plain_contact(node, node.v_free, friction);
    }
    settle<Wears>(node, trial, holds);
  }
  // Where nothing turned round within the step, no work is to be taken off.
  template <class Node>
  bool try_step(Node& node) const requires(!Saturated && has_transverse_delassus<Node>) {
    const vector trial = whole_stopping_impulse(node);
    const double work = node.state.adhesion > 0.0 ? positive_part(doubled_work(node, trial)) : 0.0;
    const bool holds = this->holds(node, trial);
    const bool is_usual = try_isotropic_friction(node, plain_contact(node, node.v_free), friction);
    settle<Wears>(node, trial, holds);
    return work + (is_usual ? 0.0 : 1.0) == 0.0;
  }
  template <class Node>
  bool asks(Node& node, friction_problem<double>& open) const
      requires(!Saturated && !has_transverse_delassus<Node>) {
    const vector trial = stopping_impulse(node);
    const bool holds = this->holds(node, trial);
    const bool is_pressed = ask_friction(node, plain_contact(node, node.v_free), friction, open);
    settle<Wears>(node, trial, holds);
    return is_pressed & !holds;
  }
  template <class Node>
  void answered(Node& node, const friction_answer<double>& a) const {
    give_friction(node, a);
    settle<Wears>(node, {}, false);
  }
};

// A bond is asked for the impulse that stops it, another node for contact and friction: one division gives
// the normal part of either, and one the tangential part. Not usual is what asks for both, a bond that breaks
// while it is pressed. Choices are by bits where GCC would else make branches of them.
template <bool Saturated, bool Wears>
struct postit::form<Saturated, Wears>::pulled : form {
  template <class Node>
  bool try_step(Node& node) const requires has_transverse_delassus<Node> {
    const bool was_bonded = node.state.adhesion > 0.0;
    const auto contact = plain_contact(node, node.v_free);
    const double of_normal = (was_bonded ? 1.0 : -contact.q.n) / node.delassus.normal();
    const double pressed = kept_if(!was_bonded & (contact.slack <= 0.0), positive_part(of_normal));
    const auto speed = contact.q.scaled_tangential_length();
    const auto rubs =
        rub(node.delassus.tangential(), pressed, was_bonded ? 0.0 : speed.root(), {}, friction, speed.down);
    const double from = kept_if(was_bonded, -0.0);  // the trial's zeros are -0
    const vector r{-(of_normal * node.v_free.n), from - rubs.factor * node.v_free.t1,
                   from - rubs.factor * node.v_free.t2};
    const auto turns = turning_at(node.delassus, pressed, contact, speed);
    const double gain = was_bonded ? doubled_work(node, r) : turns.impact - turns.along;
    const double closed = pressed > 0.0 ? rubs.status : status::free;
    const bool breaks = settle_pulled(node, r, pressed, closed);
    return larger(gain, kept_if(breaks, -contact.q.n)) <= 0.0;
  }

 private:
  template <class Node>
  bool settle_pulled(Node& node, vector r, double pressed, double closed) const {
    const double adhesion = node.state.adhesion;
    const bool is_carried = margin_of_pull(node.earlier.n + r.n, adhesion, at_the_limit) >= 0.0;
    const bool was_bonded = adhesion > 0.0, holds = was_bonded & is_carried,
               breaks = was_bonded & !is_carried;
    node.impulse = {chosen(holds, r.n, pressed), kept_if(!breaks, r.t1), kept_if(!breaks, r.t2)};
    node.status = was_bonded ? (is_carried ? status::bonded : status::broken) : closed;
    count_rupture(node.state, node.velocity_step, breaks, holds, !(pressed > 0.0));
    heal<Wears>(node, node.earlier.n, was_bonded, breaks);
    return breaks;
  }
};

template <class Run>
void postit::in_form(Run run) const {
  if (rupture == saturated)
    run(form<true, true>{{*this}, {}});
  else if (efficiency_decrease < infinity)
    run(form<false, true>{{*this}, {}});
  else
    run(form<false, false>{{*this}, {}});
}

}  // namespace

ILAW_PLUGIN("postit", "1.0.0", "ilaw", "BSD-3-Clause", postit)
