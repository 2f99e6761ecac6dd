// compression.hpp - one step of the implicit normal spring at one node, an equation with one unknown:
//
//     r = h <S(x, x_free) - c phi vbar>,    v = v_free + H r,    vbar = (v^- + v)/2,
//     x_free = x - h (vbar + lead <v - v^->),    x' = <x_free>,
//
// S: mean force of the spring on its way, (P(x) - P(x'))/(x - x_free), P = k x^(p+1)/(p+1); phi: the part
// of the way on which it is closed. The right-hand side never increases with r: one solution.
#pragma once

#include <ilaw/kit/math.hpp>

#include <bit>
#include <cstdint>
#include <limits>

namespace penalty_law {

namespace kit = ilaw::kit;

// The damper's part of the critical one with which a linear spring that does not pull gives back the part e
// of a velocity: -ln e = 2 zeta acos(zeta)/sqrt(1 - zeta^2) (Schwager and Poeschel 2007, eq. 17; beyond 1
// with the hyperbolic functions). Inverted by a polynomial, to 3e-4 in e. Below the least e nothing would
// ever let go.
inline double damping_ratio(double restitution) {
  constexpr double least = 0.03, pi = 3.14159265358979323846;
  const double lost = 0.0 - kit::log(kit::larger(restitution, least));
  return lost / pi * (((0.0081 * lost + 0.022) * lost + 0.2088) * lost + 1.0);
}

struct compression {
  double free, previous;  // v_free, v^-
  double delassus, step;
  double indentation;  // x
  double stiffness, exponent, damping;
  double lead;  // 0: keeps all energy; 1/2: a rigid spring keeps none

  struct solution {
    double impulse;
    bool opens;
  };

  double mean_velocity(double v) const { return 0.5 * (previous + v); }
  double travel(double v) const {
    return step * (mean_velocity(v) + lead * kit::positive_part(v - previous));
  }

  // p = 1. <v - v^-> is the larger of 0 and v - v^-, and the impulse falls as the travel grows: it is the
  // smaller of those that either choice gives.
  solution linear() const {
    const solution plain = linear_with(0.0), leading = linear_with(lead);
    const bool leads = leading.impulse <= plain.impulse;
    return {leads ? leading.impulse : plain.impulse, leads ? leading.opens : plain.opens};
  }

  // x', and where the spring is stiff from its force, which then is the more accurate.
  double next(solution found) const {
    const double v = free + delassus * found.impulse;
    const double moved = kit::positive_part(indentation - travel(v));
    const double pressed =
        2.0 / stiffness * (found.impulse / step + damping * mean_velocity(v)) - indentation;
    const bool is_stiff = exponent == 1.0 && step * step * stiffness * delassus > 4.0;
    const double closed = is_stiff && found.impulse > 0.0 ? kit::positive_part(pressed) : moved;
    return found.opens || stiffness == kit::infinity ? 0.0 : closed;
  }

  // The impulse h <S - c phi vbar> that springs and damper give on a way that ends with v.
  double given(double v) const {
    const double way = travel(v), end = kit::positive_part(indentation - way);
    const double closed = way > indentation ? indentation / way : 1.0;
    const double spring = closed * mean_force(indentation, end);
    return step * kit::positive_part(spring - closed * damping * mean_velocity(v));
  }

  // Any p.
  [[gnu::noinline]] solution power_law() const {
    const double r = impulse_where([this](double trial) { return given(free + delassus * trial) - trial; });
    return {r, travel(free + delassus * r) > indentation};
  }

  // The impulse r where f(r), the force for a step with r less r itself, is zero; NaN where it has no root,
  // which only friction that is coupled to the normal brings about. f(0) is the force of the free step: an
  // upper bound without coupling. Secants that keep the root bracketed (Illinois; Dowell and Jarratt 1971),
  // and every third time the middle, so that no shape takes long.
  template <class Function>
  static double impulse_where(Function f) {
    double low = 0.0, at_low = f(low), high = at_low, last = 0.0;
    if (!(at_low > 0.0)) return low;
    double at_high = f(high);
    for (int k = 0; k < most_doublings && at_high > 0.0; ++k) at_high = f(high *= 2.0);
    if (at_high > 0.0) return std::numeric_limits<double>::quiet_NaN();
    for (int k = 0; k < most_iterations && at_high < 0.0; ++k) {
      const double secant = low + (high - low) * (at_low / (at_low - at_high));
      const bool halves = k % 3 == 2 || !(secant > low) || !(secant < high);
      const double x = halves ? middle(low, high) : secant;
      if (!(x > low) || !(x < high)) break;
      const double value = f(x);
      (value > 0.0 ? low : high) = x;
      (value > 0.0 ? at_high : at_low) *= last * value > 0.0 ? 0.5 : 1.0;
      (value > 0.0 ? at_low : at_high) = value;
      last = value > 0.0 ? 1.0 : -1.0;
    }
    return high;
  }

  // (P(x) - P(x'))/(x - x'), without cancelling where both are close.
  double mean_force(double x, double end) const {
    const double most = kit::larger(x, end), least = kit::smaller(x, end);
    if (exponent == 1.0) return 0.5 * stiffness * (x + end);
    if (!(most > 0.0)) return 0.0;
    return stiffness * raised(most) * mean_power(least / most);
  }

 private:
  // Its impulse with <v - v^-> taken as v - v^- times `part`. Closed to the end, all is linear; if that lets
  // it open, r travel = h x <k x/2 - c vbar>, a quadratic equation.
  solution linear_with(double part) const {
    const double sum = free + previous, damper = damping * delassus;
    const double start = 0.5 * sum + part * (free - previous), gain = delassus * (0.5 + part);
    const double way = step * start, drive = stiffness * (indentation - 0.5 * way) - 0.5 * damping * sum;
    const double spring =
        kit::positive_part(step * drive / (1.0 + 0.5 * step * (stiffness * (step * gain) + damper)));
    const double rigid = kit::positive_part(-start / gain);
    const double closed = stiffness < kit::infinity ? spring : rigid;
    const bool opens = step * (start + gain * closed) > indentation && stiffness < kit::infinity;

    const double linear = way + 0.5 * step * indentation * damper;
    const double constant =
        0.5 * step * indentation * kit::positive_part(stiffness * indentation - damping * sum);
    const double root = kit::length(linear, 2.0 * kit::square_root(step * gain * constant));
    const double above = 2.0 * constant / (linear + root), below = 0.5 * (root - linear) / (step * gain);
    const double opening = linear > 0.0 ? above : below;
    return {opens ? opening : closed, opens};
  }

  double raised(double x) const {
    return exponent == 1.5 ? x * kit::square_root(x) : kit::power(x, exponent);
  }

  // (1 - t^(p+1))/((p + 1) (1 - t)): for Hertz in roots, else by its series in 1 - t where that is small.
  double mean_power(double t) const {
    const double q = exponent + 1.0, d = 1.0 - t;
    if (exponent == 1.5) {
      const double s = kit::square_root(t);
      return 0.4 * ((((s + 1.0) * s + 1.0) * s + 1.0) * s + 1.0) / (1.0 + s);
    }
    if (d > 0x1p-4) return (1.0 - t * raised(t)) / (q * d);
    double sum = 1.0, term = 1.0;
    for (int k = 1; k < series_terms; ++k) {
      term *= d * (k - q) / (k + 1);
      sum += term;
    }
    return sum;
  }
  static constexpr int series_terms = 16;
  static constexpr int most_iterations = 200, most_doublings = 64;
  // Half way as the bits count where the numbers are far apart, so that an impulse of any size is found.
  static double middle(double low, double high) {
    if (high <= 4.0 * low) return 0.5 * (low + high);
    const auto a = std::bit_cast<std::uint64_t>(kit::larger(low, 0x1p-80 * high));
    return std::bit_cast<double>(a + (std::bit_cast<std::uint64_t>(high) - a) / 2);
  }
};

}  // namespace penalty_law
