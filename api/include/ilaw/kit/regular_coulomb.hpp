// regular_coulomb.hpp - the local Coulomb problem where it is well behaved, for a double or a pack of them:
// weak coupling (one solution), fair condition, no extreme coefficient. Its answer is checked in the rows of
// the problem itself; what fails is left to the solver of exact_coulomb.hpp, which is exact for any problem.
// The equations are derived in docs/theory/local_coulomb.md.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit/symmetric.hpp>

namespace ilaw::kit::inline ILAW_KIT_LEVEL {

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

}  // namespace ilaw::kit
