// compression.hpp - one step of the implicit normal spring at one node or a pack of them, an equation with
// one unknown:
//
//     r = h <S(x, x_free) - c phi vbar>,    v = v_free + H r,    vbar = (v^- + v)/2,
//     x_free = x - h (vbar + lead <v - v^->),    x' = <x_free>,
//
// S: mean force of the spring on its way, (P(x) - P(x'))/(x - x_free), P = k x^(p+1)/(p+1); phi: the part
// of the way on which it is closed. The right-hand side never increases with r: one solution. penalty.md
// derives it.
#pragma once

#include <ilaw/kit/node.hpp>
#include <ilaw/kit/pack.hpp>

#include <bit>
#include <cstdint>
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

// plain: linear, neither rigid nor, where it is implicit, with damper or restitution. smooth: the same
// without friction. sticking_...: with friction and a rigid tangential spring, which `any` may have, too.
enum class spring_kind {
  smooth,
  plain,
  sticking_plain,
  linear,
  sticking_linear,
  smooth_hertz,
  hertz,
  sticking_hertz,
  any
};
constexpr bool is_smooth(spring_kind kind) {
  return kind == spring_kind::smooth || kind == spring_kind::smooth_hertz;
}
constexpr bool is_plain(spring_kind kind) {
  return kind == spring_kind::smooth || kind == spring_kind::plain || kind == spring_kind::sticking_plain;
}
constexpr bool is_hertz(spring_kind kind) {
  return kind == spring_kind::smooth_hertz || kind == spring_kind::hertz ||
         kind == spring_kind::sticking_hertz;
}
constexpr bool is_linear(spring_kind kind) {
  return is_plain(kind) || kind == spring_kind::linear || kind == spring_kind::sticking_linear;
}
constexpr bool sticks_rigidly(spring_kind kind) {
  return kind == spring_kind::sticking_plain || kind == spring_kind::sticking_linear ||
         kind == spring_kind::sticking_hertz;
}

template <spring_kind Kind>
double spring_force(double stiffness, double exponent, double penetration) {
  if constexpr (is_linear(Kind)) return stiffness * penetration;
  if constexpr (is_hertz(Kind)) return stiffness * (penetration * kit::square_root(penetration));
  return stiffness * kit::power(penetration, exponent);
}
template <spring_kind Kind>
double potential(double stiffness, double exponent, double penetration) {
  const double work = spring_force<Kind>(stiffness, exponent, penetration) * penetration;
  if constexpr (is_linear(Kind)) return 0.5 * work;
  if constexpr (is_hertz(Kind)) return 0.4 * work;
  return work / (exponent + 1.0);
}

// Explicit springs with a damper that lags: omega h = 2 (sqrt(1 + zeta^2) - zeta), zeta = c H/(2 omega)
// (Belytschko, Liu, Moran 2000, eq. 6.2.31). The normal spring is taken as closed, and as stiff as it is
// now.
inline double stable_step(double delassus, double tangent, double damping) {
  const double half_damper = 0.5 * damping * delassus;
  return 2.0 / (kit::length(kit::square_root(tangent * delassus), half_damper) + half_damper);
}

// How much of the velocity before a step a rigid tangential spring gives back, where H is that of a ball in
// the tangent plane: what of it the free velocity has turned round, so that the stick does no work. A little
// more, as rounding may leave velocities along v^-, which then do none either.
template <class Vector>
double turned_part(Vector v_free, Vector v_previous) {
  constexpr double more_than_rounding = 1.0 + 0x1p-48;
  const double speed = tangential_product(v_previous, v_previous);
  const double turned = 0.0 - more_than_rounding * tangential_product(v_free, v_previous);
  return turned > 0.0 ? turned / kit::larger(turned, speed) : 0.0;
}

// What is the same at all nodes of a loop.
struct normal_spring {
  double step, stiffness, exponent;
  double lead;            // 0: keeps all energy; 1/2: a rigid spring keeps none
  double damping, ratio;  // one of them is zero: the damper as given, or by its part of the critical one

  bool is_rigid() const { return stiffness == kit::infinity; }
  // Of a spring that is not rigid: what a rigid one multiplies by it counts nowhere.
  double soft() const { return is_rigid() ? 0.0 : stiffness; }

  // The damper of the step. By weights, since GCC vectorises no choice that is the same at all nodes.
  template <class V>
  V damper(V delassus) const {
    const double by_ratio = ratio > 0.0 ? 1.0 : 0.0, given = 1.0 - by_ratio, stiff = kit::square_root(soft());
    const V root = kit::square_root(delassus),
            reached = root * (1.0 + (0.25 + 0.5 * ratio) * (step * stiff * root));
    return (2.0 * ratio * stiff + damping) /
           (by_ratio * reached + given * (1.0 + 0.5 * step * damping * delassus));
  }
};

// Of doubles by their bits: GCC makes two divisions of a quotient of two choices if something later depends
// on their condition.
using kit::chosen;
inline kit::pack chosen(kit::mask m, kit::pack a, kit::pack b) { return select(m, a, b); }

// IsPlain: linear, not rigid, without damper or restitution. The same numbers with less to compute.
template <class V, bool IsPlain = false>
struct compression {
  using Mask = kit::mask_of<V>;

  normal_spring spring;
  V free, previous;  // v_free, v^-
  V delassus;
  V indentation;                                           // x
  std::conditional_t<IsPlain, kit::sure_zero, V> damping;  // c

  // opens: 1 where the way ends open, else 0; end: x'. The impulse falls by gain/(1 + gain H) where v_free
  // grows by 1; pace: scale (1 + gain H), gain times as much as it is where the spring opens.
  struct solution {
    V impulse, opens, end, gain, pace;
  };

  V mean_velocity(V v) const { return 0.5 * (previous + v); }
  V travel(V v) const {
    if constexpr (IsPlain) return 0.5 * spring.step * (previous + v);
    return spring.step * (mean_velocity(v) + lead() * kit::positive_part(v - previous));
  }

  // With lengths that a power of two brings to [2, 4) where they are squared, so that squares stay within the
  // range of numbers. Not so H, which no length measures: times what brings up that of a node at rest it is
  // infinite.
  solution linear() const {
    const V most = kit::larger(spring.step * (kit::absolute(free) + kit::absolute(previous)), indentation);
    return linear(V(1.0), free, delassus, kit::power_scale_of(most));
  }

  // p = 1, for v_free and H times `scale` as they are given: so they need not be divided by a determinant.
  // One division, of what gives r/2, and one square root. What is the same at all nodes is multiplied first.
  solution linear(V scale, V v_free, V h, kit::power_scale<V> lengths = {1.0, 2.0}) const {
    const double step = spring.step;
    const auto closed = stay_closed(scale, v_free, h);
    const Mask opens = closed.opening > 0.0;

    // If that lets it open, r travel = h x <k x/2 - c vbar>, a quadratic equation.
    const V held = kit::positive_part(closed.held - 0.5 * step * damping * closed.sum);
    const V x = lengths.down * indentation, linear = closed.way + 0.5 * step * indentation * damping * h;
    const V way = lengths.down * linear, rest = lengths.down * held;
    const V root = kit::square_root(way * way + closed.give * (x * rest));
    const V over = kit::select(linear > 0.0, x * held, (root - way) * (0.5 * lengths.up));
    const V under = kit::select(linear > 0.0, way + root, closed.give);

    const V half = chosen(opens, over, closed.over) / chosen(opens, under, closed.under), r = half + half;
    const V stretch = step * (0.5 + closed.part), opening = r * stretch + 0.5 * step * indentation * damping;
    return {r, kit::select(opens, V(1.0), V(0.0)), V(0.0),
            kit::select(opens, opening, 0.5 * step * (spring.soft() * stretch + damping)),
            kit::select(opens, root, closed.under)};
  }

  // Closed to the end, all is linear: r/2 = over/under, where that does not let it open.
  struct closed_spring {
    V over, under, held, way, sum, give;
    std::conditional_t<IsPlain, kit::sure_zero, V> part;
    V opening;  // positive where it does; no truth, of which GCC would make branches
  };
  closed_spring stay_closed() const { return stay_closed(V(1.0), free, delassus); }
  closed_spring stay_closed(V scale, V v_free, V h) const {
    const double step = spring.step, push = 0.5 * step * spring.soft();
    const auto rigid = if_rigid(1.0), never = if_rigid(kit::infinity);
    const V before = scale * previous, x = scale * indentation, sum = v_free + before, held = push * x;
    const auto part = leading_part(scale, v_free, h);
    const V way = 0.5 * step * sum + step * part * (v_free - before),
            give = 2.0 * step * h * (1.0 + 2.0 * part);
    const V drive = held - 0.5 * push * way - 0.25 * step * damping * sum -
                    rigid * (0.25 * sum + 0.5 * part * (v_free - before));
    const V over = kit::positive_part(drive), open = x - way;
    const V resists =
        (1.0 - rigid) * scale + 0.25 * push * give + 0.5 * step * damping * h + rigid * (h * (0.5 + part));
    return {over, resists, held, way, sum, give, part, give * over - (open + open) * resists - never};
  }

  // Whether a linear spring pushes in the free step, without a division.
  Mask linear_pushes() const {
    const V way = kit::smaller(travel(free), indentation);
    return spring.soft() * (indentation - 0.5 * way) - damping * mean_velocity(free) > 0.0;
  }

  // x' of a linear spring, and where it is stiff from its force, which then is the more accurate.
  V next(V impulse, V opens) const {
    const V v = free + delassus * impulse;
    const V moved = kit::positive_part(indentation - travel(v));
    const double step = spring.step, k = spring.soft();
    const V pressed = 2.0 / (k * step) * impulse + 2.0 / k * (damping * mean_velocity(v)) - indentation;
    const V closed = kit::select(is_told_by_force(impulse), kit::positive_part(pressed), moved);
    return (1.0 - if_rigid(1.0)) * (1.0 - opens) * closed;
  }
  Mask is_told_by_force(V impulse) const {
    const double step = spring.step;
    return (step * step * spring.soft() * delassus > 4.0) & (impulse > 0.0);
  }

  // p = 3/2, lead 0, for the same scaled numbers. With q = h^2 k H/5, B = 1 + h c H/2, a = sqrt(x) and
  // z = x', a spring that stays closed has
  //     (q a + B) z + q T(z) = D,    T = z^2/(a + sqrt(z)),    D = B x - h (v_free + v^-)/2 - q a^3,
  // since (a^5 - z^(5/2))/(a^2 - z) = a^3 + a z + T. T is convex: Newton's method falls to the root from the
  // solution without T, and its next z is a quotient of sums of positive terms.
  solution hertz(V scale, V v_free, V h) const {
    const double step = spring.step;
    const V x = indentation, inverse = 1.0 / scale, a = kit::square_root(x);
    const V give = 0.5 * step * h * inverse, way = 0.5 * step * (v_free * inverse + previous);
    const double force = 0.4 * spring.stiffness * step;
    const V q = give * force, b = 1.0 + give * damping, slope = q * a + b;
    const V rest = b * x - way - q * a * x;
    const Mask opens = !(rest >= 0.0);
    const V z = indentation_of_hertz(a, q, slope, kit::select(opens, V(0.0), rest));

    // Where the tangents of force and inertia meet.
    const V y = kit::square_root(z), sum = a + y, part = kit::select(sum > 0.0, z / sum, V(0.0));
    const V tangent = force * (a + part * kit::select(sum > 0.0, (2.0 * a + 1.5 * y) / sum, V(0.0)));
    const V stiff = tangent + damping, pushes = force * (a * x + a * z + part * z) - damping * (x - z);
    const V drive = pushes + stiff * ((x - z) - way), resists = 1.0 + give * stiff;

    // As for the linear spring; P(x) = k x^(5/2)/(5/2).
    const V linear = way + give * damping * x;
    const V constant = x * kit::positive_part(force * (a * x) - damping * way);
    const V root = kit::square_root(linear * linear + 4.0 * give * constant);
    const V over = kit::select(linear > 0.0, 2.0 * constant, root - linear);
    const V under = kit::select(linear > 0.0, linear + root, 2.0 * give);

    const V r = kit::select(opens, over, kit::positive_part(drive)) / kit::select(opens, under, resists);
    const V end = kit::select(drive > 0.0, z, kit::positive_part(x - way));
    return {r, kit::select(opens, V(1.0), V(0.0)), kit::select(opens, V(0.0), end),
            0.5 * step * kit::select(opens, r + damping * x, stiff),
            scale * kit::select(opens, root, resists)};
  }

 private:
  auto lead() const {
    if constexpr (IsPlain)
      return kit::sure_zero{};
    else
      return spring.lead;
  }
  auto if_rigid(double x) const {
    if constexpr (IsPlain)
      return kit::sure_zero{};
    else
      return spring.is_rigid() ? x : 0.0;
  }
  auto leading_part(V scale, V v_free, V h) const {
    if constexpr (IsPlain)
      return kit::sure_zero{};
    else
      return kit::select(leads(scale, v_free, h), V(spring.lead), V(0.0));
  }
  // Whether v > v^- in the end: whether at v = v^- the spring gives more than leads there. One comparison of
  // what was chosen, since GCC vectorises no choice between conditions.
  Mask leads(V scale, V v_free, V h) const {
    const double step = spring.step, k = spring.soft(), rigid = if_rigid(1.0);
    const V before = scale * previous, x = scale * indentation, way = step * before,
            viscous = damping * before;
    const V closed = kit::positive_part(k * (x - 0.5 * way) - viscous);
    const V opening = x * kit::positive_part(0.5 * k * x - viscous);
    const V reach = (1.0 - rigid) * ((before - v_free) * scale), push = step * h;
    const V given = push * kit::select(way <= x, closed, opening) - rigid * before;
    return given > kit::select(way <= x, reach, reach * way);
  }

  static V indentation_of_hertz(V a, V q, V slope, V rest) {
    constexpr int most_steps = 40;
    constexpr double close = 0x1p-26;  // the step that follows squares it
    V z = rest / slope;
    Mask active = z > 0.0;
    for (int k = 0; k < most_steps && kit::any(active); ++k) {
      const V y = kit::square_root(z), sum = a + y, bent = q * z, square = sum * sum;
      const V next =
          (bent * z * (a + 0.5 * y) + rest * square) / (slope * square + bent * (2.0 * a + 1.5 * y));
      const Mask far = z - next > close * next;
      z = kit::select(active, next, z);
      active = active & far;
    }
    return kit::select(active, V(std::numeric_limits<double>::quiet_NaN()), z);
  }
};

}  // namespace penalty_law
