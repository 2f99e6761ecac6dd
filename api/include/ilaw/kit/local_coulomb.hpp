// local_coulomb.hpp - contact with Coulomb friction at one node for any symmetric positive definite H:
//
//   v = q + H r,  0 <= v_N _|_ r_N >= 0,  |(r_1/mu_1, r_2/mu_2)| <= r_N,  r_T dissipates at most.
//
// The regular solver, for a double or a pack of them, serves weak coupling (one solution), a fair condition
// and no extreme coefficient. Its answer is checked in the rows of the problem itself; what fails is left to
// the exact solver, which serves any problem. The derivation, and which solution is given where there are
// several, is in docs/theory/local_coulomb.md. Only + - * / and square roots: the same bits on every
// processor. No allocation, no state; any thread.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit/vector.hpp>

namespace ilaw::kit::inline ILAW_KIT_LEVEL {

// ---- the regular solver

// h: H00 H11 H22 H01 H02 H12 [1/kg], component 0 normal; q [m/s]; mu: coefficient of each tangential axis, >=
// 0, infinity allowed (no slip along this axis while the contact is pressed).
template <class V>
struct local_problem {
  V h[6], q[3], mu[2];
};

namespace local {

template <class V>
struct regular_answer {
  V r[3];
  mask_of<V> sticks, found;
};

// The contact with its normal row condensed, on a circular cone |rho| <= m r_N with r_i = d_i rho_i: sliding
// is (S + alpha I) rho = -c with need(alpha) = |rho|/m + w.rho = n, and sticking its limit alpha = 0.
// Coupling: V, or sure_zero where H is diagonal.
template <class V, class Coupling>
class regular_contact {
 public:
  using Mask = mask_of<V>;

  regular_contact(const local_problem<V>& p, Coupling n1, Coupling n2, Coupling t12)
      : p_(p), h01_(n1), h02_(n2), h12_(t12), m_(larger(p.mu[0], p.mu[1])), per_m_(1.0 / m_) {
    d1_ = select(p.mu[0] == m_, 1.0, p.mu[0] * per_m_);
    d2_ = select(p.mu[1] == m_, 1.0, p.mu[1] * per_m_);
    const V per_nn = 1.0 / p.h[0];
    const Coupling a1 = d1_ * h01_, a2 = d2_ * h02_;
    w1_ = a1 * per_nn;
    w2_ = a2 * per_nn;
    n_ = -p.q[0] * per_nn;
    s_ = {d1_ * d1_ * p.h[1] - w1_ * a1, d2_ * d2_ * p.h[2] - w2_ * a2, d1_ * d2_ * h12_ - w1_ * a2};
    c1_ = d1_ * (p.q[1] + h01_ * n_);
    c2_ = d2_ * (p.q[2] + h02_ * n_);
  }

  regular_answer<V> solve() const {
    const V det = s_.determinant();
    const trial start = at(0.0);
    const Mask sticks = start.need <= n_ * det;
    // By Cauchy and Schwarz need falls with alpha: one root.
    Mask is_single = sticks | !sticks;
    if constexpr (!std::is_same_v<Coupling, sure_zero>) {
      const V coupling = w1_ * s_.adjugate_1(w1_, w2_) + w2_ * s_.adjugate_2(w1_, w2_);
      is_single = sticks | (m_ * m_ * coupling * s_.trace() < det);
      if (any(!is_single)) is_single = is_single | slides_once(start, det);
    }
    const Mask is_fair = det > least_determinant * (s_.a11 * s_.a22);
    const Mask regular = is_single & is_fair & has_usual_scales();
    Mask active = regular & !sticks;
    const V alpha = multiplier(start, active);
    return checked(alpha, sticks, regular & !active);
  }

 private:
  static constexpr double least_determinant = 0x1p-20;
  static constexpr int most_steps = 12;

  // Whether no product on the way overflows or underflows.
  Mask has_usual_scales() const {
    constexpr double scale = 0x1p128, coefficient = 0x1p32;
    const V *h = p_.h, *mu = p_.mu, speed = largest(p_.q);
    const V least = smaller(smaller(h[0], h[1]), h[2]), most = larger(larger(h[0], h[1]), h[2]);
    return (least > 1.0 / scale) & (most < scale) & (speed > 1.0 / scale) & (speed < scale) &
           (smaller(mu[0], mu[1]) > 1.0 / coefficient) & (m_ < coefficient);
  }
  static V largest(const V* a) { return larger(larger(absolute(a[0]), absolute(a[1])), absolute(a[2])); }

  // rho = -(n1, n2)/det and need, all without their division by det.
  struct trial {
    symmetric_2x2<V, Coupling> s;
    V det, n1, n2, length, need;
  };
  trial at(V alpha) const {
    const symmetric_2x2<V, Coupling> s = s_.shifted(alpha);
    const V n1 = s.adjugate_1(c1_, c2_), n2 = s.adjugate_2(c1_, c2_);
    const V length = square_root(n1 * n1 + n2 * n2);
    return {s, s.determinant(), n1, n2, length, length * per_m_ - (w1_ * n1 + w2_ * n2)};
  }

  // need = n is |N| = m Q, N = N_0 + alpha c and Q = n det(alpha) + w.N, whose square is of fourth degree in
  // alpha: with one change of sign in its coefficients it has one positive root (Descartes).
  Mask slides_once(const trial& start, V det) const {
    const V mm = m_ * m_, q1 = n_ * s_.trace() + (w1_ * c1_ + w2_ * c2_);
    const V q0 = n_ * det + (w1_ * start.n1 + w2_ * start.n2);
    const V p3 = n_ * q1, p2 = mm * (q1 * q1 + 2.0 * n_ * q0) - (c1_ * c1_ + c2_ * c2_);
    const V p1 = mm * q1 * q0 - (c1_ * start.n1 + c2_ * start.n2);
    const Mask turns = ((p3 < 0.0) & ((p2 > 0.0) | (p1 > 0.0))) | ((p2 < 0.0) & (p1 > 0.0));
    return (m_ * absolute(q0) < start.length) & !turns;
  }

  // Where 1/need^2 would be 1/n^2 if it were the parabola with its value at 0 and its two leading terms far
  // away, (alpha + sigma)^2/kappa^2: exact where S is a multiple of I.
  V first_multiplier(const trial& x) const {
    const V length = square_root(c1_ * c1_ + c2_ * c2_);
    const V g1 = c1_ * per_m_ - length * w1_, g2 = c2_ * per_m_ - length * w2_;
    const V kappa = length * per_m_ - (w1_ * c1_ + w2_ * c2_);
    const V sigma = (g1 * s_.row_1(c1_, c2_) + g2 * s_.row_2(c1_, c2_)) / (length * kappa);
    const V far = kappa / n_, near = kappa * x.det / x.need;
    return positive_part(square_root(positive_part(sigma * sigma + (far - near) * (far + near))) - sigma);
  }

  // Newton's method on 1/need = 1/n. Lanes that are done keep their alpha, so that none sees its neighbours;
  // those that are active at the end have none.
  V multiplier(trial x, Mask& active) const {
    constexpr double close = 0x1p-13;  // this step squares it, and so does the last
    V alpha = 0.0;
    if (!any(active)) return alpha;
    alpha = select(active, first_multiplier(x), alpha);
    for (int k = 0;; ++k) {
      x = at(alpha);
      const V target = n_ * x.det, excess = x.need - target;
      const V y1 = x.s.adjugate_1(x.n1, x.n2), y2 = x.s.adjugate_2(x.n1, x.n2);
      const V slope = (x.n1 * per_m_ - x.length * w1_) * y1 + (x.n2 * per_m_ - x.length * w2_) * y2;
      const V next = alpha + x.need * excess * x.length / (n_ * slope);
      alpha = select(active, next, alpha);
      active = active & !(absolute(excess) <= close * target);
      if (k + 1 == most_steps || !any(active)) return alpha;
    }
  }

  // One Newton step on rows and cone, from the residual of rho; then the answer, and whether it holds.
  regular_answer<V> checked(V alpha, Mask sticks, Mask regular) const {
    const symmetric_2x2<V, Coupling> s = s_.shifted(alpha);
    const V inverse = 1.0 / s.determinant();
    const V x = -s.adjugate_1(c1_, c2_) * inverse, y = -s.adjugate_2(c1_, c2_) * inverse;
    const V ex = c1_ + s.row_1(x, y), ey = c2_ + s.row_2(x, y);
    const V fixed_x = -s.adjugate_1(ex, ey) * inverse, fixed_y = -s.adjugate_2(ex, ey) * inverse;
    const V moving_x = -s.adjugate_1(x, y) * inverse, moving_y = -s.adjugate_2(x, y) * inverse;
    const V length = square_root(x * x + y * y);
    const V kx = x * per_m_ + length * w1_, ky = y * per_m_ + length * w2_;
    const V excess = (length * per_m_ + (w1_ * x + w2_ * y)) - n_;
    const V change = select(
        sticks, 0.0, -(excess * length + (kx * fixed_x + ky * fixed_y)) / (kx * moving_x + ky * moving_y));
    const V u = x + (fixed_x + moving_x * change), v = y + (fixed_y + moving_y * change);
    const V cone = square_root(u * u + v * v) * per_m_;
    const V held = n_ - (w1_ * u + w2_ * v);
    regular_answer<V> answer{
        {select(sticks, larger(held, cone), cone), d1_ * u + 0.0, d2_ * v + 0.0}, sticks, regular};
    answer.found = regular & holds(answer, u, v, alpha + change);
    return answer;
  }

  // Whether the rows hold to some ulp of |q| + |H||r|. An impulse that cancels most of what it does is left
  // to the other solver, which rounds it once.
  Mask holds(const regular_answer<V>& a, V u, V v, V alpha) const {
    constexpr double rounding = 3.0 * 0x1p-52, amplified = 16.0;
    const V *h = p_.h, *q = p_.q, *r = a.r;
    const V vn = q[0] + (h[0] * r[0] + h01_ * r[1] + h02_ * r[2]);
    const V v1 = q[1] + (h[1] * r[1] + h01_ * r[0] + h12_ * r[2]);
    const V v2 = q[2] + (h[2] * r[2] + h02_ * r[0] + h12_ * r[1]);
    const V e1 = select(a.sticks, v1, d1_ * v1 + alpha * u), e2 = select(a.sticks, v2, d2_ * v2 + alpha * v);
    const V speed = largest(q), given = larger(larger(h[0], h[1]), h[2]) * largest(r);
    const V worst = larger(larger(absolute(vn), absolute(e1)), absolute(e2));
    return (worst <= rounding * (speed + given)) & (given <= amplified * speed) & (alpha >= 0.0);
  }

  const local_problem<V>& p_;
  Coupling h01_, h02_, h12_, w1_, w2_;
  V m_, per_m_, d1_, d2_, n_, c1_, c2_;
  symmetric_2x2<V, Coupling> s_;
};

}  // namespace local

// Solves the problems with q_N < 0 that are regular; found says which. Where no lane couples, with less to
// work out.
template <class V>
local::regular_answer<V> solve_regular(const local_problem<V>& problem) {
  const V* h = problem.h;
  if (!any((h[3] != 0.0) | (h[4] != 0.0) | (h[5] != 0.0))) {
    const sure_zero none;
    return local::regular_contact<V, sure_zero>(problem, none, none, none).solve();
  }
  return local::regular_contact<V, V>(problem, h[3], h[4], h[5]).solve();
}

// ---- the exact solver

using local_coulomb = local_problem<double>;

// none: the contact is pressed, an axis of infinite friction would have to hold it by a pull (r = 0 then).
enum class contact_mode { free, stick, slip, none };

namespace local {

// Coefficients below this part of the larger one, or of 1, act as zero: their impulse is no ulp of anything.
inline constexpr double negligible = 0x1p-400;

// Sliding in the eigenvectors of the condensed tangential block, where the tangential impulse is -sign_i p_i
// with
//   p_i = c_i/(s_i + alpha),  v_T = -alpha r_T,  r_N = n - w_1 p_1 - w_2 p_2,  |p| = m r_N.
// s_1 <= s_2, c_i >= 0, n > 0.
struct sliding {
  double s1, s2, c1, c2, w1, w2, n, m;

  // The state at one multiplier: impulses p, their length and direction, and need = |p|/m + w.p, the normal
  // impulse without tangential motion that would make this multiplier the right one: the root is need = n.
  struct state {
    double p1, p2, length, u1, u2, need, scale;
  };
  state at(double alpha) const {
    const double p1 = c1 / (s1 + alpha), p2 = c2 / (s2 + alpha), l = length(p1, p2);
    const double inverse = l > 0.0 ? 1.0 / l : 0.0, cone = l / m, a = w1 * p1, b = w2 * p2;
    return {p1, p2, l, p1 * inverse, p2 * inverse, cone + a + b, cone + absolute(a) + absolute(b) + n};
  }
  bool fits(const state& x) const { return x.need <= n; }

  // Newton's step for 1/need = 1/n, which is linear in alpha where s_1 = s_2.
  double step(double alpha, const state& x) const {
    const double ratio = (s1 + alpha) / (s2 + alpha);
    const double slope = x.p1 * (x.u1 / m + w1) + ratio * x.p2 * (x.u2 / m + w2);
    return (s1 + alpha) * (x.need / slope) * ((x.need - n) / n);
  }

  // need - n as a function G of y = p_2/p_1, up to positive factors, has G''' < 0: signs of G'' and G'.
  bool convex(double alpha) const {
    const state x = at(alpha);
    return x.u1 * x.u1 * x.u1 * x.p2 * (s2 - s1) > 2.0 * c1 * (x.u2 + m * w2);
  }
  bool rising(double alpha) const {
    const state x = at(alpha);
    return (s2 - s1) * ((x.u2 / m + w2) * x.p2 - n) > x.need * (s1 + alpha);
  }
};

// Where a property ends that holds at low and not at high.
template <class Holds>
double end_of(double low, double high, Holds holds) {
  for (double x = halfway(low, high); x > low && x < high; x = halfway(low, high))
    (holds(x) ? low : high) = x;
  return low;
}

struct bracket {
  double low, high;
};

// The smallest root alone: G is positive at low, negative at high, convex up to one inflection and concave
// after.
inline bracket first_root(const sliding& f, double high) {
  // Cauchy-Schwarz on the slope: weak coupling leaves one root.
  const double a = smaller(f.w1, 0.0), b = smaller(f.w2, 0.0);
  if (f.m * f.m * (f.s2 * a * a + f.s1 * b * b) < f.s1) return {0.0, high};
  if (!f.convex(0.0) || f.convex(high)) return {0.0, high};
  const double inflection = end_of(0.0, high, [&f](double x) { return f.convex(x); });
  if (f.fits(f.at(inflection))) return {0.0, inflection};
  if (f.rising(0.0) || !f.rising(inflection)) return {inflection, high};
  const double lowest = end_of(0.0, inflection, [&f](double x) { return !f.rising(x); });
  return f.fits(f.at(lowest)) ? bracket{0.0, lowest} : bracket{inflection, high};
}

// The multiplier: Newton within the bracket, which shrinks at every step; bisection should that take long.
inline double multiplier(const sliding& f) {
  constexpr double rounding = 0x1p-52, largest = 0x1p1000;
  constexpr int newton_steps = 16, all_steps = newton_steps + 64;
  const double pull = length(f.c1, f.c2) / f.m + f.c1 * absolute(f.w1) + f.c2 * absolute(f.w2);
  auto [low, high] = first_root(f, smaller(pull / f.n, largest));
  double alpha = low;
  for (int k = 0; k < all_steps; ++k) {
    const sliding::state x = f.at(alpha);
    if (absolute(x.need - f.n) <= rounding * x.scale) break;
    (f.fits(x) ? high : low) = alpha;
    const double newton = alpha + f.step(alpha, x), middle = halfway(low, high);
    const bool good = k < newton_steps && newton > low && newton < high;
    const double next = good ? newton : middle;
    if (!(absolute(next - alpha) > 0.5 * rounding * alpha)) break;
    alpha = next;
  }
  return alpha;
}

// A contact whose two coefficients are finite or whose axis is decoupled; q_N < 0. Symmetric matrix in parts.
struct contact {
  double nn, n1, n2, t11, t22, t12, qn, q1, q2;
};

// Takes the first tangential axis out: it moves no more (v_1 = 0). Elimination, stable as H is definite.
inline contact hold_first(const contact& a) {
  const double k = a.n1 / a.t11, l = a.t12 / a.t11;
  return {.nn = a.nn - k * a.n1,
          .n1 = 0.0,
          .n2 = a.n2 - k * a.t12,
          .t11 = a.t11,
          .t22 = a.t22 - l * a.t12,
          .t12 = 0.0,
          .qn = a.qn - k * a.q1,
          .q1 = 0.0,
          .q2 = a.q2 - l * a.q1};
}
// Takes it out: it gives no impulse.
inline contact drop_first(contact a) {
  a.n1 = a.t12 = a.q1 = 0.0;
  return a;
}
inline contact exchanged(const contact& a) {
  return {a.nn, a.n2, a.n1, a.t22, a.t11, a.t12, a.qn, a.q2, a.q1};
}

struct pair {
  double x, y;
};

// The fraction of a positive number that rounding must leave, so that nothing becomes singular.
inline constexpr double definite = 0x1p-60;

// Eigenvectors (cosine, -sine) and (sine, cosine) of a symmetric matrix, s1 <= s2: Jacobi's rotation, in the
// form that keeps the digits of the small eigenvalue.
struct eigenvectors {
  double cosine, sine, s1, s2;

  eigenvectors(double s11, double s22, double s12) {
    const double zeta = (s22 - s11) / (2.0 * s12);
    const double tangent = (zeta >= 0.0 ? 1.0 : -1.0) / (absolute(zeta) + square_root(1.0 + zeta * zeta));
    const double t = s12 == 0.0 ? 0.0 : tangent, c = 1.0 / square_root(1.0 + t * t);
    const double first = s11 - t * s12, second = s22 + t * s12;
    const bool ordered = first <= second;
    cosine = ordered ? c : t * c;
    sine = ordered ? t * c : -c;
    s2 = larger(first, second);
    s1 = larger(smaller(first, second), definite * smaller(s11, s22));
  }
  pair to(pair a) const { return {cosine * a.x - sine * a.y, sine * a.x + cosine * a.y}; }
  pair from(pair a) const { return {cosine * a.x + sine * a.y, cosine * a.y - sine * a.x}; }
};

// a x + b y + c z + d as in twice the precision (Ogita, Rump, Oishi 2005; products after Dekker 1971).
struct accurate_sum {
  double high = 0.0, low = 0.0;

  void add(double a) {
    const double sum = high + a, part = sum - high;
    low += (high - (sum - part)) + (a - part);
    high = sum;
  }
  void add_product(double a, double b) {
    constexpr double splitter = 0x1p27 + 1.0;
    const double as = splitter * a, bs = splitter * b, product = a * b;
    const double ah = as - (as - a), bh = bs - (bs - b), al = a - ah, bl = b - bh;
    add(product);
    low += ((ah * bh - product) + ah * bl + al * bh) + al * bl;
  }
  double value() const { return high + low; }
};
inline double row(double q, double a, double x, double b, double y, double c, double z) {
  accurate_sum sum;
  sum.add(q);
  sum.add_product(a, x);
  sum.add_product(b, y);
  sum.add_product(c, z);
  return sum.value();
}

// A contact with finite coefficients on a circular cone |rho| <= m r_N, its normal row condensed: r_i = d_i
// rho_i, and the slip that dissipates most has d_i v_i opposite to rho_i.
class cone_contact {
 public:
  cone_contact(const contact& a, double mu1, double mu2)
      : a_(a),
        m_(larger(mu1, mu2)),
        d_{mu1 / m_, mu2 / m_},
        w_{d_.x * a.n1 / a.nn, d_.y * a.n2 / a.nn},
        n_(-a.qn / a.nn),
        axes_(condensed(d_.x * d_.x * a.t11, w_.x * (d_.x * a.n1)),
              condensed(d_.y * d_.y * a.t22, w_.y * (d_.y * a.n2)),
              d_.x * d_.y * a.t12 - w_.x * (d_.y * a.n2)) {}

  contact_mode solve(double* r) const {
    const pair c = axes_.to({d_.x * (a_.q1 + a_.n1 * n_), d_.y * (a_.q2 + a_.n2 * n_)}), w = axes_.to(w_);
    const pair sign{c.x > 0.0 ? -1.0 : 1.0, c.y > 0.0 ? -1.0 : 1.0};
    const sliding f{axes_.s1, axes_.s2, absolute(c.x), absolute(c.y), sign.x * w.x, sign.y * w.y, n_, m_};
    sliding::state x = f.at(0.0);
    const bool sticks = f.fits(x);
    if (!sticks && !(n_ > 0.0)) return contact_mode::none;  // happens beside a held axis only
    const double alpha = sticks ? 0.0 : multiplier(f);
    if (!sticks) x = f.at(alpha);
    give(r, {sign.x * x.p1, sign.y * x.p2}, sticks);
    if (largest(r) > amplified) refine(r, w, alpha, sticks);
    return sticks ? contact_mode::stick : contact_mode::slip;
  }

 private:
  // Scaled H and q are below 4: an impulse above this cancels most of what it does, and rounding shows.
  static constexpr double amplified = 4.0;
  static double condensed(double full, double normal_part) {
    return larger(full - normal_part, definite * full);
  }
  static double largest(const double* r) {
    return larger(absolute(r[0]), larger(absolute(r[1]), absolute(r[2])));
  }

  // Impulse from its tangential part in the eigenvectors. It is in the cone also after rounding.
  void give(double* r, pair p, bool sticks) const {
    const pair rho = axes_.from(p);
    const double held = n_ - (w_.x * rho.x + w_.y * rho.y), cone = length(rho.x, rho.y) / m_;
    r[0] = sticks ? larger(held, cone) : cone;
    r[1] = d_.x * rho.x;
    r[2] = d_.y * rho.y;
  }

  // One Newton step on the three rows and the cone, from their residual in twice the precision.
  void refine(double* r, pair w, double alpha, bool sticks) const {
    const pair rho{r[1] / d_.x, r[2] / d_.y};
    const double vn = row(a_.qn, a_.nn, r[0], a_.n1, r[1], a_.n2, r[2]);
    const double v1 = row(a_.q1, a_.n1, r[0], a_.t11, r[1], a_.t12, r[2]);
    const double v2 = row(a_.q2, a_.n2, r[0], a_.t12, r[1], a_.t22, r[2]);
    const pair e = axes_.to({d_.x * v1 + alpha * rho.x - w_.x * vn, d_.y * v2 + alpha * rho.y - w_.y * vn});
    const pair p = axes_.to(rho), g{1.0 / (axes_.s1 + alpha), 1.0 / (axes_.s2 + alpha)};
    const pair fixed{-g.x * e.x, -g.y * e.y},
        moving{-g.x * p.x, -g.y * p.y};  // change: fixed + moving d(alpha)
    const double cone = m_ * length(rho.x, rho.y), excess = vn / a_.nn;
    const pair k{p.x / cone + w.x, p.y / cone + w.y};
    const double change = -(excess + k.x * fixed.x + k.y * fixed.y) / (k.x * moving.x + k.y * moving.y);
    const double by = sticks || !is_finite(change) ? 0.0 : change;
    const pair dp{fixed.x + moving.x * by, fixed.y + moving.y * by}, drho = axes_.from(dp);
    const pair better{rho.x + drho.x, rho.y + drho.y};
    const double limit = length(better.x, better.y) / m_, held = r[0] - (excess + w.x * dp.x + w.y * dp.y);
    r[0] = sticks ? larger(held, limit) : limit;
    r[1] = d_.x * better.x;
    r[2] = d_.y * better.y;
  }

  contact a_;
  double m_;
  pair d_, w_;
  double n_;
  eigenvectors axes_;
};

// Devices allow no recursion, so the cases of held axes call each other in one direction.

// Finite coefficients, the first not below a negligible part of the second.
inline contact_mode solve_ordered(const contact& a, double mu1, double mu2, double* r) {
  if (mu1 < negligible) {  // an axis without friction gives no impulse
    r[0] = -a.qn / a.nn;
    r[1] = r[2] = 0.0;
    const bool moves = absolute(a.q1 + a.n1 * r[0]) + absolute(a.q2 + a.n2 * r[0]) > 0.0;
    return moves ? contact_mode::slip : contact_mode::stick;
  }
  if (mu2 < mu1 * negligible) return cone_contact(exchanged(drop_first(exchanged(a))), mu1, mu1).solve(r);
  return cone_contact(a, mu1, mu2).solve(r);
}

// With the axes exchanged.
template <class Solve>
contact_mode solve_exchanged(const contact& a, double* r, Solve solve) {
  const contact_mode mode = solve(exchanged(a), r);
  const double first = r[2];
  r[2] = r[1];
  r[1] = first;
  return mode;
}
// With the first axis held: eliminated, and its impulse recovered.
template <class Solve>
contact_mode solve_held(const contact& a, double* r, Solve solve) {
  const contact_mode mode = solve(hold_first(a), r);
  if (!(r[0] > 0.0)) return contact_mode::none;
  r[1] = -(a.q1 + a.n1 * r[0] + a.t12 * r[2]) / a.t11;
  return mode;
}

inline contact_mode solve_finite(const contact& a, double mu1, double mu2, double* r) {
  if (!(mu1 < mu2 * negligible)) return solve_ordered(a, mu1, mu2, r);
  return solve_exchanged(a, r, [=](const contact& b, double* s) { return solve_ordered(b, mu2, mu1, s); });
}
inline contact_mode solve_first_held(const contact& a, double mu2, double* r) {
  return solve_held(a, r, [=](const contact& b, double* s) { return solve_finite(b, 0.0, mu2, s); });
}
inline contact_mode solve_second_held(const contact& a, double mu1, double* r) {
  return solve_exchanged(a, r, [=](const contact& b, double* s) { return solve_first_held(b, mu1, s); });
}

// Any coefficients.
inline contact_mode solve_axes(const contact& a, double mu1, double mu2, double* r) {
  if (mu1 < infinity && mu2 < infinity) return solve_finite(a, mu1, mu2, r);
  if (mu1 < infinity) return solve_second_held(a, mu1, r);
  if (mu2 < infinity) return solve_first_held(a, mu2, r);
  return solve_held(a, r, [](const contact& b, double* s) { return solve_second_held(b, 0.0, s); });
}

}  // namespace local

// Any problem with q_N < 0. Not inlined: it is rarely needed.
[[gnu::noinline]] inline contact_mode solve_pressed(const local_coulomb& problem, double* r) {
  const double *h = problem.h, *q = problem.q;
  const auto mass = power_scale_of(larger(h[0], larger(h[1], h[2])));
  const auto speed = power_scale_of(larger(absolute(q[0]), larger(absolute(q[1]), absolute(q[2]))));
  const double a = mass.down, b = speed.down;
  const local::contact scaled{a * h[0], a * h[3], a * h[4], a * h[1], a * h[2],
                              a * h[5], b * q[0], b * q[1], b * q[2]};
  const contact_mode mode = local::solve_axes(scaled, problem.mu[0], problem.mu[1], r);
  for (int k = 0; k < 3; ++k) r[k] = mode == contact_mode::none ? 0.0 : r[k] * (0.5 * mass.down * speed.up);
  return mode;
}

// Solves the problem; r = 0 where the contact is free, or where no solution exists. Every problem with finite
// coefficients has one.
inline contact_mode solve(const local_coulomb& problem, double* r) {
  r[0] = r[1] = r[2] = 0.0;
  if (problem.q[0] >= 0.0) return contact_mode::free;
  const local::regular_answer<double> answer = solve_regular(problem);
  if (!answer.found) return solve_pressed(problem, r);
  for (int k = 0; k < 3; ++k) r[k] = answer.r[k];
  return answer.sticks ? contact_mode::stick : contact_mode::slip;
}

}  // namespace ilaw::kit
