// compression.hpp - the normal equation of the locally implicit penalty, one unknown at one node:
//
//     r = h <k <-g'>^p - c v> where g' < 0,   g' = g + l v,   v = v_free + H r,     h, l the two time steps.
//
// The right-hand side, completed by the vertical segment where the damper sets in at g' = 0, never increases
// with v, and r = (v - v_free)/H increases: there is exactly one solution, 0 <= r <= r_rigid = <-(g/l +
// v_free)>/H, the impulse that brings the gap to zero.
#pragma once

#include <ilaw/kit/math.hpp>

namespace penalty_law {

namespace kit = ilaw::kit;

struct compression {
  double velocity;  // v_free
  double reach;     // v_free + g/l: closes where negative
  double delassus, velocity_step, position_step;

  double rigid() const { return kit::positive_part(-reach / delassus); }

  // p = 1: with the spring and the damper as one, of gain k l + c per velocity,
  // r (1/(h (k l + c)) + H) = -(v_free + g k/(k l + c)), also for k = inf. Beyond r_rigid the damper only
  // stops.
  double linear(double gap, double stiffness, double damping) const {
    const double lag = damping > 0.0 ? damping / stiffness : 0.0;
    const double compliance = 1.0 / (velocity_step * (stiffness * position_step + damping));
    const double drive = velocity + gap * (1.0 / (position_step + lag));
    return kit::smaller(kit::positive_part(-drive / (delassus + compliance)), rigid());
  }

  // Any p >= 1, in x = g'/(l reach) from 0 (rigid) to 1 (nothing there): r = r_rigid (1 - x), where
  // a x + b x^p = a + d, a = 1 + h c H, b = h k (-l reach)^p / r_rigid, d = h c v_free / r_rigid.
  [[gnu::noinline]] double power_law(double stiffness, double damping, double exponent) const {
    const double most = rigid(), damper = velocity_step * damping;
    const double a = 1.0 + damper * delassus;
    const double b = velocity_step * stiffness * raised(-reach * position_step, exponent) / most;
    const double d = damper * velocity / most;
    const double x = kit::smaller(root(a, b, a + d, exponent), 1.0);
    // Each form where it does not cancel.
    const double stiff = 1.0 - x, soft = kit::positive_part(b * raised(x, exponent) - d) / a;
    return most > 0.0 ? most * (x < 0.5 ? stiff : soft) : 0.0;
  }

  // The root of a x + b x^p = c with a, b >= 0, 0 where c <= 0. The left side is convex and increasing, so
  // that Newton's method comes down from any point above; the smaller of the roots of either term alone is
  // one, and less than twice the root. It ends when rounding stops the descent.
  static double root(double a, double b, double c, double exponent) {
    if (!(c > 0.0)) return 0.0;
    double x = kit::smaller(c / a, kit::power(c / b, 1.0 / exponent));
    for (int k = 0; k < most_iterations; ++k) {
      const double power = b * raised(x, exponent);
      const double next = x - (a * x + power - c) / (a + exponent * power / x);
      if (!(next < x)) break;
      x = next;
    }
    return x;
  }
  // Hertz's power by itself, in scalar code worth a branch.
  static double raised(double x, double exponent) {
    if (exponent == 1.5) return x * kit::square_root(x);
    return kit::power(x, exponent);
  }

  // Quadratic from the start: 5 for Hertz, 10 for the largest exponent; the rest is for rounding.
  static constexpr int most_iterations = 32;
};

}  // namespace penalty_law
