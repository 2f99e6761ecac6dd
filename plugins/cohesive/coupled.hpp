// coupled.hpp - a bonded node with any H that is fairly conditioned, or a pack of them; not where friction
// acts.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "pack_step.hpp"

namespace cohesive_law {
inline namespace ILAW_KIT_LEVEL {

// Products with a symmetric matrix, whose entries are in the order of H's.
template <class V>
void multiply(const V (&m)[6], const V (&x)[3], V (&product)[3]) {
  product[0] = m[0] * x[0] + (m[3] * x[1] + m[4] * x[2]);
  product[1] = m[1] * x[1] + (m[3] * x[0] + m[5] * x[2]);
  product[2] = m[2] * x[2] + (m[4] * x[0] + m[5] * x[1]);
}

// M = (I + kappa A)^-1 as adjugate and 1/determinant; contact: impulse of contact, as the motion D it makes.
template <class V>
struct coupled_response {
  V adjugate[6], inverse, contact;
  mask_of<V> rubbed = mask_of<V>(false);
};

// With A = W^1/2 H W^1/2/h_N and weighted vectors, in which w^+ + w^- = M (D + contact A e_N).
template <class V>
class coupled_step : public pack_step<V, coupled_step<V>, coupled_response<V>> {
  using base = pack_step<V, coupled_step<V>, coupled_response<V>>;
  friend base;
  using typename base::balanced;
  using typename base::Mask;
  using typename base::trial;

 public:
  coupled_step(const bond& b, const of_all_nodes& all, const gathered<V>& g) : base(b, all, g) {
    const V *h = g.h, w = all.weight / h[0], ww = all.weight * w;
    const V a[] = {1.0, ww * h[1], ww * h[2], w * h[3], w * h[4], ww * h[5]};
    const V k[] = {a[1] * a[2] - a[5] * a[5], a[2] - a[4] * a[4],        a[1] - a[3] * a[3],
                   a[4] * a[5] - a[3] * a[2], a[3] * a[5] - a[4] * a[1], a[3] * a[4] - a[5]};
    for (int i = 0; i < 6; ++i) {
      a_[i] = a[i];
      adjugate_[i] = k[i];
    }
    trace_ = 1.0 + (a[1] + a[2]);
    minors_ = k[0] + (k[1] + k[2]);
    determinant_ = k[0] + (a[3] * k[3] + a[4] * k[4]);
    weigh(this->drive_, heavy_);
  }

 private:
  static constexpr double least_determinant = 0x1p-16;

  V trace_ratio() const { return trace_; }
  // Whether rounding is not amplified much, no product overflows, and no trial was one of friction.
  Mask is_whole(const trial& m, V most) const {
    constexpr double scale = 0x1p100;
    const V least = smaller(a_[1], a_[2]);
    return (determinant_ > least_determinant * (a_[1] * a_[2])) & (least > 1.0 / scale) & (trace_ < scale) &
           (most * trace_ < scale) & !m.rubbed;
  }

  void weigh(const V (&x)[3], V (&weighted)[3]) const {
    weighted[0] = x[0];
    weighted[1] = this->all_.weight * x[1];
    weighted[2] = this->all_.weight * x[2];
  }

  [[gnu::always_inline]] void work_out(balanced& x) const {
    const V k = x.kappa, kk = k * k;
    const V *a = a_, *minor = adjugate_;
    trial& m = x.motion;
    m.adjugate[0] = 1.0 + (k * (a[1] + a[2]) + kk * minor[0]);
    m.adjugate[1] = 1.0 + (k * (1.0 + a[2]) + kk * minor[1]);
    m.adjugate[2] = 1.0 + (k * (1.0 + a[1]) + kk * minor[2]);
    for (int i = 3; i < 6; ++i) m.adjugate[i] = kk * minor[i] - k * a[i];
    m.inverse = 1.0 / (1.0 + (k * trace_ + (kk * minors_ + kk * k * determinant_)));
    V sum[3];
    multiply(m.adjugate, heavy_, sum);
    for (V& each : sum) each = m.inverse * each;
    const V* w = this->g_.opening;
    m.closed = sum[0] - w[0] < this->below_;
    m.contact = 0.0;
    if (any(m.closed)) close(m, sum);
    m.opening[0] = select(m.closed, this->floor_, sum[0] - w[0]);
    const double per_weight = 1.0 / this->all_.weight;
    for (int i = 1; i < 3; ++i) m.opening[i] = per_weight * sum[i] - w[i];
    m.shear = this->shear_square(m.opening[1], m.opening[2]);
    m.size = this->size_of(m.opening[0], m.shear);
  }
  // Contact takes the node to the ground.
  void close(trial& m, V (&sum)[3]) const {
    const V column[] = {1.0, a_[3], a_[4]};
    V moved[3];
    multiply(m.adjugate, column, moved);
    const V up = positive_part(this->floor_ + this->g_.opening[0] - sum[0]) / moved[0];
    for (int i = 0; i < 3; ++i) sum[i] = select(m.closed, sum[i] + up * moved[i], sum[i]);
    m.contact = select(m.closed, up / m.inverse, 0.0);
    if (this->bond_.friction > 0.0) m.rubbed = m.rubbed | (m.closed & (this->g_.damage > 0.0));
  }

  // -y y' = -w^+.W dw^+/dkappa, where nothing touches.
  V along(const trial& m) const {
    V after[3], before[3], sum[3], pushed[3], moved[3];
    weigh(m.opening, after);
    weigh(this->g_.opening, before);
    for (int i = 0; i < 3; ++i) sum[i] = after[i] + before[i];
    multiply(a_, sum, pushed);
    multiply(m.adjugate, pushed, moved);
    return m.inverse * (after[0] * moved[0] + (after[1] * moved[1] + after[2] * moved[2]));
  }
  Mask has_slope(const trial& m) const { return this->has_short_slope() ? !m.closed : Mask(false); }

  // Of bond and contact together: the bond takes up what M leaves not of the contact's.
  void press(V kappa, const trial& m, V (&impulse)[3]) const {
    const V load[] = {m.contact - kappa * heavy_[0], -(kappa * heavy_[1]), -(kappa * heavy_[2])};
    const V scale = 2.0 * m.inverse / (this->g_.velocity_step * this->g_.h[0]);
    V taken[3], weighted[3];
    multiply(m.adjugate, load, taken);
    weigh(taken, weighted);
    for (int i = 0; i < 3; ++i) impulse[i] = scale * weighted[i];
  }

  V a_[6], adjugate_[6];            // A, and its adjugate
  V trace_, minors_, determinant_;  // invariants of A
  V heavy_[3];                      // the drive, weighted
};

}  // namespace ILAW_KIT_LEVEL
}  // namespace cohesive_law
