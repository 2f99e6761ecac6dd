// spring.hpp - one step of the implicit normal spring, an equation with one unknown:
//
//     r = h <S(x, x') - c phi vbar>,    v = v_free + H r,    vbar = (v^- + v)/2,
//     x' = <x - way>,    way = h (vbar + tau <v - v^->),
//
// S: mean force of the spring on its way, (P(x) - P(x'))/way, P = k x^(p+1)/(p+1); phi: the part of the way on
// which it is closed. The right-hand side never increases with r: one solution. penalty.md derives it.
#pragma once

#include <ilaw/kit/roots.hpp>
#include <ilaw/kit/symmetric.hpp>

namespace penalty_law {

using namespace ilaw::kit;

// The damper's part of the critical one with which a linear spring that does not pull gives back the part e of a
// velocity: -ln e = 2 zeta acos(zeta)/sqrt(1 - zeta^2) (Schwager and Poeschel 2007, eq. 17; beyond 1 with the
// hyperbolic functions). Inverted by a polynomial, to 3e-4 in e. Below the least e nothing would ever let go.
template <class V>
V damping_ratio(V restitution) {
  constexpr double least = 0.03, pi = 3.14159265358979323846;
  const V lost = 0.0 - log(larger(restitution, V(least)));
  return lost / pi * (((0.0081 * lost + 0.022) * lost + 0.2088) * lost + 1.0);
}

// x^p, without logarithms where all lanes have a usual exponent.
template <class V>
ILAW_KIT_INLINE V to_exponent(V x, V p) {
  if (!any(p != 1.0)) return x;
  if (!any(p != 1.5)) return x * square_root(x);
  if (!any(p != 0.5)) return square_root(x);
  return power(x, p);
}

// The equation of a step, of one node or a pack of them.
template <class V>
struct spring_problem {
  V step, stiffness, exponent, lead, damping;  // h, k, p, tau, c
  V free, previous, delassus, indentation;     // v_free, v^-, H, x
};

// Loses: false for a linear spring of finite stiffness, c = tau = 0: the same numbers with less to compute.
template <class V, bool Loses>
struct normal_spring : spring_problem<V> {
  using base = spring_problem<V>;
  using base::step, base::stiffness, base::exponent, base::free, base::previous, base::delassus, base::indentation;
  using mask = mask_of<V>;

  // opens: 1 where the way ends open, else 0; end: x'. The impulse falls by gain/(1 + gain H) where v_free grows by
  // 1; pace: scale (1 + gain H), gain times as much as it is where the spring opens.
  struct solution {
    V impulse, opens, end, gain, pace;
  };

  ILAW_KIT_INLINE V mean_velocity(V v) const { return 0.5 * (previous + v); }
  ILAW_KIT_INLINE V way(V v) const {
    if constexpr (!Loses) return 0.5 * step * (previous + v);
    return step * (mean_velocity(v) + lead() * positive_part(v - previous));
  }

  // p = 1. With lengths that a power of two brings to [2, 4) where they are squared, so that squares stay within the
  // range of numbers. Not so H, which no length measures.
  ILAW_KIT_INLINE solution linear() const {
    const V most = larger(step * (absolute(free) + absolute(previous)), indentation);
    return linear(V(1.0), free, delassus, power_scale_of(most));
  }
  // For v_free and H times `scale` as they are given, so that they need not be divided by a determinant. One division,
  // of what gives r/2, and one square root.
  ILAW_KIT_INLINE solution linear(V scale, V v_free, V h, power_scale<V> lengths = {1.0, 2.0}) const {
    // Closed to the end: r/2 = numerator/denominator, where that does not let it open.
    const auto rigid = where_rigid(1.0), never = where_rigid(infinity);
    const V push = 0.5 * step * soft(), before = scale * previous, x = scale * indentation, sum = v_free + before;
    const auto part = leading_part(scale, v_free, h);
    const V travel = 0.5 * step * sum + step * part * (v_free - before), give = 2.0 * step * h * (1.0 + 2.0 * part);
    const V drive = push * x - 0.5 * push * travel - 0.25 * step * damping() * sum -
                    rigid * (0.25 * sum + 0.5 * part * (v_free - before));
    const V closed = positive_part(drive), open = x - travel;
    const V resists =
        (1.0 - rigid) * scale + 0.25 * push * give + 0.5 * step * damping() * h + rigid * (h * (0.5 + part));
    const mask opens = give * closed - (open + open) * resists - never > 0.0;

    // If that lets it open, r way = h x <k x/2 - c vbar>, a quadratic equation.
    const V held = positive_part(push * x - 0.5 * step * damping() * sum);
    const V small = lengths.down * indentation, free_way = travel + 0.5 * step * indentation * damping() * h;
    const V b = lengths.down * free_way;
    const V root = square_root(b * b + give * (small * (lengths.down * held)));
    const V numerator = select(free_way > 0.0, small * held, (root - b) * (0.5 * lengths.up));
    const V denominator = select(free_way > 0.0, b + root, give);

    const V half = select(opens, numerator, closed) / select(opens, denominator, resists), r = half + half;
    const V stretch = step * (0.5 + part), opening = r * stretch + 0.5 * step * indentation * damping();
    return {r, select(opens, V(1.0), V(0.0)), V(0.0),
            select(opens, opening, 0.5 * step * (soft() * stretch + damping())), select(opens, root, resists)};
  }

  // Whether a linear spring pushes in the free step, without a division.
  ILAW_KIT_INLINE mask linear_pushes() const {
    if constexpr (!Loses) return (indentation > 0.0) | (free + previous < 0.0);
    const V closed_way = smaller(way(free), indentation);
    return soft() * (indentation - 0.5 * closed_way) - damping() * mean_velocity(free) > 0.0;
  }
  // x' of a linear spring, and where it is stiff from its force, which then is the more accurate.
  ILAW_KIT_INLINE V next(V impulse, V opens) const {
    const V v = free + delassus * impulse, k = soft(), moved = positive_part(indentation - way(v));
    const V pressed = 2.0 / (k * step) * impulse + 2.0 / k * (damping() * mean_velocity(v)) - indentation;
    const mask by_force = (step * step * k * delassus > 4.0) & (impulse > 0.0);
    return (1.0 - where_rigid(1.0)) * (1.0 - opens) * select(by_force, positive_part(pressed), moved);
  }

  // p = 3/2, tau = 0, for the same scaled numbers. With q = h^2 k H/5, B = 1 + h c H/2, a = sqrt(x) and z = x', a
  // spring that stays closed has
  //     (q a + B) z + q T(z) = D,    T = z^2/(a + sqrt(z)),    D = B x - h (v_free + v^-)/2 - q a^3.
  ILAW_KIT_INLINE solution hertz(V scale, V v_free, V h) const {
    const V x = indentation, inverse = 1.0 / scale, a = square_root(x), c = damping();
    const V give = 0.5 * step * h * inverse, travel = 0.5 * step * (v_free * inverse + previous);
    const V force = 0.4 * stiffness * step, q = give * force, b = 1.0 + give * c, slope = q * a + b;
    const V d = b * x - travel - q * a * x;
    const mask opens = !(d >= 0.0);
    const V z = hertz_end(a, q, slope, select(opens, V(0.0), d));

    // Where the tangents of force and motion meet.
    const V y = square_root(z), sum = a + y, part = zero_unless(sum > 0.0, z / sum);
    const V tangent = force * (a + part * zero_unless(sum > 0.0, (2.0 * a + 1.5 * y) / sum));
    const V stiff = tangent + c, pushes = force * (a * x + a * z + part * z) - c * (x - z);
    const V drive = pushes + stiff * ((x - z) - travel), resists = 1.0 + give * stiff;

    // As for the linear spring; P(x) = k x^(5/2)/(5/2).
    const V linear = travel + give * c * x, constant = x * positive_part(force * (a * x) - c * travel);
    const V root = square_root(linear * linear + 4.0 * give * constant);
    const V numerator = select(linear > 0.0, 2.0 * constant, root - linear);
    const V denominator = select(linear > 0.0, linear + root, 2.0 * give);

    const V r = select(opens, numerator, positive_part(drive)) / select(opens, denominator, resists);
    const V end = select(drive > 0.0, z, positive_part(x - travel));
    return {r, select(opens, V(1.0), V(0.0)), zero_unless(!opens, end),
            0.5 * step * select(opens, r + c * x, stiff), scale * select(opens, root, resists)};
  }

  // Any p: the impulse h <S - c phi vbar> that spring and damper give on a way that ends with v.
  V given(V v) const {
    const V travel = way(v), end = positive_part(indentation - travel);
    const V closed = select(travel > indentation, indentation / travel, V(1.0));
    return step * positive_part(closed * mean_force(indentation, end) - closed * damping() * mean_velocity(v));
  }
  // The impulse r where f(r), the force for a step with r less r itself, is zero; NaN where it has no root, which only
  // friction that is coupled to the normal brings about. f(0) is the force of the free step: an upper bound else.
  template <class Function>
  static V impulse_where(mask active, Function f) {
    constexpr int most_doublings = 64;
    bracket<V> b{0.0, f(V(0.0)), 0.0, 0.0};
    active = active & (b.at_low > 0.0);
    if (!any(active)) return 0.0;
    b.high = zero_unless(active, b.at_low);
    b.at_high = f(b.high);
    for (int k = 0; k < most_doublings && any(active & (b.at_high > 0.0)); ++k) {
      b.high = select(active & (b.at_high > 0.0), 2.0 * b.high, b.high);
      b.at_high = f(b.high);
    }
    const mask none = active & (b.at_high > 0.0);
    return select(none, V(not_a_number), root_in(b, active & !none, f));
  }
  // What an impulse leads to, where v_free is what friction has made of it.
  V end_with(V impulse, V v_free) const {
    normal_spring moved = *this;
    moved.free = v_free;
    const V left = indentation - way(v_free + delassus * impulse);
    return select(exponent == 1.0, moved.next(impulse, select(left < 0.0, V(1.0), V(0.0))), positive_part(left));
  }

  // The spring alone, whatever its exponent.
  ILAW_KIT_INLINE void solve(V& impulse, V& end) const {
    const mask is_linear = (exponent == 1.0) | (stiffness == infinity), is_hertz = (!is_linear) & (exponent == 1.5);
    mask left = !is_linear;
    impulse = end = 0.0;
    if (any(is_linear)) {
      const solution found = linear();
      impulse = found.impulse;
      end = next(found.impulse, found.opens);
    }
    if (any(is_hertz)) {
      const solution found = hertz(V(1.0), free, delassus);
      const mask solved = is_hertz & (found.impulse < infinity);
      impulse = select(solved, found.impulse, impulse);
      end = select(solved, found.end, end);
      left = left & !solved;
    }
    if (any(left)) solve_by_brackets(left, impulse, end);
  }

 private:
  auto damping() const {
    if constexpr (Loses)
      return base::damping;
    else
      return sure_zero{};
  }
  auto lead() const {
    if constexpr (Loses)
      return base::lead;
    else
      return sure_zero{};
  }
  auto where_rigid(double value) const {
    if constexpr (Loses)
      return zero_unless(stiffness == infinity, V(value));
    else
      return sure_zero{};
  }
  // What a rigid spring multiplies by it counts nowhere.
  ILAW_KIT_INLINE V soft() const {
    if constexpr (!Loses) return stiffness;
    return zero_unless(stiffness < infinity, stiffness);
  }
  auto leading_part(V scale, V v_free, V h) const {
    if constexpr (Loses)
      return zero_unless(leads(scale, v_free, h), lead());
    else
      return sure_zero{};
  }
  // Whether v > v^- in the end: whether at v = v^- the spring gives more than leads there.
  ILAW_KIT_INLINE mask leads(V scale, V v_free, V h) const {
    const V k = soft(), rigid = where_rigid(1.0), before = scale * previous, x = scale * indentation;
    const V travel = step * before, viscous = damping() * before;
    const V closed = positive_part(k * (x - 0.5 * travel) - viscous);
    const V opening = x * positive_part(0.5 * k * x - viscous);
    const V reach = (1.0 - rigid) * ((before - v_free) * scale), push = step * h;
    const V given = push * select(travel <= x, closed, opening) - rigid * before;
    return given > select(travel <= x, reach, reach * travel);
  }

  // T is convex: Newton's method falls to the root from the solution without T, and its next z is a quotient of sums
  // of positive terms.
  ILAW_KIT_INLINE static V hertz_end(V a, V q, V slope, V d) {
    constexpr int most_steps = 40;
    constexpr double close = 0x1p-26;  // the step that follows squares it
    V z = d / slope;
    mask active = z > 0.0;
    for (int k = 0; k < most_steps && any(active); ++k) {
      const V y = square_root(z), sum = a + y, bent = q * z, square = sum * sum;
      const V next = (bent * z * (a + 0.5 * y) + d * square) / (slope * square + bent * (2.0 * a + 1.5 * y));
      const mask far = z - next > close * next;
      z = select(active, next, z);
      active = active & far;
    }
    return select(active, V(not_a_number), z);
  }

  [[gnu::noinline]] void solve_by_brackets(mask left, V& impulse, V& end) const {
    const V r = impulse_where(left, [this](V trial) { return given(free + delassus * trial) - trial; });
    impulse = select(left, r, impulse);
    end = select(left, end_with(r, free), end);
  }
  // (P(x) - P(x'))/(x - x'), without cancelling where both are close.
  V mean_force(V x, V end) const {
    const V linear = 0.5 * stiffness * (x + end), most = larger(x, end), least = smaller(x, end);
    if (!any(exponent != 1.0)) return linear;
    const V general = zero_unless(most > 0.0, stiffness * power(most, exponent) * mean_power(least / most));
    return select(exponent == 1.0, linear, general);
  }
  // (1 - t^(p+1))/((p + 1) (1 - t)), by its series in 1 - t where that is small.
  V mean_power(V t) const {
    constexpr int series_terms = 16;
    const V q = exponent + 1.0, d = 1.0 - t;
    V sum = 1.0, term = 1.0;
    for (int k = 1; k < series_terms; ++k) {
      term *= d * (static_cast<double>(k) - q) / (k + 1.0);
      sum += term;
    }
    return select(d > 0x1p-4, (1.0 - t * power(t, exponent)) / (q * d), sum);
  }
};

}  // namespace penalty_law
