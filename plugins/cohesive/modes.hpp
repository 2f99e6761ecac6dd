// modes.hpp - the directions in which H and a bond decouple, so that one number says what a bond takes of the
// free motion in all of them. See cohesive.md.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit.hpp>

namespace cohesive_law {
inline namespace ILAW_KIT_LEVEL {

using namespace ilaw::kit;

// Parts of the free motion; their sum is 1. Both are kept, since either may be tiny.
struct share {
  double taken, left;  // rigid: 1 and 0, broken: 0 and 1

  double stiffness() const { return taken / left; }  // c k

  // The same bond as a direction feels it that is so many times as easily moved.
  share times(double ratio) const {
    const double sum = left + ratio * taken;
    return {ratio * taken / sum, left / sum};
  }
};

// H = diag(h_N, h_T, h_T): the axes themselves.
struct isotropic_modes {
  static constexpr bool along_axes = true;
  double normal, tangential, ratio;  // ratio: of tangential to normal compliance, as the bond feels them

  template <class Delassus>
  isotropic_modes(const Delassus& h, double weight)
      : normal(h.normal()), tangential(h.tangential()), ratio(weight * weight * tangential / normal) {}

  double trace_ratio() const { return 1.0 + 2.0 * ratio; }
  double largest_ratio() const { return larger(1.0, ratio); }

  // (I + c k H W)^-1 d
  vector left(share s, vector d) const {
    const double t = s.times(ratio).left;
    return {s.left * d.n, t * d.t1, t * d.t2};
  }
  // (H^-1 + c k W)^-1: what an impulse does to a node that is bonded.
  diagonal_delassus delassus(share s) const {
    const double t = s.times(ratio).left * tangential;
    return {s.left * normal, t, t};
  }
  // The bond's impulse and that of the contact it acts beside, together.
  vector impulse(share s, vector drive, vector contact) const {
    const share t = s.times(ratio);
    const double of_n = 2.0 * s.taken / normal, of_t = 2.0 * t.taken / tangential;
    return {s.left * contact.n - of_n * drive.n, t.left * contact.t1 - of_t * drive.t1,
            t.left * contact.t2 - of_t * drive.t2};
  }
};

inline double product(vector a, vector b) { return normal_product(a, b) + tangential_product(a, b); }

// Any H: the eigenvectors of W^1/2 H W^1/2, W = diag(1, weight^2, weight^2), by Jacobi's rotations, which
// keep the digits of small eigenvalues of scaled matrices (Demmel and Veselic 1992).
struct coupled_modes {
  static constexpr bool along_axes = false;
  double normal;
  double weight;
  vector axis[3];
  double value[3], ratio[3];

  template <class Delassus>
  coupled_modes(const Delassus& given, double w) : normal(given.normal()), weight(w) {
    local_coulomb h{};
    fill(h, given);
    const double scale = power_scale_of(larger(h.h[0], larger(h.h[1], h.h[2]))).down;
    double a[3][3] = {{scale * h.h[0], scale * w * h.h[3], scale * w * h.h[4]},
                      {0.0, scale * w * w * h.h[1], scale * w * w * h.h[5]},
                      {0.0, 0.0, scale * w * w * h.h[2]}};
    axis[0].n = axis[1].t1 = axis[2].t2 = 1.0;
    for (int sweep = 0; sweep < sweeps; ++sweep) {
      const bool first = rotate(a, 0, 1), second = rotate(a, 0, 2), third = rotate(a, 1, 2);
      if (!(first || second || third)) break;
    }
    for (int i = 0; i < 3; ++i) {
      value[i] = larger(a[i][i], local::definite * a[0][0]) / scale;
      ratio[i] = value[i] / normal;
    }
  }

  double trace_ratio() const { return ratio[0] + ratio[1] + ratio[2]; }
  double largest_ratio() const { return larger(ratio[0], larger(ratio[1], ratio[2])); }

  vector left(share s, vector d) const {
    const vector heavy = weighted(d, weight);
    vector sum;
    for (int i = 0; i < 3; ++i) sum = sum + (s.times(ratio[i]).left * product(axis[i], heavy)) * axis[i];
    return weighted(sum, 1.0 / weight);
  }
  full_delassus delassus(share s) const {
    full_delassus h{};
    for (int i = 0; i < 3; ++i) {
      const vector a = weighted(axis[i], 1.0 / weight);
      const double l = s.times(ratio[i]).left * value[i];
      h.nn += l * a.n * a.n;
      h.t11 += l * a.t1 * a.t1;
      h.t22 += l * a.t2 * a.t2;
      h.n1 += l * a.n * a.t1;
      h.n2 += l * a.n * a.t2;
      h.t12 += l * a.t1 * a.t2;
    }
    return h;
  }
  vector impulse(share s, vector drive, vector contact) const {
    const vector heavy = weighted(drive, weight), light = weighted(contact, 1.0 / weight);
    vector sum;
    for (int i = 0; i < 3; ++i) {
      const share part = s.times(ratio[i]);
      const double bond = 2.0 * part.taken / value[i] * product(axis[i], heavy);
      sum = sum + (part.left * product(axis[i], light) - bond) * axis[i];
    }
    return weighted(sum, weight);
  }

 private:
  static constexpr int sweeps = 12;  // five do; the rest is for what nobody has met

  static vector weighted(vector a, double w) { return {a.n, w * a.t1, w * a.t2}; }

  // Takes a_pq away, p < q; says whether there was anything. Only the upper part of the matrix is kept.
  bool rotate(double (&a)[3][3], int p, int q) {
    const double off = a[p][q];
    if (off * off <= 0x1p-106 * (a[p][p] * a[q][q])) return false;
    const double zeta = (a[q][q] - a[p][p]) / (2.0 * off);
    const double t = (zeta >= 0.0 ? 1.0 : -1.0) / (absolute(zeta) + square_root(1.0 + zeta * zeta));
    const double c = 1.0 / square_root(1.0 + t * t), s = t * c;
    a[p][p] -= t * off;
    a[q][q] += t * off;
    a[p][q] = 0.0;
    const int k = 3 - p - q;
    double &x = k < p ? a[k][p] : a[p][k], &y = k < q ? a[k][q] : a[q][k];
    const double before = x;
    x = c * before - s * y;
    y = s * before + c * y;
    const vector first = axis[p];
    axis[p] = c * first - s * axis[q];
    axis[q] = s * first + c * axis[q];
    return true;
  }
};

}  // namespace ILAW_KIT_LEVEL
}  // namespace cohesive_law
