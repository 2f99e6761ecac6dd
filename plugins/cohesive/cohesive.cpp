// Cohesive zones: a bond that softens, with contact, friction and bounded damage rate. See cohesive.md.
#include "softening.hpp"
#include "zone.hpp"

#include <ilaw/kit.hpp>

namespace {

using namespace cohesive_law;

constexpr const char* shape_choices[] = {"bilinear", "exponential", "camacho_ortiz"};
constexpr double exponential = 1.0, camacho_ortiz = 2.0;

// A rigid bond that breaks leaves at least this part of the free motion.
constexpr double almost_nothing = 0x1p-100;

struct cohesive {
  double shape;
  double strength;
  double toughness;
  double strength_2;
  double toughness_2;
  double mixing_exponent;
  double stiffness;
  double friction;
  double delay_time;
  double delay_exponent;

  static constexpr law_card card{
      .id = "cohesive",
      .title = "Cohesive zone with contact, friction and delayed damage",
      .doc =
          "Bond that holds up to its strength, then softens until its toughness is spent; unloads to the "
          "origin; contact and friction take over as it breaks. Solved with H for any initial stiffness, "
          "also infinite, without a limit on the time step. H isotropic in the tangent plane.",
      .inputs = reads_gap | reads_v_previous | reads_area,
      .capabilities = ILAW_CAN_ADHERE | ILAW_CAN_STORE_ENERGY | ILAW_CAN_ACT_AT_DISTANCE};

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
      friction_parameter(&cohesive::friction).with_doc("Coefficient of friction of what is broken."),
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
  static constexpr state_variable state_variables[] = {
      {.name = "damage", .doc = "0: intact, 1: broken.", .minimum = 0.0, .maximum = 1.0},
      {.name = "opening", .unit = "m", .doc = "Normal displacement since the start."},
      {.name = "slip_1", .unit = "m", .doc = "First tangential displacement.", .kind = ILAW_STATE_HISTORY},
      {.name = "slip_2", .unit = "m", .doc = "Second tangential displacement.", .kind = ILAW_STATE_HISTORY},
      {.name = "mean_opening", .unit = "m", .doc = "Mean of the last two openings.", .internal = true},
      {.name = "mean_slip_1",
       .unit = "m",
       .doc = "Mean of the last two of slip_1.",
       .kind = ILAW_STATE_HISTORY,
       .internal = true},
      {.name = "mean_slip_2",
       .unit = "m",
       .doc = "Mean of the last two of slip_2.",
       .kind = ILAW_STATE_HISTORY,
       .internal = true}};

  const char* conflict() const {
    if ((strength == infinity) != (shear_strength() == infinity))
      return "parameters 'strength' and 'strength_2' must both be infinite, or both finite";
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
    return nullptr;
  }

  template <class Node>
  void initialise(Node& node) const {
    const bool bonds = strength > 0.0 && toughness > 0.0;
    node.state.damage = bonds ? 0.0 : 1.0;
  }

  template <class Node>
  void step(Node& node) const {
    node.refused = refusal_of_anisotropy(node.delassus);
    if (node.state.damage < 1.0 && node.area > 0.0)
      step_bond(node);
    else
      touch(node);
  }

 private:
  bool stores_more(double peak, double energy) const {
    return peak < infinity && energy > 0.0 && 0.5 * peak * peak * flexibility() > energy;
  }
  double flexibility() const { return stiffness < infinity ? 1.0 / stiffness : 0.0; }
  double shear_strength() const { return strength_2 > 0.0 ? strength_2 : strength; }
  double shear_toughness() const { return toughness_2 > 0.0 ? toughness_2 : toughness; }
  double weight() const { return shape == camacho_ortiz ? shear_strength() / strength : 1.0; }

  // Share of shear: part of the squared opening that is tangential.
  static double shear_share(vector w, double size) {
    const double part = size > 0.0 ? w.tangential_length() / size : 0.0;
    return smaller(part * part, 1.0);
  }

  bool mixes() const {
    return shape != camacho_ortiz && (shear_strength() != strength || shear_toughness() != toughness);
  }
  softening softening_at(double shear) const {
    const double part = shear > 0.0 ? power(shear, mixing_exponent) : 0.0;
    const double energy = toughness + part * (shear_toughness() - toughness);
    const double s1 = strength, s2 = shear_strength();
    const double peak = part > 0.0 ? square_root(s1 * s1 + part * (s2 * s2 - s1 * s1)) : s1;
    const double full = softening::fullness(shape == exponential);
    const double width = positive_part(energy / peak - 0.5 * peak * flexibility()) / full;
    return {peak, peak * flexibility(), width, shape == exponential};
  }

  softening softening_along(vector w, double size) const {
    return softening_at(mixes() ? shear_share(w, size) : 0.0);
  }

  // Damage says how soft the bond is; along a bilinear opening it is the part of the toughness that is spent.
  double softness_scale() const { return softening_at(0.0).width / strength; }
  secant secant_of(double damage) const {
    return {1.0 - damage, flexibility() + (strength < infinity ? damage * softness_scale() : 0.0)};
  }
  double damage_of(double opening, double traction) const {
    return (opening - flexibility() * traction) / (opening + softness_scale() * traction);
  }

  double energy_of(secant s, double size) const {
    return s.soft > 0.0 ? 0.5 * s.stiff / s.soft * size * size : 0.0;
  }

  template <class Node>
  zone zone_of(const Node& node) const {
    const auto& s = node.state;
    const double normal = node.delassus.normal(), tangential = node.delassus.tangential(), w = weight();
    return {.position = s.position,
            .opening = s.opening,
            .v_free = node.v_free,
            .normal_delassus = normal,
            .tangential_delassus = tangential,
            .position_step = node.position_step,
            .weight = w,
            .friction = s.damage > 0.0 ? friction * s.damage : 0.0,
            .compliance_scale = 0.25 * node.position_step * node.velocity_step * node.area * normal,
            .drive = 0.5 * node.v_free + (1.0 / node.position_step) * (s.position + s.opening),
            .ratio = w * w * tangential / normal};
  }

  struct outcome {
    share parts;
    double damage;
  };

  template <class Node>
  void step_bond(Node& node) const {
    const zone z = zone_of(node);
    const bool is_delayed = delay_time > 0.0 && strength < infinity;
    const double damage = node.state.damage;
    settle(node, z, is_delayed ? delayed(damage, node.position_step, z) : at_once(damage, z));
  }

  // Without delay: elastic where that stays below the softening.
  outcome at_once(double damage, const zone& z) const {
    const secant now = secant_of(damage);
    const share stiffest = z.of(now);
    if (strength == infinity || holds(z, now, stiffest)) return {stiffest, damage};
    return softened(damage, now, {stiffest.taken, larger(stiffest.left, almost_nothing)}, z);
  }

  // Else the mean traction on the way from w^- to w^+. Like `delayed` too long to be compiled for each form
  // of node.
  [[gnu::noinline]] outcome softened(double damage_before, secant now, share stiffest, const zone& z) const {
    const double from = z.size(z.opening);
    const share found = balance(stiffest, [&](share trial) {
      const motion m = z.at(trial);
      const double traction = softening_along(m.opening, m.size).mean_traction_on_path(now, from, m.size);
      return trial.stiffness() * (m.size + from) - 2.0 * z.compliance_scale * traction;
    });
    const motion m = z.at(found);
    const softening s = softening_along(m.opening, m.size);
    const double damage = m.size > s.onset ? damage_of(m.size, s.traction(m.size)) : 0.0;
    return {found, larger(damage_before, damage)};
  }

  bool holds(const zone& z, secant now, share elastic) const {
    if (now.soft > 0.0) {
      const motion m = z.at(elastic);
      return now.stiff * m.size <= now.soft * softening_along(m.opening, m.size).traction(m.size);
    }
    // A rigid bond does not move: its traction is what counts, with the weight of the work it does.
    const vector t = z.rigid_traction();
    const vector effective{positive_part(t.n), t.t1 / z.weight, t.t2 / z.weight};
    const double size = length(effective.n, effective.t1, effective.t2);
    return size <= softening_along(effective, size).strength;
  }

  // With delay: the stiffness is the mean of those before and after.
  [[gnu::noinline]] outcome delayed(double damage, double position_step, const zone& z) const {
    const secant before = secant_of(damage);
    const double stiffness_before = before.stiff / before.soft;
    const share found = balance(z.of(before), [&](share trial) {
      const secant after = secant_of(delayed_damage(damage, position_step, z.at(trial)));
      const double mean = 0.5 * (stiffness_before + after.stiff / after.soft);
      return trial.stiffness() - z.compliance_scale * mean;
    });
    return {found, delayed_damage(damage, position_step, z.at(found))};
  }

  // Exact for the constant target f that the opening at the end of the step sets (Allix and Deu 1997):
  // d = f - ln(1 + (exp(a z) - 1) exp(-a h/tau_c))/a, z = f - d before the step.
  double delayed_damage(double damage, double position_step, const motion& m) const {
    const softening s = softening_along(m.opening, m.size);
    const double progress = s.progress(m.size);
    const double target = progress < 1.0 && progress > 0.0 ? damage_of(m.size, s.traction(m.size)) : progress;
    const double distance = target - damage;
    if (!(distance > 0.0)) return damage;
    const double a = delay_exponent, decline = a * position_step / delay_time;
    const double ahead = a * distance - decline;
    const double left = ahead < 40.0 ? log((1.0 - exp(-decline)) + exp(ahead)) : ahead;
    return larger(damage, smaller(target - left / a, 1.0));
  }

  template <class Node>
  void settle(Node& node, const zone& z, const outcome& found) const {
    auto& s = node.state;
    const motion m = z.at(found.parts);
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

  // No bond: contact and friction, by the gap.
  template <class Node>
  void touch(Node& node) const {
    const contact_condition contact = contact_at(node, 0.0, predictive);
    apply_contact_friction(node, contact_problem_of(contact, node.v_free, node.v_previous), friction);
    const vector next =
        node.state.position + node.position_step * (node.v_free + node.delassus.times(node.impulse));
    node.state.opening = 0.5 * (node.state.position + next);
    node.state.position = next;
  }
};

}  // namespace

ILAW_PLUGIN("cohesive", "1.0.0", "ilaw", "BSD-3-Clause", cohesive)
