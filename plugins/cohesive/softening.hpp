// softening.hpp - traction against opening at one mode mix: elastic up to the onset, then softening to zero.
// For one node (V = double) or a pack of them.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit/math.hpp>

namespace cohesive_law::inline ILAW_KIT_LEVEL {

using namespace ilaw::kit;

// Rate of the exponential: it is cut where the traction would be e^-8 of the strength, and shifted by that to
// end at zero, so that a bond breaks at a finite opening.
inline constexpr double decay = 8.0;
inline constexpr double decay_end = 3.3546262790251185e-4;

// sinh(z)/z for 0 <= z <= decay/2; the series keeps all digits of small z.
template <class V>
V sinh_ratio(V z) {
  const V s = z * z;
  const V series =
      1.0 +
      s / 6.0 *
          (1.0 + s / 20.0 * (1.0 + s / 42.0 * (1.0 + s / 72.0 * (1.0 + s / 110.0 * (1.0 + s / 156.0)))));
  return select(z < 0.5, series, (exp(z) - exp(-z)) / (2.0 * z));
}

// Shares of mode I and of shear, which is mode II, in the squared opening, and what the page weighs the modes
// with; their sum is 1. Both are kept, since a large exponent or ratio of strengths makes much of a tiny one.
template <class V>
struct mode_mix {
  V normal, shear;

  // From the mode that has more of it: a difference of large numbers is none of a small rest.
  V mean(V of_normal, V of_shear) const {
    return select(shear > 0.5, of_shear + normal * (of_normal - of_shear),
                  of_normal + shear * (of_shear - of_normal));
  }
  friend mode_mix select(mask_of<V> m, mode_mix a, mode_mix b) {
    return {select(m, a.normal, b.normal), select(m, a.shear, b.shear)};
  }
};
template <class V>
mode_mix<V> mix_of(V normal_square, V shear_square, V square) {
  const mask_of<V> moves = square > 0.0;
  return {select(moves, normal_square / square, 1.0),
          zero_unless(moves, smaller(shear_square / square, V(1.0)))};
}

// The secant stiffness of a damaged bond, stiff / soft: rigid is soft = 0, broken is stiff = 0.
template <class V>
struct secant {
  V stiff, soft;

  V stiffness() const { return stiff / soft; }  // infinite where rigid
};

template <class V>
struct softening {
  V strength, onset, width;  // traction falls from strength to zero over [onset, onset + width]
  V slope;                   // strength/width
  bool exponential;

  // Toughness over strength times width: area below the softening of unit strength and width.
  static double fullness(bool exponential) {
    return exponential ? (1.0 / decay) - decay_end / (1.0 - decay_end) : 0.5;
  }

  // -T' where the traction falls fastest, at the onset.
  V steepest() const { return exponential ? slope * (decay / (1.0 - decay_end)) : slope; }

  // Not limited to 1, which it passes at the end of the curve.
  V progress(V opening) const {
    const V beyond = positive_part(opening - onset);
    return select(beyond > 0.0, beyond / width, 0.0);
  }

  ILAW_KIT_INLINE V traction(V opening) const {
    if (exponential) return exponential_traction(opening);
    const V end = onset + width;
    return select(opening > onset, zero_unless(opening < end, slope * (end - opening)), strength);
  }

  // Opening at which the softening meets a secant.
  ILAW_KIT_INLINE V meets(secant<V> s) const {
    if (exponential) return exponential_meets(s);
    return strength * s.soft * (onset + width) / (strength * s.soft + width * s.stiff);
  }

  // Mean traction on the way from one opening to another, either of them the larger, of a bond that had at
  // the first the secant stiffness, infinite where it is rigid, that the softening meets at met. Where modes
  // change, it may have had more there than this curve allows.
  ILAW_KIT_INLINE V mean_traction_on_path(V stiffness, V met, V from, V to) const {
    const V low = smaller(from, to), high = larger(from, to), reached = larger(met, low);
    const V rate = 0.5 * stiffness;
    const V elastic = select(rate < infinity, rate * (from + to), strength);
    const V elastic_work = select(reached > low, rate * (low + reached) * (reached - low), 0.0);
    const V end = onset + width, a = smaller(reached, end), b = smaller(high, end);
    const V below = select(a < end, mean_traction(a, b), 0.0);
    const V mean = (elastic_work + below * (b - a)) / (high - low);
    return select(high <= met, elastic, select(high > reached, mean, below));
  }

 private:
  // Over onset <= from <= to <= onset + width.
  ILAW_KIT_INLINE V mean_traction(V from, V to) const {
    if (!exponential) return slope * ((onset + width) - 0.5 * (from + to));
    return exponential_mean_traction(from, to);
  }
  [[gnu::noinline]] V exponential_mean_traction(V from, V to) const {
    const V a = smaller(progress(from), V(1.0)), b = smaller(progress(to), V(1.0));
    const V unit = exp(-0.5 * decay * (a + b)) * sinh_ratio(0.5 * decay * (b - a));
    return strength * ((unit - decay_end) / (1.0 - decay_end));
  }
  [[gnu::noinline]] V exponential_traction(V opening) const {
    return strength * ((exp(-decay * smaller(progress(opening), V(1.0))) - decay_end) / (1.0 - decay_end));
  }
  // soft * traction - stiff * opening is convex and falls: Newton's steps from the onset never pass the root.
  [[gnu::noinline]] V exponential_meets(secant<V> s) const {
    V opening = onset;
    mask_of<V> active = all<V>();
    for (int k = 0; k < 60 && any(active); ++k) {
      const V left = exp(-decay * progress(opening)),
              steepness = steepest() * zero_unless(progress(opening) < 1.0, left);
      const V excess = s.soft * exponential_traction(opening) - s.stiff * opening;
      const V next = opening + positive_part(excess) / (s.soft * steepness + s.stiff);
      active = active & (next > opening);
      opening = select(active, next, opening);
    }
    return opening;
  }
};

}  // namespace cohesive_law
