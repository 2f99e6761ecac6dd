// Cohesive zones: a bond that softens, with contact, friction and bounded damage rate. See cohesive.md.
#include "bond.hpp"
#include "coupled.hpp"
#include "gathered.hpp"
#include "isotropic.hpp"
#include "touching.hpp"

#include <ilaw/kit.hpp>

namespace {

using namespace cohesive_law;

constexpr const char* shape_choices[] = {"bilinear", "exponential", "camacho_ortiz"};

struct cohesive : bond {
  static constexpr law_card card{
      .id = "cohesive",
      .title = "Cohesive zone with contact, friction and delayed damage",
      .doc =
          "Bond that holds up to its strength, then softens until its toughness is spent; unloads to the "
          "origin; contact and friction take over as it breaks. Solved with any H for any initial stiffness, "
          "also infinite, without a limit on the time step.",
      .inputs = reads_gap | reads_v_previous | reads_area,
      .capabilities = ILAW_CAN_ADHERE | ILAW_CAN_STORE_ENERGY | acts_at_distance | can_rest};

  static constexpr const char* references[] = {
      "G. T. Camacho, M. Ortiz, 1996, Computational modelling of impact damage in brittle materials",
      "M. L. Benzeggagh, M. Kenane, 1996, Measurement of mixed-mode delamination fracture toughness",
      "A. Turon, P. P. Camanho, J. Costa, C. G. Davila, 2006, A damage model for the simulation of "
      "delamination in advanced composites under variable-mode loading",
      "G. Alfano, E. Sacco, 2006, Combining interface damage and friction in a cohesive-zone model",
      "O. Allix, J.-F. Deu, 1997, Delayed-damage modelling for fracture prediction of laminated composites "
      "under dynamic loading"};

  static constexpr parameter<cohesive> parameters[] = {
      {.member = &cohesive::shape,
       .name = "shape",
       .doc = "bilinear, exponential: modes mixed by Benzeggagh and Kenane; camacho_ortiz: rigid, then "
              "linear in an effective opening.",
       .choices = shape_choices,
       .choice_count = 3},
      {.member = &cohesive::strength,
       .name = "strength",
       .symbol = "sigma_1",
       .unit = "N/m^2",
       .doc = "Largest normal traction; inf: never breaks, 0: no bond.",
       .required = true,
       .infinity_allowed = true},
      {.member = &cohesive::toughness,
       .name = "toughness",
       .symbol = "G_1",
       .unit = "J/m^2",
       .doc = "Energy per area that opening takes; 0: no bond.",
       .required = true},
      {.member = &cohesive::strength_2,
       .name = "strength_2",
       .symbol = "sigma_2",
       .unit = "N/m^2",
       .doc = "Largest tangential traction; 0: the same as strength.",
       .infinity_allowed = true},
      {.member = &cohesive::toughness_2,
       .name = "toughness_2",
       .symbol = "G_2",
       .unit = "J/m^2",
       .doc = "Energy per area that shear takes; 0: the same as toughness."},
      {.member = &cohesive::mixing_exponent,
       .name = "mixing_exponent",
       .symbol = "eta",
       .doc = "Exponent of Benzeggagh and Kenane, of toughness and of squared strength.",
       .default_value = 1.0,
       .minimum_excluded = true},
      {.member = &cohesive::stiffness,
       .name = "stiffness",
       .symbol = "K",
       .unit = "N/m^3",
       .doc = "Initial stiffness per area; inf: rigid until the strength is reached.",
       .default_value = infinity,
       .minimum_excluded = true,
       .infinity_allowed = true},
      friction_parameter<cohesive>(&cohesive::friction)
          .with_doc("Coefficient of friction of what is broken."),
      {.member = &cohesive::delay_time,
       .name = "delay_time",
       .symbol = "tau_c",
       .unit = "s",
       .doc = "Time that full damage takes at least; 0: damage follows at once."},
      {.member = &cohesive::delay_exponent,
       .name = "delay_exponent",
       .symbol = "a",
       .doc = "How sharply the damage rate reaches its bound 1/tau_c.",
       .default_value = 1.0,
       .minimum_excluded = true}};

  struct state {
    double damage;
    vector position;  // at the time of the next impulse
    vector opening;   // half a step before: the bond's
  };
  static constexpr state_variable<state> state_variables[] = {{.member = &state::damage,
                                                               .name = "damage",
                                                               .doc = "0: intact, 1: broken.",
                                                               .minimum = 0.0,
                                                               .maximum = 1.0},
                                                              {.member = {&state::position, &vector::n},
                                                               .name = "opening",
                                                               .unit = "m",
                                                               .doc = "Normal displacement since the start."},
                                                              {.member = {&state::position, &vector::t1},
                                                               .name = "slip_1",
                                                               .unit = "m",
                                                               .doc = "First tangential displacement."},
                                                              {.member = {&state::position, &vector::t2},
                                                               .name = "slip_2",
                                                               .unit = "m",
                                                               .doc = "Second tangential displacement."},
                                                              {.member = {&state::opening, &vector::n},
                                                               .name = "mean_opening",
                                                               .unit = "m",
                                                               .doc = "Mean of the last two openings.",
                                                               .internal = true},
                                                              {.member = {&state::opening, &vector::t1},
                                                               .name = "mean_slip_1",
                                                               .unit = "m",
                                                               .doc = "Mean of the last two of slip_1.",
                                                               .internal = true},
                                                              {.member = {&state::opening, &vector::t2},
                                                               .name = "mean_slip_2",
                                                               .unit = "m",
                                                               .doc = "Mean of the last two of slip_2.",
                                                               .internal = true}};

  const char* conflict() const {
    if ((strength == infinity) != (shear_strength() == infinity))
      return "parameters 'strength' and 'strength_2' must both be infinite, or both finite";
    if (shape == camacho_ortiz && strength == infinity)
      return "shape \"camacho_ortiz\" weighs shear by the ratio of its strengths: parameter 'strength' must be "
             "finite (a bond that never breaks: \"bilinear\" with 'strength' inf)";
    if (shape == camacho_ortiz && stiffness < infinity)
      return "shape \"camacho_ortiz\" is rigid: parameter 'stiffness' must be inf";
    if (shape == camacho_ortiz && shear_toughness() != toughness)
      return "shape \"camacho_ortiz\" has one toughness: parameter 'toughness_2' must be the same as "
             "'toughness'";
    if (delay_time > 0.0 && stiffness == infinity)
      return "parameter 'delay_time' > 0 needs a finite 'stiffness': the opening of a rigid bond says "
             "nothing of its load";
    if (stores_more(strength, toughness))
      return "parameter 'toughness' is below 'strength'^2/(2 'stiffness'), the energy that the bond stores "
             "when its strength is reached";
    if (stores_more(shear_strength(), shear_toughness()))
      return "parameter 'toughness_2' is below 'strength_2'^2/(2 'stiffness'), the energy that the bond "
             "stores in shear when its strength is reached (0: the same as 'toughness' and 'strength')";
    if (bonds() && mixes() && softness_scale() == infinity)
      return "parameter 'strength_2' is too small: 'toughness_2'/'strength_2'^2, which damage is measured by, "
             "overflows";
    return nullptr;
  }

  template <class Node>
  void initialise(Node& node) const {
    node.state.damage = bonds() ? 0.0 : 1.0;
  }

  // Bonds that surely stand still and nodes that are free are done at once; what is left is gathered.
  struct in_phases;
  template <class Run>
  void in_form(Run run) const;

  template <class Node>
  void step(Node& node) const;
  [[gnu::noinline]] void solve_alone(const gathered<double>& given, solved<double>& found) const {
    auto node = node_of<state>(given);
    if (!(node.state.damage < 1.0 && node.area > 0.0))
      touch(node);
    else if (!bonds())
      break_at_once(node);
    else if (!(stiffness == infinity && node.state.damage == 0.0 && stands_still(node)))
      step_bond(node, given);
    leave(node, found);
  }

 private:
  // A rigid bond up to its strength: the same as a tie. Its traction is compared with the weight of the work
  // that it does.
  static vector effective(vector r, double weight) {
    return {positive_part(-r.n), r.t1 / weight, r.t2 / weight};
  }
  template <class Node>
  bool stands_still(Node& node) const {
    const vector r = stopping_impulse(node), pull = effective(r, weight());
    if (strength < infinity) {
      const double capacity = node.velocity_step * node.area, size = length(pull.n, pull.t1, pull.t2);
      const bool surely = size <= capacity * smaller(strength, shear_strength());
      if (!surely && !(size <= capacity * softening_along(pull, size).strength)) return false;
    }
    node.impulse = r;
    node.status = status::bonded;
    return true;
  }
  // The traction that any rigid bond holds, whatever its direction.
  double sure_strength() const {
    return stiffness == infinity && bonds() ? smaller(strength, shear_strength()) : -1.0;
  }

  template <class Node>
  void step_bond(Node& node, const gathered<double>& given) const {
    if (is_anisotropic(node.delassus))
      solve_bond<coupled_modes>(node, given);
    else
      solve_bond<isotropic_modes>(node, given);
  }

  template <class Modes, class Node>
  void solve_bond(Node& node, const gathered<double>& given) const {
    const auto& s = node.state;
    const double w = weight();
    const double step = node.velocity_step;
    const bool is_new = is_made_now(given);
    double place[3], ground;
    place_bond(given, is_new, place, ground);
    zone<Modes> z{.position = {},
                  .opening = s.opening,
                  .v_free = node.v_free,
                  .v_previous = node.v_previous,
                  .step = step,
                  .weight = w,
                  .friction = s.damage > 0.0 ? friction * s.damage : 0.0,
                  .compliance_scale = 0.25 * step * step * node.area * node.delassus.normal(),
                  .modes = Modes(node.delassus, w)};
    z.place(kept(place), ground);
    outcome found = answer_of(z, given);
    if (is_new && found.refused == not_refused) make_before(z, given, found);
    settle(node, z, found);
    if (step != node.position_step)
      node.state.position = uneven_position(node.state.opening, z.position, given);
  }

  template <class Modes>
  outcome answer_of(const zone<Modes>& z, const gathered<double>& given) const {
    return is_delayed() ? delayed(given.damage, given.position_step, z) : at_once(given.damage, z);
  }

  // Where a bond that is made in this step, at the node's position, would put energy in, it is made before,
  // at the least part of half a step at which it does not.
  template <class Modes>
  void make_before(zone<Modes>& z, const gathered<double>& given, outcome& found) const {
    const auto taken = [&](double part) {
      const vector place = (0.5 * part * z.step) * z.v_previous;
      z.place(place, ground_below(place.n, z.v_previous.n, z.step));
      found = answer_of(z, given);
      double opening[3];
      keep(z.at(found.parts).opening, opening);
      return taken_from_before(given, opening, z.weight * z.weight);
    };
    if (taken(0.0) >= 0.0) return;
    double part = sign_change(0.0, 1.0, taken);
    for (double more = 0x1p-52; taken(part) < 0.0 && part < 1.0; more *= 2.0)
      part = smaller(part + more, 1.0);
  }

  template <class Modes, class Node>
  void settle(Node& node, const zone<Modes>& z, const outcome& found) const {
    auto& s = node.state;
    const motion m = z.at(found.parts);
    node.refused = found.refused != not_refused ? found.refused : m.refused;
    node.impulse = z.impulse(found.parts, m);
    // The bond's part of the work, which contact and friction have no share in.
    const double stiff = found.parts.left > 0.0 ? found.parts.stiffness() / z.compliance_scale : 0.0;
    const double rate = 0.5 * node.area * stiff;
    const vector sum = m.opening + z.opening, change = m.opening - z.opening;
    node.normal_gain = rate * normal_product(sum, change);
    node.tangential_gain = rate * z.weight * z.weight * tangential_product(sum, change);
    const double stored_before = node.area * energy_of(secant_of(s.damage), z.size(z.opening));
    node.stored = node.area * energy_of(secant_of(found.damage), m.size);
    node.rupture = positive_part(node.normal_gain + node.tangential_gain - (node.stored - stored_before));
    node.status = found.damage < 1.0 ? status::bonded : status::broken;
    s = {found.damage, z.next_position(m), m.opening};
  }

  // No bond: contact and friction, by the gap. What the bond remembers stays as it was when it broke.
  template <class Node>
  static auto contact(const Node& node) {
    return contact_problem_of(inelastic_contact_at(node, predictive), node.v_free, node.v_previous);
  }
  template <class Node>
  void touch(Node& node) const {
    apply_contact_friction(node, contact(node), friction);
  }

  // Where the strength, given as a table, has come to nothing.
  template <class Node>
  void break_at_once(Node& node) const {
    touch(node);
    node.state.damage = 1.0;
    node.status = status::broken;
  }
};

struct cohesive::in_phases : cohesive {
  of_all_nodes all;
  double surely_held, per_weight;  // squared: sure_strength, 1/weight

  explicit in_phases(const cohesive& law)
      : cohesive(law),
        all(law),
        surely_held(positive_part(law.sure_strength()) * positive_part(law.sure_strength())),
        per_weight(1.0 / (all.weight * all.weight)) {}

  template <class V>
  using problem = gathered<V>;
  template <class V>
  using answer = solved<V>;

  static constexpr bool asks_leave_state = true;
  // Bonds that surely stand still, at which their impulse does no positive work, and nodes that are free are
  // done.
  template <class Node>
  bool asks(Node& node, problem<double>& open) const {
    gather(node, open);
    const state& s = node.state;
    const bool bonded = (s.damage < 1.0) & (node.area > 0.0);
    const stopped_bond stop(node);
    const double pull = positive_part(stop.pull.n), capacity = stop.scale * (node.velocity_step * node.area);
    const double square =
        pull * pull + per_weight * (stop.pull.t1 * stop.pull.t1 + stop.pull.t2 * stop.pull.t2);
    const double most = capacity * capacity * surely_held;
    const bool surely = (square <= most) & (square < 0x1p900) & (most > 0x1p-900);
    const bool holds = bonded & (s.damage == 0.0) & surely & (stop.work >= 0.0);
    const vector r = -node.delassus.solve(node.v_free);
    const auto touching = contact(node);
    const bool rubs = (touching.slack <= 0.0) & (touching.q.n < 0.0);
    node.impulse = {holds ? r.n : 0.0, holds ? r.t1 : 0.0, holds ? r.t2 : 0.0};
    node.status = holds ? status::bonded : status::free;
    return (bonded & !holds) | (!bonded & rubs);
  }

  // In packs: bonds that need no counting of solutions, and, where H is transverse, nodes that touch.
  template <class V>
  [[gnu::noinline]] mask_of<V> solve(const problem<V>& p, answer<V>& a) const {
    const V* h = p.h;
    const auto transverse = (h[3] == 0.0) & (h[4] == 0.0) & (h[5] == 0.0) & (h[1] == h[2]);
    const auto bonded = (p.damage < 1.0) & (p.area > 0.0);
    mask_of<V> left = !(transverse | bonded);
    if (any(bonded & transverse)) left = left | solve_bonds(p, bonded & transverse, a);
    if (any(bonded & !transverse)) left = left | solve_coupled_bonds(p, bonded & !transverse, a);
    if (any(!bonded)) touch_in_packs(p, friction, !bonded, a);
    return left;
  }
  template <class Node>
  void answered(Node& node, const answer<double>& a) const {
    give(node, a);
  }

 private:
  template <class V>
  mask_of<V> solve_bonds(const problem<V>& p, mask_of<V> where, answer<V>& a) const {
    if (!bonds()) return where;
    const isotropic_step<V> step(*this, all, p);
    const auto is_new = where & (p.damage == 0.0);
    if (stiffness < infinity || !any(is_new)) return step.solve(where, a);
    // A rigid bond that has not been opened: see stands_still.
    const friction_answer<V> stop = stopping(p);
    const V pull = positive_part(-stop.r[0]),
            shear = per_weight * (stop.r[1] * stop.r[1] + stop.r[2] * stop.r[2]);
    const V square = pull * pull + shear;
    V held = smaller(strength, shear_strength());
    if (mixes()) held = larger(softening_at(mix_of(pull * pull, shear, square)).strength, held);
    const V most = p.velocity_step * p.area * held;
    const auto is_clear = (square < 0x1p900) & (most * most > 0x1p-900);
    const auto stands = is_new & is_clear & (square <= most * most), unclear = is_new & !is_clear;
    const mask_of<V> left = step.solve(where & !stands & !unclear, a);
    leave_bond(p, stop.r, V(status::bonded), stands, a);
    return left | unclear;
  }
  // But for rigid ones that have not been opened.
  template <class V>
  [[gnu::noinline]] mask_of<V> solve_coupled_bonds(const problem<V>& p, mask_of<V> where,
                                                   answer<V>& a) const {
    if (!bonds()) return where;
    const auto is_new = stiffness < infinity ? mask_of<V>(false) : where & (p.damage == 0.0);
    answer<V> found{};
    const coupled_step<V> step(*this, all, p);
    const mask_of<V> left = step.solve(where & !is_new, found);
    choose_answer(where, found, a);
    return left | is_new;
  }
};

template <class Node>
void cohesive::step(Node& node) const {
  const in_phases form(*this);
  gathered<double> given;
  if (!form.asks(node, given)) return;
  solved<double> found{};
  if (form.solve(given, found)) solve_alone(given, found);
  give(node, found);
}

template <class Run>
void cohesive::in_form(Run run) const {
  run(in_phases(*this));
}

}  // namespace

ILAW_PLUGIN("cohesive", "1.0.0", "ilaw", "BSD-3-Clause", cohesive)
