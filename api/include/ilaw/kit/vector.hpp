// vector.hpp - vectors and H at a node. Dimensions 1 and 2 are the same equations with zero tangential
// components.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit/math.hpp>

namespace ilaw::kit::inline ILAW_KIT_LEVEL {

// In the local frame: normal, first and second tangential component.
template <class V>
struct vector {
  using number = V;
  V n = 0.0, t1 = 0.0, t2 = 0.0;

  ILAW_KIT_INLINE friend vector operator+(vector a, vector b) {
    return {a.n + b.n, a.t1 + b.t1, a.t2 + b.t2};
  }
  ILAW_KIT_INLINE friend vector operator-(vector a, vector b) {
    return {a.n - b.n, a.t1 - b.t1, a.t2 - b.t2};
  }
  ILAW_KIT_INLINE friend vector operator-(vector a) { return {-a.n, -a.t1, -a.t2}; }
  ILAW_KIT_INLINE friend vector operator*(V s, vector a) { return {s * a.n, s * a.t1, s * a.t2}; }
  ILAW_KIT_INLINE friend vector select(mask_of<V> m, vector a, vector b) {
    return {select(m, a.n, b.n), select(m, a.t1, b.t1), select(m, a.t2, b.t2)};
  }
  ILAW_KIT_INLINE friend vector zero_unless(mask_of<V> m, vector a) {
    return {zero_unless(m, a.n), zero_unless(m, a.t1), zero_unless(m, a.t2)};
  }
  ILAW_KIT_INLINE friend V normal_product(vector a, vector b) { return a.n * b.n; }
  ILAW_KIT_INLINE friend V tangential_product(vector a, vector b) { return a.t1 * b.t1 + a.t2 * b.t2; }
  ILAW_KIT_INLINE scaled_length<V> scaled_tangential_length() const { return scaled_length_of(t1, t2); }
  ILAW_KIT_INLINE V tangential_length() const { return scaled_tangential_length().length(); }
  // With this normal component, and tangential ones -factor times these. From zero: what is not rubbed gets
  // 0, not -0.
  ILAW_KIT_INLINE vector against(V normal, V factor) const {
    return {normal, 0.0 - factor * t1, 0.0 - factor * t2};
  }
  ILAW_KIT_INLINE vector tangential_part() const { return {0.0, t1, t2}; }
  ILAW_KIT_INLINE friend V sum_of_sizes(vector a) {
    return absolute(a.n) + (absolute(a.t1) + absolute(a.t2));
  }
  ILAW_KIT_INLINE friend V residual(vector a, V found) { return found * a.n * a.t1 * a.t2; }
};

// For laws that are isotropic in the tangent plane: normal part and tangential rest, the latter in the host's
// axes, so that no tangent need be chosen. A step written with the operations that it shares with vector
// works on both.
template <class V>
struct projected {
  using number = V;
  V n = 0.0, x = 0.0, y = 0.0, z = 0.0;

  ILAW_KIT_INLINE friend projected operator+(projected a, projected b) {
    return {a.n + b.n, a.x + b.x, a.y + b.y, a.z + b.z};
  }
  ILAW_KIT_INLINE friend projected operator-(projected a, projected b) {
    return {a.n - b.n, a.x - b.x, a.y - b.y, a.z - b.z};
  }
  ILAW_KIT_INLINE friend projected operator-(projected a) { return {-a.n, -a.x, -a.y, -a.z}; }
  ILAW_KIT_INLINE friend projected operator*(V s, projected a) {
    return {s * a.n, s * a.x, s * a.y, s * a.z};
  }
  ILAW_KIT_INLINE friend projected select(mask_of<V> m, projected a, projected b) {
    return {select(m, a.n, b.n), select(m, a.x, b.x), select(m, a.y, b.y), select(m, a.z, b.z)};
  }
  ILAW_KIT_INLINE friend projected zero_unless(mask_of<V> m, projected a) {
    return {zero_unless(m, a.n), zero_unless(m, a.x), zero_unless(m, a.y), zero_unless(m, a.z)};
  }
  ILAW_KIT_INLINE friend V normal_product(projected a, projected b) { return a.n * b.n; }
  ILAW_KIT_INLINE friend V tangential_product(projected a, projected b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
  }
  ILAW_KIT_INLINE scaled_length<V> scaled_tangential_length() const { return scaled_length_of(x, y, z); }
  ILAW_KIT_INLINE V tangential_length() const { return scaled_tangential_length().length(); }
  ILAW_KIT_INLINE projected against(V normal, V factor) const {
    return {normal, 0.0 - factor * x, 0.0 - factor * y, 0.0 - factor * z};
  }
  ILAW_KIT_INLINE projected tangential_part() const { return {0.0, x, y, z}; }
  ILAW_KIT_INLINE friend V sum_of_sizes(projected a) {
    return (absolute(a.n) + absolute(a.x)) + (absolute(a.y) + absolute(a.z));
  }
  ILAW_KIT_INLINE friend V residual(projected a, V found) { return found * a.n * a.x * a.y * a.z; }
};

// A vector without normal component, to be remembered: a host keeps d-1 doubles of it.
template <class V>
struct tangential_vector {
  V t1 = 0.0, t2 = 0.0;

  ILAW_KIT_INLINE operator vector<V>() const { return {0.0, t1, t2}; }
};

// A vector in the host's axes.
template <class V>
struct axis {
  V x, y, z;

  ILAW_KIT_INLINE friend V dot(axis a, axis b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
  ILAW_KIT_INLINE friend axis cross(axis a, axis b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
  }
  ILAW_KIT_INLINE friend axis select(mask_of<V> m, axis a, axis b) {
    return {select(m, a.x, b.x), select(m, a.y, b.y), select(m, a.z, b.z)};
  }
  ILAW_KIT_INLINE friend V residual(axis a, V found) { return found * a.x * a.y * a.z; }
};

// ---- symmetric positive definite matrices: H at a node, and the 2x2 block of the tangent plane

// Smallest H allowed: below it 1/H overflows.
inline constexpr double smallest_delassus = std::numeric_limits<double>::min();

// Largest tr(H) tr(H^-1) allowed, which no rotation changes: beyond it rounding decides whether H is
// definite. It lies between the condition number and nine times that.
inline constexpr double largest_condition = 0x1p43;

// H = diag(h_N, h_T, h_T). A scalar H is this with twice the same value.
template <class V>
struct transverse {
  using number = V;
  V n, t;

  ILAW_KIT_INLINE V normal() const { return n; }
  ILAW_KIT_INLINE V tangential() const { return t; }
  ILAW_KIT_INLINE V largest_tangential() const { return t; }
  ILAW_KIT_INLINE V anisotropy() const { return 0.0; }
  // tr(H) tr(H^-1) = 5 + 2 (n/t + t/n) here. A number that is not finite leaves n - t so.
  ILAW_KIT_INLINE mask_of<V> is_definite() const {
    constexpr double least_ratio = 2.0 / largest_condition;
    return least_ratio * absolute(n - t) <= smaller(n, t) - smallest_delassus;
  }
  ILAW_KIT_INLINE vector<V> times(vector<V> r) const { return {n * r.n, t * r.t1, t * r.t2}; }
  ILAW_KIT_INLINE projected<V> times(projected<V> r) const { return {n * r.n, t * r.x, t * r.y, t * r.z}; }
  // Both forms multiply by an inverse, so that their bits are the same.
  ILAW_KIT_INLINE vector<V> solve(vector<V> v) const {
    const V by_n = 1.0 / n, by_t = inverse_tangential(by_n);
    return {by_n * v.n, by_t * v.t1, by_t * v.t2};
  }
  ILAW_KIT_INLINE projected<V> solve(projected<V> v) const {
    const V by_n = 1.0 / n, by_t = inverse_tangential(by_n);
    return {by_n * v.n, by_t * v.x, by_t * v.y, by_t * v.z};
  }

 private:
  // A scalar H is divided by once.
  ILAW_KIT_INLINE V inverse_tangential(V by_n) const {
    V by_t = by_n;
    if (any(n != t)) by_t = 1.0 / t;
    return by_t;
  }
};

// The same with spins: v = v_free + H r - k q, u = u_free - k r_T + j_t q, w_N = w_free,N + j_n m_N, with
// spins and moments as nodes have them, q = m x n and u = w x n. So the tangent plane has the block [h_T, -k;
// -k, j_t].
template <class V>
struct transverse_spin : transverse<V> {
  V k, j_n, j_t;

  ILAW_KIT_INLINE mask_of<V> is_definite() const {
    constexpr double least_ratio = 2.0 / largest_condition;
    const V j = smaller(j_n, j_t), coupling = (k / this->t) * (k / j_t);
    return transverse<V>::is_definite() & (least_ratio * absolute(j_n - j_t) <= j - smallest_delassus) &
           (coupling <= 1.0 - least_ratio);
  }
  using transverse<V>::times;
  template <class Vector>
  ILAW_KIT_INLINE Vector times(Vector r, Vector q) const {
    return transverse<V>::times(r) - k * q.tangential_part();
  }
  template <class Vector>
  ILAW_KIT_INLINE Vector spin_of(Vector r, Vector q) const {
    return transverse<V>{j_n, j_t}.times(q) - k * r.tangential_part();
  }
};

// Any H. A diagonal one is this with zeros.
template <class V>
struct full {
  using number = V;
  V nn, t11, t22, n1, n2, t12;

  ILAW_KIT_INLINE V normal() const { return nn; }
  ILAW_KIT_INLINE V tangential() const { return t11; }
  // Not below the largest inverse mass in the tangent plane, with what H couples to the normal.
  ILAW_KIT_INLINE V largest_tangential() const {
    return larger(t11 + absolute(n1), t22 + absolute(n2)) + absolute(t12);
  }
  // Zero where closed forms for H = diag(h_N, h_T, h_T) hold.
  ILAW_KIT_INLINE V anisotropy() const {
    return absolute(t11 - t22) + absolute(n1) + absolute(n2) + absolute(t12);
  }

  // LDL^T: pivots, the inverse of two, which are divided by once, and multipliers. H is positive definite
  // exactly when the pivots are positive.
  struct factors {
    V d0, d1, d2, by_d0, by_d1, l10, l20, l21;

    ILAW_KIT_INLINE vector<V> solve(vector<V> v) const {
      const V y1 = v.t1 - l10 * v.n;
      const V y2 = (v.t2 - l20 * v.n) - l21 * y1;
      const V x2 = 1.0 / d2 * y2;
      const V x1 = y1 * by_d1 - l21 * x2;
      return {(v.n * by_d0 - l10 * x1) - l20 * x2, x1, x2};
    }

    // Without a division: tr(H^-1) is the sum of these products over that of the pivots.
    ILAW_KIT_INLINE mask_of<V> is_fair(V trace) const {
      const V scale = power_scale_of(trace).down, l = l10 * l21 - l20;
      const V a = scale * d0, b = scale * d1, c = scale * d2;
      const V products = b * c + (1.0 + l10 * l10) * (a * c) + (1.0 + l21 * l21 + l * l) * (a * b);
      return scale * trace * products <= largest_condition * (a * b * c);
    }
  };
  ILAW_KIT_INLINE factors factorise() const {
    const V by_d0 = 1.0 / nn, l10 = n1 * by_d0, l20 = n2 * by_d0;
    const V d1 = t11 - l10 * n1, by_d1 = 1.0 / d1;
    const V rest = t12 - l20 * n1, l21 = rest * by_d1;
    return {nn, d1, (t22 - l20 * n2) - l21 * rest, by_d0, by_d1, l10, l20, l21};
  }
  // A number that is not finite leaves none to compare, or a trace of inf.
  ILAW_KIT_INLINE mask_of<V> is_definite() const {
    const factors f = factorise();
    return (smaller(smaller(f.d0, f.d1), f.d2) >= smallest_delassus) & f.is_fair(nn + t11 + t22);
  }
  ILAW_KIT_INLINE vector<V> times(vector<V> r) const {
    return {nn * r.n + n1 * r.t1 + n2 * r.t2, n1 * r.n + t11 * r.t1 + t12 * r.t2,
            n2 * r.n + t12 * r.t1 + t22 * r.t2};
  }
  // The same in the host's axes, where rows have no normal or tangential meaning yet.
  ILAW_KIT_INLINE axis<V> row_times(axis<V> a) const {
    return {nn * a.x + n1 * a.y + n2 * a.z, n1 * a.x + t11 * a.y + t12 * a.z,
            n2 * a.x + t12 * a.y + t22 * a.z};
  }
  ILAW_KIT_INLINE vector<V> solve(vector<V> v) const { return factorise().solve(v); }
};

// Largest | |n|^2 - 1 |, | |t|^2 - 1 | and | n.t | accepted: axes that went through single precision pass.
inline constexpr double unit_tolerance = 1e-6;

// Whether closed forms for H = diag(h_N, h_T, h_T) do not hold, beyond the error of the axes. To first order
// in e = unit_tolerance, H = h_T 1 + d m m' with d = h_N - h_T and |m x n| <= e has |n.H t_1| <= e (h_T + 2
// |d|), |n.H t_2| <= e |d|, |t_1.H t_1 - t_2.H t_2| <= e h_T and t_1.H t_2 = 0 along axes within e, with t_2
// = n x t_1: in all at most 5 e (h_N + h_T). H in single precision adds 5 * 2^-24 |H|, below e (h_N + h_T)/2.
// Below it the axes change the impulse as much as the neglected entries do.
template <class Delassus>
ILAW_KIT_INLINE auto is_anisotropic(const Delassus& h) {
  constexpr double tolerance = 6.0 * unit_tolerance;
  return h.anisotropy() > tolerance * (h.normal() + h.tangential());
}

template <class Delassus>
inline constexpr bool is_transverse_form = false;
template <class V>
inline constexpr bool is_transverse_form<transverse<V>> = true;
template <class V>
inline constexpr bool is_transverse_form<transverse_spin<V>> = true;
template <class Delassus>
inline constexpr bool has_spin_form = false;
template <class V>
inline constexpr bool has_spin_form<transverse_spin<V>> = true;

// A number that is zero for sure: products with it are not computed, which changes no bit but the sign of a
// zero.
struct sure_zero {
  ILAW_KIT_INLINE friend sure_zero operator*(sure_zero, sure_zero) { return {}; }
  template <class V>
  ILAW_KIT_INLINE friend sure_zero operator*(V /*x*/, sure_zero) {
    return {};
  }
  template <class V>
  ILAW_KIT_INLINE friend sure_zero operator*(sure_zero, V /*x*/) {
    return {};
  }
  template <class V>
  ILAW_KIT_INLINE friend V operator+(V x, sure_zero) {
    return x;
  }
  template <class V>
  ILAW_KIT_INLINE friend V operator-(V x, sure_zero) {
    return x;
  }
};

// A 2x2 matrix, and the products with its adjugate, so that a solve is one division. Coupling: V or
// sure_zero.
template <class V, class Coupling>
struct symmetric_2x2 {
  V a11, a22;
  Coupling a12;

  ILAW_KIT_INLINE symmetric_2x2 shifted(V alpha) const { return {a11 + alpha, a22 + alpha, a12}; }
  ILAW_KIT_INLINE V determinant() const { return a11 * a22 - a12 * a12; }
  ILAW_KIT_INLINE V trace() const { return a11 + a22; }
  ILAW_KIT_INLINE V adjugate_1(V x, V y) const { return a22 * x - a12 * y; }
  ILAW_KIT_INLINE V adjugate_2(V x, V y) const { return a11 * y - a12 * x; }
  ILAW_KIT_INLINE V row_1(V x, V y) const { return a11 * x + a12 * y; }
  ILAW_KIT_INLINE V row_2(V x, V y) const { return a22 * y + a12 * x; }
};

}  // namespace ilaw::kit
