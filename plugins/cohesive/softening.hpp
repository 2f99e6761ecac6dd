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
  bool exponential;

  // Toughness over strength times width: area below the softening of unit strength and width.
  static double fullness(bool exponential) {
    return exponential ? (1.0 / decay) - decay_end / (1.0 - decay_end) : 0.5;
  }

  // -T' where the traction falls fastest, at the onset.
  V steepest() const {
    return exponential ? strength * decay / ((1.0 - decay_end) * width) : strength / width;
  }

  // Not limited to 1, which it passes at the end of the curve.
  V progress(V opening) const {
    const V beyond = positive_part(opening - onset);
    return select(beyond > 0.0, beyond / width, 0.0);
  }

  V traction(V opening) const { return strength * remaining(smaller(progress(opening), 1.0)); }

  // Opening at which the softening meets a secant.
  V meets(secant<V> s) const {
    if (!exponential) return strength * s.soft * (onset + width) / (strength * s.soft + width * s.stiff);
    // soft * traction - stiff * opening is convex and falls: Newton's steps from the onset never pass the
    // root.
    V opening = onset;
    mask_of<V> active = opening == opening;
    for (int k = 0; k < 60 && any(active); ++k) {
      const V excess = s.soft * traction(opening) - s.stiff * opening;
      const V slope = s.soft * steepness(opening) + s.stiff;
      const V next = opening + positive_part(excess) / slope;
      active = active & (next > opening);
      opening = select(active, next, opening);
    }
    return opening;
  }

  // Mean traction on the way from one opening to another, either of them the larger, of a bond that had at
  // the first the secant stiffness, infinite where it is rigid, that the softening meets at met. Where modes
  // change, it may have had more there than this curve allows.
  V mean_traction_on_path(V stiffness, V met, V from, V to) const {
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
  V mean_traction(V from, V to) const {
    if (!exponential) return strength / width * ((onset + width) - 0.5 * (from + to));
    return exponential_mean_traction(from, to);
  }
  // On its own, so that the bilinear form stays short enough for its loops to take it in.
  [[gnu::noinline]] V exponential_mean_traction(V from, V to) const {
    const V a = smaller(progress(from), 1.0), b = smaller(progress(to), 1.0);
    const V unit = exp(-0.5 * decay * (a + b)) * sinh_ratio(0.5 * decay * (b - a));
    return strength * ((unit - decay_end) / (1.0 - decay_end));
  }
  V remaining(V progress) const {
    return exponential ? (exp(-decay * progress) - decay_end) / (1.0 - decay_end) : 1.0 - progress;
  }
  V steepness(V opening) const {
    const V p = progress(opening);
    return select(p < 1.0, strength * decay * exp(-decay * p) / ((1.0 - decay_end) * width), 0.0);
  }
};

}  // namespace cohesive_law
