// rolling.hpp - friction and rolling resistance of a sphere, which H couples, and the resistance to twisting.
// plugins/rolling/rolling.md derives the equations.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit/friction.hpp>
#include <ilaw/kit/roots.hpp>

namespace ilaw::kit::inline ILAW_KIT_LEVEL {

template <class Law>
constexpr parameter<Law> rolling_friction_parameter(typename number_of_law<Law>::type Law::*member) {
  return {
      .member = member,
      .name = "rolling_friction",
      .symbol = "rho",
      .unit = "m",
      .doc =
          "Largest rolling moment over the normal force: a coefficient of rolling friction times a radius.",
      .infinity_allowed = true,
      .needs_spins = true};
}
template <class Law>
constexpr parameter<Law> twisting_friction_parameter(typename number_of_law<Law>::type Law::*member) {
  return {.member = member,
          .name = "twisting_friction",
          .symbol = "tau",
          .unit = "m",
          .doc = "Largest moment about the normal over the normal force.",
          .infinity_allowed = true,
          .needs_spins = true};
}

// In the tangent plane the slip is v + h r - k q and the rolling motion u - k r + j q, with k^2 < h j.
// |r| <= most_r opposes the slip, |q| <= most_q the rolling motion.
template <class V, class Vector>
struct rolling_problem {
  V h, k, j;
  Vector v, u;
  V most_r, most_q;
};
// r = -factor slip, with the slip that q leaves.
template <class V, class Vector>
struct rolling_result {
  Vector slip, q;
  V factor;
  mask_of<V> slides;
};

// With r = -part (v - k q), part = 1/(h + lambda), q is one projection and |r| falls with lambda >= 0: one
// root, of x = |v - k q| = most_r/part. resisted: the rolling motion that q opposes, of the one without q.
template <class V, class Vector, class Resisted>
ILAW_KIT_INLINE rolling_result<V, Vector> solve_rolling(const rolling_problem<V, Vector>& p,
                                                        Resisted resisted) {
  const V by_h = 1.0 / p.h, stuck = p.h * p.most_r;  // the largest speed that friction stops
  rolling_result<V, Vector> a{};
  V speed = stuck;
  const auto trial = [&](V x) ILAW_KIT_LAMBDA {
    const V part = select(x > stuck, p.most_r / x, by_h), j = p.j - (p.k * part) * p.k;
    const Vector f = resisted(p.u + (p.k * part) * p.v);
    const V length = f.tangential_length();
    a.q = f.against(0.0, select(length > p.most_q * j, p.most_q / length, 1.0 / j));
    a.slip = p.v - p.k * a.q;
    speed = a.slip.tangential_length();
    return root_trial<V>{x - speed, 1.0, 1.0, 1.0, none<V>()};
  };
  trial(stuck);
  if (const mask_of<V> slips = speed > stuck; any(slips))
    root_between(stuck, V(infinity), select(slips, speed, stuck), slips, trial);
  a.slides = speed > stuck;
  a.factor = select(a.slides, p.most_r / speed, by_h);
  return a;
}

// The moment about the normal that stops the spin, within its limit.
template <class V>
ILAW_KIT_INLINE V twisting_moment(V spin, V j_n, V most) {
  const V stops = spin / j_n;
  return 0.0 - smaller(larger(stops, -most), most);
}

// A resistance that takes no energy from the motion before the step, u^-, even where the motion turned round
// within the step: q opposes u + e u^- with the least e from 0 to 1 for which q.u^- <= 0 or e = 1. Then
// 2 q.(u^- + u)/2 = q.(u + e u^-) + (1 - e) q.u^- <= 0. The part e adds max(0, q.u^-) to the minimum that
// solve_rolling finds, which stays convex.
template <class V, class Vector>
class motion_to_resist {
 public:
  ILAW_KIT_INLINE explicit motion_to_resist(Vector before)
      : before_(before.tangential_part()),
        down_(before.scaled_tangential_length().down),
        square_(before.scaled_tangential_length().square) {}
  ILAW_KIT_INLINE Vector operator()(Vector u) const {
    constexpr double more_than_rounding = 1.0 + 0x1p-48;
    const V turned = 0.0 - more_than_rounding * tangential_product(down_ * u, down_ * before_);
    const V part = zero_unless(turned > 0.0, select(turned < square_, turned / square_, V(1.0)));
    return u + part * before_;
  }

 private:
  Vector before_;
  V down_, square_;
};
// The same along one axis.
template <class V>
ILAW_KIT_INLINE V spin_to_resist(V spin, V before) {
  const mask_of<V> turns = ((spin < 0.0) & (before > 0.0)) | ((spin > 0.0) & (before < 0.0));
  const V sum = spin + before, rest = select(spin > 0.0, positive_part(sum), 0.0 - positive_part(-sum));
  return select(turns, rest, spin);
}

}  // namespace ilaw::kit
