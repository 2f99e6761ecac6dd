// Cohesive zones: a bond that softens, with contact, friction and bounded damage rate. See cohesive.md.
#include "softening.hpp"
#include "zone.hpp"

#include <ilaw/kit.hpp>

namespace {

using namespace cohesive_law;

constexpr const char* shape_choices[] = {"bilinear", "exponential", "camacho_ortiz"};
constexpr double exponential = 1.0, camacho_ortiz = 2.0;

// A root is looked for up to this share of a rigid bond: one that lies closer to 1 is as good as it.
constexpr double almost_rigid = 1.0 - 0x1p-50;

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
          "also "
          "infinite, without a limit on the time step. H isotropic in the tangent plane.",
      .inputs = reads_gap | reads_area,
      .capabilities = ILAW_CAN_ADHERE | ILAW_CAN_STORE_ENERGY | ILAW_CAN_ACT_AT_DISTANCE};

  static constexpr const char* references[] = {
      "G. T. Camacho, M. Ortiz, 1996, Computational modelling of impact damage in brittle materials",
      "M. L. Benzeggagh, M. Kenane, 1996, Measurement of mixed-mode delamination fracture toughness",
      "A. Turon, P. P. Camanho, J. Costa, C. G. Davila, 2006, A damage model for the simulation of "
      "delamination under variable-mode loading",
      "G. Alfano, E. Sacco, 2006, Combining interface damage and friction in a cohesive-zone model",
      "O. Allix, J.-F. Deu, 1997, Delayed-damage modelling for fracture prediction of laminated composites "
      "under dynamic loading"};

  static constexpr parameter<cohesive> parameters[] = {
      {.member = &cohesive::shape,
       .name = "shape",
       .doc = "bilinear, exponential: modes mixed by Benzeggagh and Kenane; camacho_ortiz: rigid, then "
              "linear in "
              "an effective opening.",
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
      {.member = &cohesive::friction,
       .name = "friction",
       .symbol = "mu",
       .doc = "Coefficient of friction of what is broken.",
       .infinity_allowed = true},
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
    vector jump;
    double damage_before;
    vector jump_before;
  };
  static constexpr state_variable state_variables[] = {
      {.name = "damage", .doc = "0: intact, 1: broken."},
      {.name = "opening", .unit = "m", .doc = "Normal opening since the start."},
      {.name = "slip_1", .unit = "m", .doc = "First tangential opening.", .kind = ILAW_STATE_HISTORY},
      {.name = "slip_2", .unit = "m", .doc = "Second tangential opening.", .kind = ILAW_STATE_HISTORY},
      {.name = "damage_before", .doc = "Damage one step before."},
      {.name = "opening_before", .unit = "m", .doc = "Normal opening one step before."},
      {.name = "slip_1_before", .unit = "m", .doc = "slip_1 one step before.", .kind = ILAW_STATE_HISTORY},
      {.name = "slip_2_before", .unit = "m", .doc = "slip_2 one step before.", .kind = ILAW_STATE_HISTORY}};

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
             "nothing of "
             "its load";
    const bool too_soft = softening_at(0.0).width < 0.0 || softening_at(1.0).width < 0.0;
    return strength < infinity && strength > 0.0 && toughness > 0.0 && too_soft
               ? "parameter 'toughness' (or 'toughness_2') is below strength^2/(2 stiffness), the energy "
                 "that the "
                 "bond stores when its strength is reached"
               : nullptr;
  }

  template <class Node>
  void initialise(Node& node) const {
    const bool bonds = strength > 0.0 && toughness > 0.0;
    node.state.damage = node.state.damage_before = bonds ? 0.0 : 1.0;
  }

  template <class Node>
  void step(Node& node) const {
    node.refused = node.delassus.anisotropy() == 0.0 ? not_refused : anisotropic_delassus;
    if (node.state.damage_before < 1.0 && node.area > 0.0)
      step_bond(node);
    else
      touch(node);
  }

 private:
  double flexibility() const { return stiffness < infinity ? 1.0 / stiffness : 0.0; }
  double shear_strength() const { return strength_2 > 0.0 ? strength_2 : strength; }
  double shear_toughness() const { return toughness_2 > 0.0 ? toughness_2 : toughness; }
  double weight() const { return shape == camacho_ortiz ? shear_strength() / strength : 1.0; }

  // Share of shear: part of the squared opening that is tangential.
  static double shear_share(vector jump, double size) {
    const double part = size > 0.0 ? jump.tangential_length() / size : 0.0;
    return smaller(part * part, 1.0);
  }

  softening softening_at(double shear) const {
    const bool mixed = shear > 0.0 && shape != camacho_ortiz;
    const double part = !mixed ? 0.0 : shear < 1.0 ? exp(mixing_exponent * log(shear)) : 1.0;
    const double energy = toughness + part * (shear_toughness() - toughness);
    const double s1 = strength, s2 = shear_strength();
    const double peak = part > 0.0 ? square_root(s1 * s1 + part * (s2 * s2 - s1 * s1)) : s1;
    const double full = softening::fullness(shape == exponential);
    const double width = (energy / peak - 0.5 * peak * flexibility()) / full;
    return {peak, peak * flexibility(), width, shape == exponential};
  }

  // Damage says how soft the bond is; along a bilinear opening it is the part of the toughness that is spent.
  double softness_scale() const { return larger(softening_at(0.0).width / strength, 0.0); }
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
    const double damage = node.state.damage, normal = node.delassus.normal();
    return {.before = node.state.jump_before,
            .now = node.state.jump,
            .v_free = node.v_free,
            .normal_delassus = normal,
            .tangential_delassus = node.delassus.tangential(),
            .position_step = node.position_step,
            .weight = weight(),
            .friction = damage > 0.0 ? friction * damage : 0.0,
            .compliance_scale = 0.5 * node.position_step * node.velocity_step * node.area * normal};
  }
  static double share_of(secant s, double scale) { return scale * s.stiff / (s.soft + scale * s.stiff); }

  template <class Node>
  void step_bond(Node& node) const {
    const zone z = zone_of(node);
    const double share = delay_time > 0.0 ? delayed_share(node, z) : share_at_once(node, z);
    const motion m = z.at(share);
    const double damage = delay_time > 0.0 ? delayed_damage(node, m) : damage_at_once(node, m);
    settle(node, z, share, m, damage);
  }

  // Without delay: elastic where that stays below the softening, else on it.
  template <class Node>
  double share_at_once(const Node& node, const zone& z) const {
    const secant now = secant_of(node.state.damage), before = secant_of(node.state.damage_before);
    const double elastic = share_of(now, z.compliance_scale);
    if (strength == infinity || holds(z, now, elastic)) return elastic;
    const double stiffest = smaller(share_of(before, z.compliance_scale), almost_rigid);
    const double from = effective(z.before, z.weight);
    return sign_change(0.0, stiffest, [&](double share) {
      const motion m = z.at(share);
      const softening s = softening_at(shear_share(m.jump, m.size));
      const double traction = s.mean_traction_on_path(before, from, m.size);
      return share / (1.0 - share) * (m.size + from) - 2.0 * z.compliance_scale * traction;
    });
  }

  bool holds(const zone& z, secant now, double elastic) const {
    if (now.soft > 0.0) {
      const motion m = z.at(elastic);
      return now.stiff * m.size < now.soft * softening_at(shear_share(m.jump, m.size)).traction(m.size);
    }
    // A rigid bond does not move: its traction is what counts.
    const vector w = z.drive();
    const double scale = z.position_step / (2.0 * z.compliance_scale), q = z.stiffness_ratio();
    const double tangential = scale * z.weight / q;
    const vector traction{scale * positive_part(w.n), tangential * w.t1, tangential * w.t2};
    const double size = length(traction.n, traction.t1, traction.t2);
    return size < softening_at(shear_share(traction, size)).strength;
  }

  template <class Node>
  double damage_at_once(const Node& node, const motion& m) const {
    if (strength == infinity) return node.state.damage;
    const softening s = softening_at(shear_share(m.jump, m.size));
    return m.size > s.onset ? larger(node.state.damage, damage_of(m.size, s.traction(m.size)))
                            : node.state.damage;
  }

  // With delay: the stiffness is the mean of those before and after.
  template <class Node>
  double delayed_share(const Node& node, const zone& z) const {
    const secant before = secant_of(node.state.damage_before);
    const double stiffness_before = before.stiff / before.soft;
    return sign_change(0.0, share_of(secant_of(0.0), z.compliance_scale), [&](double share) {
      const secant after = secant_of(delayed_damage(node, z.at(share)));
      const double mean = 0.5 * (stiffness_before + after.stiff / after.soft);
      return share / (1.0 - share) - z.compliance_scale * mean;
    });
  }

  // Exact for the constant target f that the opening at the end of the step sets (Allix and Deu 1997):
  // d = f - ln(1 + (exp(a z) - 1) exp(-a h/tau_c))/a, z = f - d before the step.
  template <class Node>
  double delayed_damage(const Node& node, const motion& m) const {
    const double damage = node.state.damage;
    if (strength == infinity) return damage;
    const softening s = softening_at(shear_share(m.jump, m.size));
    const double progress = s.progress(m.size);
    const double target = progress < 1.0 && progress > 0.0 ? damage_of(m.size, s.traction(m.size)) : progress;
    const double distance = target - damage;
    if (!(distance > 0.0)) return damage;
    const double a = delay_exponent, decline = a * node.position_step / delay_time;
    const double ahead = a * distance - decline;
    const double left = ahead < 40.0 ? log((1.0 - exp(-decline)) + exp(ahead)) : ahead;
    return larger(damage, smaller(target - left / a, 1.0));
  }

  template <class Node>
  void settle(Node& node, const zone& z, double share, const motion& m, double damage) const {
    auto& s = node.state;
    const double sizes[] = {effective(z.before, z.weight), effective(z.now, z.weight), m.size};
    const double energies[] = {energy_of(secant_of(s.damage_before), sizes[0]),
                               energy_of(secant_of(s.damage), sizes[1]),
                               energy_of(secant_of(damage), sizes[2])};
    node.impulse = z.impulse(share, m);
    // The bond's part of the work, which contact and friction have no share in.
    const double stiff = share < almost_rigid ? share / (1.0 - share) / z.compliance_scale : 0.0;
    const double rate = 0.25 * node.area * stiff, w2 = z.weight * z.weight;
    const vector sum = m.jump + z.before, change = m.jump - z.before;
    node.normal_gain = rate * normal_product(sum, change);
    node.tangential_gain = rate * w2 * tangential_product(sum, change);
    node.stored = 0.5 * node.area * (energies[1] + energies[2]);
    node.rupture = positive_part(node.normal_gain + node.tangential_gain -
                                 0.5 * node.area * (energies[2] - energies[0]));
    const double unbonded = s.damage < 1.0 ? double{ILAW_BROKEN} : contact_status(z, m);
    node.status = damage < 1.0 ? double{ILAW_BONDED} : unbonded;
    s.damage_before = s.damage;
    s.jump_before = s.jump;
    s.damage = damage;
    s.jump = m.jump;
  }
  static double contact_status(const zone& z, const motion& m) {
    const double slip = (m.jump - z.now).tangential_length();
    const double closed_status = slip > 0.0 ? double{ILAW_SLIP} : double{ILAW_STICK};
    return m.friction.n > 0.0 ? closed_status : double{ILAW_FREE};
  }

  // No bond: contact and friction, by the gap.
  template <class Node>
  void touch(Node& node) const {
    const contact_condition contact = contact_at(node, 0.0, predictive);
    auto q = node.v_free;
    q.n = contact.excess;
    apply_contact_friction(node, contact.slack, q, friction);
    auto& s = node.state;
    s.damage_before = s.damage;
    s.jump_before = s.jump;
    s.jump = s.jump + node.position_step * (node.v_free + node.delassus.times(node.impulse));
  }
};

}  // namespace

ILAW_PLUGIN("cohesive", "1.0.0", "ilaw", "BSD-3-Clause", cohesive)
