// softening.hpp - traction against opening at one mode mix: elastic up to the onset, then softening to zero.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit.hpp>

namespace cohesive_law {
inline namespace ILAW_KIT_LEVEL {

using namespace ilaw::kit;

// Rate of the exponential: it is cut where the traction would be e^-8 of the strength, and shifted by that to
// end at zero, so that a bond breaks at a finite opening.
inline constexpr double decay = 8.0;
inline constexpr double decay_end = 3.3546262790251185e-4;

// sinh(z)/z for 0 <= z <= decay/2; the series keeps all digits of small z.
inline double sinh_ratio(double z) {
  const double s = z * z;
  const double series =
      1.0 +
      s / 6.0 *
          (1.0 + s / 20.0 * (1.0 + s / 42.0 * (1.0 + s / 72.0 * (1.0 + s / 110.0 * (1.0 + s / 156.0)))));
  return z < 0.5 ? series : (exp(z) - exp(-z)) / (2.0 * z);
}

// 1 - exp(-x) and -ln(1 - q), to all digits also where they are small (W. Kahan; Goldberg 1991, theorem 4).
inline double one_minus_exp(double x) {
  const double e = exp(-x);
  return e < 0.5 ? 1.0 - e : e < 1.0 ? (1.0 - e) * (x / -log(e)) : x;
}
inline double minus_log_one_minus(double q) {
  const double left = 1.0 - q;
  return left < 1.0 ? -log(left) * (q / (1.0 - left)) : q;
}

// The secant stiffness of a damaged bond, stiff / soft: rigid is soft = 0, broken is stiff = 0.
struct secant {
  double stiff, soft;
};

struct softening {
  double strength, onset, width;  // traction falls from strength to zero over [onset, onset + width]
  bool exponential;

  // Toughness over strength times width: area below the softening of unit strength and width.
  static double fullness(bool exponential) {
    return exponential ? (1.0 / decay) - decay_end / (1.0 - decay_end) : 0.5;
  }

  // -T' where the traction falls fastest, at the onset.
  double steepest() const {
    return exponential ? strength * decay / ((1.0 - decay_end) * width) : strength / width;
  }

  // Not limited to 1, which it passes at the end of the curve.
  double progress(double opening) const {
    const double beyond = positive_part(opening - onset);
    return beyond > 0.0 ? beyond / width : 0.0;
  }

  double traction(double opening) const { return strength * remaining(smaller(progress(opening), 1.0)); }

  // Mean of the traction over onset <= from < to.
  double mean_traction(double from, double to) const {
    const double a = progress(from), b = progress(to);
    if (!(a < 1.0)) return 0.0;
    const double end = smaller(b, 1.0);
    const double mean =
        exponential ? (exp(-0.5 * decay * (a + end)) * sinh_ratio(0.5 * decay * (end - a)) - decay_end) /
                          (1.0 - decay_end)
                    : 1.0 - 0.5 * (a + end);
    return end < b ? strength * mean * ((end - a) / (b - a)) : strength * mean;
  }

  // Opening at which the softening meets a secant.
  double meets(secant s) const {
    if (!exponential) return strength * s.soft * (onset + width) / (strength * s.soft + width * s.stiff);
    // soft * traction - stiff * opening is convex and falls: Newton's steps from the onset never pass the
    // root.
    double opening = onset;
    for (int k = 0; k < 60; ++k) {
      const double excess = s.soft * traction(opening) - s.stiff * opening;
      const double slope = s.soft * steepness(opening) + s.stiff;
      const double next = opening + positive_part(excess) / slope;
      if (!(next > opening)) break;
      opening = next;
    }
    return opening;
  }

  // Mean traction on the way from one opening to another, either of them the larger, of a bond that had this
  // secant at the first. Where modes change, it may have had more there than this curve allows.
  double mean_traction_on_path(secant s, double from, double to) const {
    const double low = smaller(from, to), high = larger(from, to), met = meets(s);
    if (high <= met) return s.soft > 0.0 ? 0.5 * s.stiff / s.soft * (from + to) : strength;
    const double reached = larger(met, low);
    if (!(high > reached)) return traction(high);
    const double soft_work = mean_traction(reached, high) * (high - reached);
    const double elastic_work =
        reached > low ? 0.5 * s.stiff / s.soft * (low + reached) * (reached - low) : 0.0;
    return (elastic_work + soft_work) / (high - low);
  }

 private:
  double remaining(double progress) const {
    return exponential ? (exp(-decay * progress) - decay_end) / (1.0 - decay_end) : 1.0 - progress;
  }
  double steepness(double opening) const {
    const double p = progress(opening);
    return p < 1.0 ? strength * decay * exp(-decay * p) / ((1.0 - decay_end) * width) : 0.0;
  }
};

}  // namespace ILAW_KIT_LEVEL
}  // namespace cohesive_law
