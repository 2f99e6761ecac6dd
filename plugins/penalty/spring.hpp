// spring.hpp - one step of the implicit normal spring, one unknown (docs/theory/springs.md):
//     r = h <S - c phi vbar>,  v = v_free + H r,  vbar = (v^- + v)/2,  way = h (vbar + tau <v - v^->),
//     x' = <x - way>,  S = phi (P(x) - P(x'))/(x - x'),  P = k x^(p+1)/(p+1),  phi = min(1, x/way).
// While v < v^- a linear spring takes its lead back, -h tau <v^- - v>, as far as W, the work withheld, lasts.
#pragma once

#include <ilaw/kit/roots.hpp>
#include <ilaw/kit/vector.hpp>

namespace penalty_law {

using namespace ilaw::kit;

// The damper's part of the critical one with which a linear spring that does not pull gives back the part e
// of a velocity: -ln e = 2 zeta acos(zeta)/sqrt(1 - zeta^2) (Schwager and Poeschel 2007, eq. 17; beyond 1
// with the hyperbolic functions). Inverted by a polynomial, to 3e-4 in e. Below the least e nothing would
// ever let go.
template <class V>
V damping_ratio(V restitution) {
  constexpr double least = 0.03, pi = 3.14159265358979323846;
  using ilaw::kit::log;  // not libm's, whatever V is
  const V lost = 0.0 - log(larger(restitution, V(least)));
  return lost / pi * (((0.0081 * lost + 0.022) * lost + 0.2088) * lost + 1.0);
}

// x^p, without logarithms where all lanes have a usual exponent.
template <class V>
[[gnu::noinline]] V any_power(V x, V p) {
  return power(x, p);
}
template <class V>
ILAW_KIT_INLINE V to_exponent(V x, V p) {
  if (!any(p != 1.0)) return x;
  if (!any(p != 1.5)) return x * square_root(x);
  if (!any(p != 0.5)) return square_root(x);
  return any_power(x, p);
}

template <class V>
struct spring_solution {
  V impulse, end, inertia;  // r_N, x', and v_free by which r_N falls by 1

  ILAW_KIT_INLINE friend spring_solution select(mask_of<V> m, spring_solution a, spring_solution b) {
    return {select(m, a.impulse, b.impulse), select(m, a.end, b.end), select(m, a.inertia, b.inertia)};
  }
};

// Loss: V, or sure_zero for a linear spring of finite stiffness with c = tau = 0: the same numbers with less
// to compute.
template <class V, class Loss = V>
struct normal_spring {
  V step, stiffness, exponent;              // h, k, p
  V free, previous, delassus, indentation;  // v_free, v^-, H, x
  Loss damping, lead;                       // c, tau
  Loss withheld{};                          // W

  using mask = mask_of<V>;
  using solution = spring_solution<V>;
  static constexpr bool loses = std::is_same_v<Loss, V>;

  ILAW_KIT_INLINE V mean_velocity(V v) const { return 0.5 * (previous + v); }
  ILAW_KIT_INLINE V way(V v) const {
    const V ahead = step * (mean_velocity(v) + lead * positive_part(v - previous));
    if constexpr (loses)
      if (any(withheld > 0.0)) return select((withheld > 0.0) & (v < previous), way_back(v), ahead);
    return ahead;
  }
  // W after a step that ends with v and x', at most `most`.
  V withheld_after(V v, V end, V most) const requires loses {
    const V work = 0.5 * soft() * (indentation + end) * (step * lead * (v - previous));
    return zero_unless(end > 0.0, smaller(positive_part(withheld + work), most));
  }

  // p = 1.
  ILAW_KIT_INLINE solution linear() const requires(!loses) { return linear_with(Loss{}, stiffness, Loss{}); }
  ILAW_KIT_INLINE solution linear() const requires(loses) {
    const V k = soft(), rigid = select(stiffness == infinity, V(1.0), V(0.0));
    const mask goes_on = leads(k, rigid);
    const solution found = linear_with(zero_unless(goes_on, lead), k, rigid);
    const mask returns = (withheld > 0.0) & !goes_on;
    return any(returns) ? select(returns, linear_back(k), found) : found;
  }
  // With this tau, whatever the sign of v - v^-.
  ILAW_KIT_INLINE solution linear_with(Loss tau, V k, Loss rigid) const {
    Loss never{};
    if constexpr (loses) never = select(stiffness == infinity, V(infinity), V(0.0));
    // Closed to the end all is linear, r/2 = drive/resists, where that does not let it open.
    const V h = delassus, x = indentation, push = 0.5 * step * k, sum = free + previous;
    const V travel = 0.5 * step * sum + step * tau * (free - previous);
    const V give = 2.0 * step * h * (1.0 + 2.0 * tau), open = x - travel;
    const V drive = positive_part(push * x - 0.5 * push * travel - 0.25 * step * damping * sum -
                                  rigid * (0.25 * sum + 0.5 * tau * (free - previous)));
    const V resists =
        (1.0 - rigid) * V(1.0) + 0.25 * push * give + 0.5 * step * damping * h + rigid * (h * (0.5 + tau));
    const mask opens = give * drive - (open + open) * resists - never > 0.0;

    // Where it opens within the step, S = P(x)/way.
    const V held = positive_part(push * x - 0.5 * step * damping * sum);
    const quotient open_way = opening(x, travel + 0.5 * step * x * damping * h, give, held);
    const V half = select(opens, open_way.numerator, drive) / select(opens, open_way.denominator, resists);
    const V r = half + half, stretch = step * (0.5 + tau);
    const V gain =
        select(opens, r * stretch + 0.5 * step * x * damping, 0.5 * step * (k * stretch + damping));
    return {r, zero_unless(!opens, linear_end(r)), select(opens, open_way.root, resists) / gain};
  }

  // p = 3/2, tau = 0. With q = h^2 k H/5, B = 1 + h c H/2, a = sqrt(x) and z = x', a spring that stays closed
  // has
  //     (q a + B) z + q T(z) = D,    T = z^2/(a + sqrt(z)),    D = B x - h (v_free + v^-)/2 - q a^3.
  ILAW_KIT_INLINE solution hertz() const {
    const V x = indentation, a = square_root(x), c = damping;
    const V give = 0.5 * step * delassus, travel = 0.5 * step * (free + previous);
    const V force = 0.4 * stiffness * step;
    const V q = give * force, b = 1.0 + give * c, d = b * x - travel - q * a * x;
    const mask opens = !(d >= 0.0);
    const V z = hertz_end(a, q, q * a + b, select(opens, V(0.0), d));

    // Where the tangents of force and motion meet.
    const V y = square_root(z), sum = a + y, part = zero_unless(sum > 0.0, z / sum);
    const V stiff = force * (a + part * zero_unless(sum > 0.0, (2.0 * a + 1.5 * y) / sum)) + c;
    const V pushes = force * (a * x + a * z + part * z) - c * (x - z);
    const V drive = pushes + stiff * ((x - z) - travel), resists = 1.0 + give * stiff;

    const V held = positive_part(force * (a * x) - c * travel);  // P(x) = k x^(5/2)/(5/2)
    const quotient open_way = opening(x, travel + give * c * x, 4.0 * give, held);
    const V half = select(opens, open_way.numerator, positive_part(drive)) /
                   select(opens, open_way.denominator, resists + resists);
    const V r = half + half, gain = 0.5 * step * select(opens, r + c * x, stiff);
    return {r, zero_unless(!opens, select(drive > 0.0, z, positive_part(x - travel))),
            select(opens, open_way.root, resists) / gain};
  }

  // Any p: the impulse h <S - c phi vbar> that spring and damper give on a way that ends with v.
  V given(V v) const {
    const V travel = way(v), end = positive_part(indentation - travel);
    const V phi = select(travel > indentation, indentation / travel, V(1.0));
    return step * positive_part(phi * mean_force(end) - phi * damping * mean_velocity(v));
  }
  // x' of an impulse, whatever p.
  V end_with(V impulse) const {
    const V left = positive_part(indentation - way(free + delassus * impulse));
    return zero_unless(stiffness < infinity,
                       select((exponent == 1.0) & (left > 0.0), linear_end(impulse), left));
  }
  // The impulse r that is f(r), the force for a step with r; NaN where there is none, which only friction
  // that is coupled to the normal brings about. f(0), the force of the free step, is a bound else.
  template <class Function>
  static V impulse_where(mask active, Function f) {
    constexpr int most_doublings = 64;
    constexpr double least =
        std::numeric_limits<double>::min();   // below it f jumps at 0, if its bound is not
    constexpr double least_bound = 0x1p-800;  // so small itself: that is no force
    V high = f(V(0.0));
    active = active & (high > least_bound);
    mask rises = active;
    for (int k = 0; k < most_doublings && any(rises); ++k) {
      rises = rises & (f(high) > high);
      high = select(rises, 2.0 * high, high);
    }
    const V r = root_between(V(0.0), high, high, active & !rises, [&f](V x) {
      return root_trial<V>{x - f(x), 1.0, 1.0, 1.0, x != x};
    });
    return select(active & (rises | (r < least)), V(not_a_number), zero_unless(active, r));
  }

  // By what closes the step: closed form, Newton's method or brackets.
  ILAW_KIT_INLINE solution solve() const requires(!loses) { return linear(); }
  ILAW_KIT_INLINE solution solve() const requires(loses) {
    const mask is_linear = (exponent == 1.0) | (stiffness == infinity);
    if (!any(!is_linear)) return linear();
    solution found = hertz();
    const mask left = !(is_linear | ((exponent == 1.5) & (found.impulse < infinity)));
    if (any(is_linear)) found = select(is_linear, linear(), found);
    if (any(left)) solve_by_brackets(left, found);
    return found;
  }

 private:
  // r (linear + give r/4) = length held, the quadratic equation of a spring that opens: r/2, not yet divided.
  // Lengths that are squared are brought to [2, 4) by a power of two, to stay within the range of numbers.
  struct quotient {
    V numerator, denominator, root;
  };
  ILAW_KIT_INLINE quotient opening(V length, V linear, V give, V held) const {
    const power_scale<V> scale = power_scale_of(larger(step * (absolute(free) + absolute(previous)), length));
    const V x = scale.down * length, b = scale.down * linear;
    const V root = square_root(b * b + give * (x * (scale.down * held)));
    const V unscaled = 0.5 * scale.up;
    return {select(linear > 0.0, x * held, (root - b) * unscaled), select(linear > 0.0, b + root, give),
            root * unscaled};
  }
  // The stiffness, or zero for a rigid spring, where products with it are not used.
  ILAW_KIT_INLINE V soft() const { return zero_unless(stiffness < infinity, stiffness); }
  // S along a way that the spring goes in a step, p = 1.
  ILAW_KIT_INLINE V force_along(V travel) const {
    const V x = indentation;
    return 0.5 * soft() * select(travel > x, x * x / travel, x + x - travel);
  }
  // S = k (x - h vbar/2) + k W/(2 S): all of W is given back. Where it opens, S = (P(x) + W)/(h vbar).
  [[gnu::noinline]] V way_back(V v) const {
    const V mean = step * mean_velocity(v), all = mean + step * lead * (v - previous), k = soft();
    const mask lasts = force_along(all) * (mean - all) <= withheld;
    const V b = k * (indentation - 0.5 * mean), root = square_root(b * b + 2.0 * k * withheld);
    const V force = select(b > 0.0, 0.5 * (b + root), k * withheld / (root - b));
    const V closed = mean - withheld / force, open = mean * (indentation / stretched());
    return select(lasts, all, select(2.0 * force > k * indentation, closed, open));
  }
  // x (1 + W/P(x)).
  ILAW_KIT_INLINE V stretched() const { return indentation + 2.0 * withheld / (soft() * indentation); }
  // The step with v < v^-: all of the lead is taken back, or what W lasts for.
  [[gnu::noinline]] solution linear_back(V k) const {
    const solution all = linear_with(lead, k, V(0.0));
    const V v = free + delassus * all.impulse, turned = step * lead * (previous - v);
    const mask lasts = force_along(step * mean_velocity(v) - turned) * turned <= withheld;
    return select(lasts, all, linear_to_the_last(k));
  }
  // All of W is given back. With q = 1 + h c H/2 and s = v_free + v^-, closed to the end,
  //     (q + h^2 k H/4) S^2 - k (q x - h s/4) S - q k W/2 = 0,    r = h (S - c s/2)/q.
  ILAW_KIT_INLINE solution linear_to_the_last(V k) const {
    const V h = delassus, x = indentation, c = damping, sum = free + previous, longer = stretched();
    const V q = 1.0 + 0.5 * step * c * h, resists = q + 0.25 * step * step * k * h;
    const V b = k * (q * x - 0.25 * step * sum), root = square_root(b * b + 2.0 * resists * k * withheld * q);
    const V force = select(b > 0.0, 0.5 * (b + root) / resists, k * withheld * q / (root - b));
    const mask opens = !(2.0 * force > k * x);
    const V held = positive_part(0.5 * step * (k * x - c * sum));
    const quotient open_way = opening(longer, 0.5 * step * (sum + longer * c * h), 2.0 * step * h, held);
    const V open_impulse = 2.0 * (open_way.numerator / open_way.denominator);
    const V r = positive_part(select(opens, open_impulse, step * (force - 0.5 * c * sum) / q));
    const V end = select(r > 0.0, 2.0 * force / k - x, x - way_back(free));
    const V gain = 0.5 * step * select(opens, r + longer * c, 0.5 * step * k * force / root + c);
    return {r, zero_unless(!opens, positive_part(end)), select(opens, open_way.root, q) / gain};
  }
  // Whether v > v^- in the end: whether at v = v^- the spring gives more than leads there.
  ILAW_KIT_INLINE mask leads(V k, V rigid) const {
    const V x = indentation, travel = step * previous, viscous = damping * previous;
    const V closed = positive_part(k * (x - 0.5 * travel) - viscous);
    const V opening = x * positive_part(0.5 * k * x - viscous), reach = (1.0 - rigid) * (previous - free);
    const V given = step * delassus * select(travel <= x, closed, opening) - rigid * previous;
    return given > select(travel <= x, reach, reach * travel);
  }
  // x' of a linear spring that stays closed: by its motion, and where it is stiff by its force, which then is
  // the more accurate.
  ILAW_KIT_INLINE V linear_end(V impulse) const {
    const V v = free + delassus * impulse, k = loses ? soft() : stiffness;
    const V pressed = 2.0 / (k * step) * impulse + 2.0 / k * (damping * mean_velocity(v)) - indentation;
    const mask by_force = (step * step * k * delassus > 4.0) & (impulse > 0.0);
    const V end = positive_part(select(by_force, pressed, indentation - way(v)));
    return loses ? zero_unless(stiffness < infinity, end) : end;
  }
  // T is convex: Newton's method falls to the root from the solution without T, and its next z is a quotient
  // of sums of positive terms.
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
  [[gnu::noinline]] void solve_by_brackets(mask left, solution& found) const {
    const V r = impulse_where(left, [this](V trial) { return given(free + delassus * trial); });
    found = select(left, solution{r, end_with(r), V(not_a_number)}, found);
  }
  // (P(x) - P(x'))/(x - x') = k x^p (1 - t^(p+1))/((p + 1) (1 - t)), t = x'/x, by its series where t is close
  // to 1.
  V mean_force(V end) const {
    constexpr int series_terms = 16;
    const V linear = 0.5 * stiffness * (indentation + end);
    if (!any(exponent != 1.0)) return linear;
    const V most = larger(indentation, end), t = smaller(indentation, end) / most;
    const V q = exponent + 1.0, d = 1.0 - t;
    V sum = 1.0, term = 1.0;
    for (int k = 1; k < series_terms; ++k) {
      term *= d * (static_cast<double>(k) - q) / (k + 1.0);
      sum += term;
    }
    const V mean = select(d > 0x1p-4, (1.0 - t * power(t, exponent)) / (q * d), sum);
    return select(exponent == 1.0, linear, zero_unless(most > 0.0, stiffness * power(most, exponent) * mean));
  }
};

}  // namespace penalty_law
