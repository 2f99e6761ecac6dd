// compression.hpp - one step of the implicit normal spring at one node, an equation with one unknown:
//
//     r = h <S(x, x_free) - c phi vbar>,    v = v_free + H r,    vbar = (v^- + v)/2,
//     x_free = x - h (vbar + lead <v - v^->),    x' = <x_free>,
//
// S: mean force of the spring on its way, (P(x) - P(x'))/(x - x_free), P = k x^(p+1)/(p+1); phi: the part
// of the way on which it is closed. The right-hand side never increases with r: one solution.
#pragma once

#include <ilaw/kit/node.hpp>
#include <ilaw/kit/pack.hpp>

#include <limits>
#include <type_traits>

namespace penalty_law {

namespace kit = ilaw::kit;

// Not below the largest inverse mass in the tangent plane, with what H couples to the normal.
inline double largest_tangential(const kit::transverse_delassus& h) { return h.t; }
inline double largest_tangential(const kit::diagonal_delassus& h) { return kit::larger(h.t1, h.t2); }
inline double largest_tangential(const kit::full_delassus& h) {
  return kit::larger(h.t11 + kit::absolute(h.n1), h.t22 + kit::absolute(h.n2)) + kit::absolute(h.t12);
}

// The damper's part of the critical one with which a linear spring that does not pull gives back the part e
// of a velocity: -ln e = 2 zeta acos(zeta)/sqrt(1 - zeta^2) (Schwager and Poeschel 2007, eq. 17; beyond 1
// with the hyperbolic functions). Inverted by a polynomial, to 3e-4 in e. Below the least e nothing would
// ever let go.
inline double damping_ratio(double restitution) {
  constexpr double least = 0.03, pi = 3.14159265358979323846;
  const double lost = 0.0 - kit::log(kit::larger(restitution, least));
  return lost / pi * (((0.0081 * lost + 0.022) * lost + 0.2088) * lost + 1.0);
}

// V: double, or a pack of them for Hertz's exponent.
template <class V>
struct compression_of_any {
  using Mask = kit::mask_of<V>;

  V free, previous;  // v_free, v^-
  V delassus, step;
  V indentation;  // x
  V stiffness, exponent, damping;
  V lead;  // 0: keeps all energy; 1/2: a rigid spring keeps none

  struct solution {
    V impulse, opens;  // opens: 1 where the way ends open, else 0
  };

  V mean_velocity(V v) const { return 0.5 * (previous + v); }
  V travel(V v) const { return step * (mean_velocity(v) + lead * kit::positive_part(v - previous)); }

  // p = 1. <v - v^-> is the larger of 0 and v - v^-, and the impulse falls as the travel grows: it is the
  // smaller of those that either choice gives.
  solution linear() const {
    const solution plain = linear_with(0.0), leading = linear_with(lead);
    const bool leads = leading.impulse <= plain.impulse;
    // By arithmetic, since GCC vectorises no choice between conditions.
    const double part = leads ? 1.0 : 0.0;
    return {leads ? leading.impulse : plain.impulse, plain.opens + part * (leading.opens - plain.opens)};
  }

  // x', and where the spring is stiff from its force, which then is the more accurate.
  double next(solution found) const {
    const double v = free + delassus * found.impulse;
    const double moved = kit::positive_part(indentation - travel(v));
    const double pressed =
        2.0 / stiffness * (found.impulse / step + damping * mean_velocity(v)) - indentation;
    const bool is_stiff = (exponent == 1.0) & (step * step * stiffness * delassus > 4.0);
    const double closed = (is_stiff & (found.impulse > 0.0)) ? kit::positive_part(pressed) : moved;
    return ((found.opens != 0.0) | (stiffness == kit::infinity)) ? 0.0 : closed;
  }

  // The impulse h <S - c phi vbar> that springs and damper give on a way that ends with v.
  V given(V v) const {
    const V way = travel(v), end = kit::positive_part(indentation - way);
    const V closed = kit::select(way > indentation, indentation / way, V(1.0));
    const V spring = closed * mean_force(indentation, end);
    return step * kit::positive_part(spring - closed * damping * mean_velocity(v));
  }

  // Any p; a pack: Hertz's.
  [[gnu::noinline]] solution power_law() const {
    const V r = impulse_where([this](V trial) { return given(free + delassus * trial) - trial; });
    return {r, kit::select(travel(free + delassus * r) > indentation, V(1.0), V(0.0))};
  }

  // The impulse r where f(r), the force for a step with r less r itself, is zero; NaN where it has no root,
  // which only friction that is coupled to the normal brings about. f(0) is the force of the free step: an
  // upper bound without coupling. Secants that keep the root bracketed (Illinois; Dowell and Jarratt 1971),
  // and every third time the middle, so that no shape takes long. Lanes that are done keep their numbers.
  template <class Function>
  static V impulse_where(Function f) {
    constexpr double none = std::numeric_limits<double>::quiet_NaN();
    V low = 0.0, at_low = f(low), high = at_low, last = 0.0;
    const Mask pushes = at_low > 0.0;
    if (!kit::any(pushes)) return low;
    V at_high = f(high);
    for (int k = 0; k < most_doublings && kit::any(pushes & (at_high > 0.0)); ++k) {
      const Mask grows = pushes & (at_high > 0.0);
      high = kit::select(grows, 2.0 * high, high);
      at_high = kit::select(grows, f(high), at_high);
    }
    const Mask unbounded = at_high > 0.0;
    Mask active = pushes & (at_high < 0.0);
    for (int k = 0; k < most_iterations && kit::any(active); ++k) {
      const V secant = low + (high - low) * (at_low / (at_low - at_high));
      const Mask inside = (secant > low) & (secant < high);
      const V x = k % 3 == 2 ? middle(low, high) : kit::select(inside, secant, middle(low, high));
      active = active & (x > low) & (x < high);
      const V value = f(x), factor = kit::select(last * value > 0.0, V(0.5), V(1.0));
      const Mask rises = active & (value > 0.0), falls = active & !(value > 0.0);
      low = kit::select(rises, x, low);
      high = kit::select(falls, x, high);
      at_low = kit::select(rises, value, kit::select(falls, at_low * factor, at_low));
      at_high = kit::select(falls, value, kit::select(rises, at_high * factor, at_high));
      last = kit::select(rises, V(1.0), kit::select(falls, V(-1.0), last));
      active = active & (at_high < 0.0);
    }
    return kit::select(pushes, kit::select(unbounded, V(none), high), V(0.0));
  }

  // (P(x) - P(x'))/(x - x'), without cancelling where both are close.
  V mean_force(V x, V end) const {
    const V most = kit::larger(x, end), least = kit::smaller(x, end);
    if constexpr (std::is_same_v<V, double>)
      if (exponent != 1.5) return exponent == 1.0 ? 0.5 * stiffness * (x + end) : any_mean_force(most, least);
    const V s = kit::square_root(kit::select(most > 0.0, least / most, V(0.0)));
    const V mean = 0.4 * ((((s + 1.0) * s + 1.0) * s + 1.0) * s + 1.0) / (1.0 + s);
    return stiffness * (most * kit::square_root(most)) * mean;
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
    return {opens ? opening : closed, opens ? 1.0 : 0.0};
  }

  double any_mean_force(double most, double least) const {
    return most > 0.0 ? stiffness * kit::power(most, exponent) * mean_power(least / most) : 0.0;
  }

  // (1 - t^(p+1))/((p + 1) (1 - t)), by its series in 1 - t where that is small.
  double mean_power(double t) const {
    const double q = exponent + 1.0, d = 1.0 - t;
    if (d > 0x1p-4) return (1.0 - t * kit::power(t, exponent)) / (q * d);
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
  static V middle(V low, V high) {
    return kit::select(high <= 4.0 * low, 0.5 * (low + high),
                       kit::halfway(kit::larger(low, 0x1p-80 * high), high));
  }
};
using compression = compression_of_any<double>;

}  // namespace penalty_law
