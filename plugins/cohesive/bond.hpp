// bond.hpp - what a cohesive bond is made of, and the stiffness that it has in one step.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "softening.hpp"
#include "zone.hpp"

namespace cohesive_law {
inline namespace ILAW_KIT_LEVEL {

// Values of the parameter "shape"; bilinear is 0.
inline constexpr double exponential = 1.0, camacho_ortiz = 2.0;

// A rigid bond that breaks leaves at least this part of the free motion.
inline constexpr double almost_nothing = 0x1p-100;

// The scale of damage is at least this part of what shear is soft by, which leaves 43 bits to its traction.
inline constexpr double softest_shear = 0x1p-10;

// Shares of mode I and of shear, which is mode II, in the squared opening, and what the page weighs the modes
// with; their sum is 1. Both are kept, since a large exponent or ratio of strengths makes much of a tiny one.
template <class V>
struct mode_mix {
  V normal, shear;

  // From the mode that has more of it: a difference of large numbers is none of a small rest.
  V mean(double of_normal, double of_shear) const {
    return select(shear > 0.5, of_shear + normal * (of_normal - of_shear),
                  of_normal + shear * (of_shear - of_normal));
  }
};
inline constexpr mode_mix<double> mode_1{1.0, 0.0}, mode_2{0.0, 1.0};

template <class V>
mode_mix<V> mix_of(V normal_square, V shear_square, V square) {
  const auto moves = square > 0.0;
  return {select(moves, normal_square / square, 1.0),
          select(moves, smaller(shear_square / square, 1.0), 0.0)};
}

// The parameters of the law, and all that asks for nothing but them and the zone.
struct bond {
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

  bool is_delayed() const { return delay_time > 0.0 && strength < infinity; }
  bool bonds() const { return strength > 0.0 && toughness > 0.0; }
  bool stores_more(double peak, double energy) const {
    return peak < infinity && energy > 0.0 && 0.5 * peak * peak * flexibility() > energy;
  }
  double flexibility() const { return stiffness < infinity ? 1.0 / stiffness : 0.0; }
  double shear_strength() const { return strength_2 > 0.0 ? strength_2 : strength; }
  double shear_toughness() const { return toughness_2 > 0.0 ? toughness_2 : toughness; }
  double weight() const { return shape == camacho_ortiz ? shear_strength() / strength : 1.0; }

  bool mixes() const {
    return shape != camacho_ortiz && (shear_strength() != strength || shear_toughness() != toughness);
  }
  static mode_mix<double> mix_along(vector w, double size) {
    if (!(size > 0.0)) return {1.0, 0.0};
    const double normal = w.n / size, shear = w.tangential_length() / size;
    return {normal * normal, smaller(shear * shear, 1.0)};
  }
  template <class V>
  softening<V> softening_at(mode_mix<V> mix) const {
    const mode_mix<V> weights = weights_of(mix);
    const V energy = weights.mean(toughness, shear_toughness());
    const double s1 = strength, s2 = shear_strength();
    const V peak = select(weights.shear > 0.0, square_root(weights.mean(s1 * s1, s2 * s2)), s1);
    const double full = softening<V>::fullness(shape == exponential);
    const V width = positive_part(energy / peak - 0.5 * peak * flexibility()) / full;
    return {peak, peak * flexibility(), width, shape == exponential};
  }
  // B^eta and 1 - B^eta: the kit's power, whose exponent is the same in all lanes here.
  template <class V>
  mode_mix<V> weights_of(mode_mix<V> mix) const {
    const V b = mix.shear, n = mix.normal;
    const double y = mixing_exponent;
    if (y == 1.0) return mix;
    if (y == 1.5) return {n * (1.0 + b + b * b) / (1.0 + b * square_root(b)), b * square_root(b)};
    return y == 2.0 ? mode_mix<V>{n * (1.0 + b), b * b} : any_weights_of(mix);
  }
  // On its own, so that the loops take in what is shorter. The logarithm is that of 1 - n where b is near 1,
  // with what the difference rounds off, as in log_one_plus.
  template <class V>
  [[gnu::noinline]] mode_mix<V> any_weights_of(mode_mix<V> mix) const {
    const auto is_near = mix.normal < 0.5;
    const V left = select(is_near, 1.0 - mix.normal, mix.shear);
    const V rounded_off = select(is_near, ((1.0 - left) - mix.normal) / left, 0.0);
    const exponentials<V> power = exponentials_of(mixing_exponent * (log(left) + rounded_off));
    return {-power.minus_one, power.exp};
  }

  softening<double> softening_along(vector w, double size) const {
    return softening_at(mixes() ? mix_along(w, size) : mode_1);
  }

  // Damage says how soft the bond is; along a bilinear opening it is the part of the toughness that is spent.
  // Close to 1 it has only 53 bits, of which a shear that is much softer would leave none.
  double softness_scale() const {
    const double opened = softness_at(mode_1);
    return mixes() ? larger(opened, softest_shear * softness_at(mode_2)) : opened;
  }
  double softness_at(mode_mix<double> mode) const {
    const softening<double> s = softening_at(mode);
    return s.width / s.strength;
  }
  secant<double> secant_of(double damage) const {
    return {1.0 - damage, flexibility() + (strength < infinity ? damage * softness_scale() : 0.0)};
  }
  template <class V>
  V damage_of(V opening, V traction) const {
    return (opening - flexibility() * traction) / (opening + softness_scale() * traction);
  }

  template <class V>
  static V energy_of(secant<V> s, V size) {
    return select(s.soft > 0.0, 0.5 * s.stiff / s.soft * size * size, 0.0);
  }

  struct outcome {
    share parts;
    double damage;
    double refused = not_refused;
  };

  // Without delay: elastic where that stays below the softening.
  template <class Zone>
  outcome at_once(double damage, const Zone& z) const {
    const secant<double> now = secant_of(damage);
    const share stiffest = z.of(now);
    if (strength == infinity || holds(z, damage, now, stiffest)) return {stiffest, damage};
    return softened(damage, now, {stiffest.taken, larger(stiffest.left, almost_nothing)}, z);
  }

  template <class Zone>
  bool holds(const Zone& z, double damage, secant<double> now, share elastic) const {
    if (!(now.soft > 0.0)) return false;  // see stands_still
    const motion m = z.at(elastic);
    const double pull = now.stiff * m.size;
    return (damage == 0.0 && pull <= now.soft * smaller(strength, shear_strength())) ||
           pull <= now.soft * softening_along(m.opening, m.size).traction(m.size);
  }

  // Else the mean traction on the way from w^- to w^+. Like `delayed` too long to be compiled for each form
  // of node.
  template <class Zone>
  [[gnu::noinline]] outcome softened(double damage_before, secant<double> now, share stiffest,
                                     const Zone& z) const {
    const double from = z.size(z.opening), secant_stiffness = now.stiffness();
    const auto excess = [&](share trial) {
      const motion m = z.at(trial);
      const softening<double> s = softening_along(m.opening, m.size);
      const double traction = s.mean_traction_on_path(secant_stiffness, s.meets(now), from, m.size);
      return trial.stiffness() * (m.size + from) - 2.0 * z.compliance_scale * traction;
    };
    const share found = balance(stiffest, excess);
    const motion m = z.at(found);
    const softening<double> s = softening_along(m.opening, m.size);
    const double damage = m.size > s.onset ? damage_of(m.size, s.traction(m.size)) : 0.0;
    return {found, larger(damage_before, damage), ambiguity(z, stiffest, excess)};
  }

  // With delay: the stiffness is the mean of those before and after.
  template <class Zone>
  [[gnu::noinline]] outcome delayed(double damage, double position_step, const Zone& z) const {
    const secant<double> before = secant_of(damage);
    const double stiffness_before = before.stiffness();
    const auto excess = [&](share trial) {
      const secant<double> after = secant_of(delayed_damage(damage, position_step, z.at(trial)));
      const double mean = 0.5 * (stiffness_before + after.stiffness());
      return trial.stiffness() - z.compliance_scale * mean;
    };
    const share stiffest = z.of(before);
    if (delayed_damage(damage, position_step, z.at(stiffest)) == damage) return {stiffest, damage};
    const share found = balance(stiffest, excess);
    return {found, delayed_damage(damage, position_step, z.at(found)), ambiguity(z, stiffest, excess)};
  }

  // Of all mode mixes.
  double steepest() const {
    const double opened = softening_at(mode_1).steepest();
    return mixes() ? larger(opened, softening_at(mode_2).steepest()) : opened;
  }

  // There is one solution where the softening is not steeper than the node gives way, c tr(H W) |T'| <= 1.
  // Beyond, the sign changes of the excess are counted as the node is left ever more of its free motion.
  // Several are a snap-back, and nothing says how much of it this step is to do.
  template <class Zone, class Excess>
  double ambiguity(const Zone& z, share stiffest, Excess excess) const {
    if (!(z.compliance_scale * z.modes.trace_ratio() * steepest() > 1.0)) return not_refused;
    // By what is left in the direction that gives way most: the others have had most of theirs by then.
    const double ratio = z.modes.largest_ratio(), first = stiffest.times(ratio).left;
    const auto at = [&](double part) {
      const double left = first + part * (1.0 - first);
      return excess(share{1.0 - left, left}.times(1.0 / ratio));
    };
    return changes_sign_again(at) ? several_solutions : not_refused;
  }

  // Exact for the constant target f that the opening at the end of the step sets (Allix and Deu 1997), z = f
  // - d before the step: d grows by -ln(1 - q)/a, q = (1 - exp(-a z)) (1 - exp(-a h/tau_c)). It may be tiny:
  // a stiff bond of great toughness is soft already at a damage of 1e-16. Where q is large, the same is f -
  // ln(1 + (exp(a z) - 1) exp(-a h/tau_c))/a.
  template <class V>
  [[gnu::noinline]] V delayed_damage(V damage, V position_step, V size, const softening<V>& s) const {
    const V progress = s.progress(size);
    const auto softens = (progress < 1.0) & (progress > 0.0);
    const V target = select(softens, damage_of(size, s.traction(size)), progress), distance = target - damage;
    const auto grows = distance > 0.0;
    if (!any(grows)) return damage;
    const V a = delay_exponent, decline = a * position_step / delay_time;
    const V q = exp_minus_one(select(grows, -a * distance, V(0.0))) * exp_minus_one(-decline);
    const auto is_slow = q < 0.5;
    V next = smaller(damage - log_one_plus(select(is_slow, -q, V(0.0))) / a, V(1.0));
    if (any(grows & !is_slow)) {
      const V ahead = a * distance - decline;
      const V reached = log((1.0 - exp(-decline)) + exp(smaller(ahead, V(40.0))));
      const V left = select(ahead < 40.0, reached, ahead);
      next = select(is_slow, next, larger(damage, smaller(target - left / a, V(1.0))));
    }
    return select(grows, next, damage);
  }
  double delayed_damage(double damage, double position_step, const motion& m) const {
    return delayed_damage<double>(damage, position_step, m.size, softening_along(m.opening, m.size));
  }
};

}  // namespace ILAW_KIT_LEVEL
}  // namespace cohesive_law
