// isotropic.hpp - a bonded node whose H is diag(h_N, h_T, h_T), or a pack of them, with contact and friction.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "pack_step.hpp"
#include "touching.hpp"

namespace cohesive_law {
inline namespace ILAW_KIT_LEVEL {

// Parts of the motion that are left, and the tangential impulse of friction on the node that the bond holds.
template <class V>
struct isotropic_response {
  V left_n, left_t, rub[2];
};

template <class V>
class isotropic_step : public pack_step<V, isotropic_step<V>, isotropic_response<V>> {
  using base = pack_step<V, isotropic_step<V>, isotropic_response<V>>;
  friend base;
  using typename base::balanced;
  using typename base::Mask;
  using typename base::trial;

 public:
  isotropic_step(const bond& b, const of_all_nodes& all, const gathered<V>& g)
      : base(b, all, g), ratio_(this->square_of_weight() * g.h[1] / g.h[0]) {}

 private:
  V trace_ratio() const { return 1.0 + 2.0 * ratio_; }
  static Mask is_whole(const trial& /*motion*/, V /*most*/) { return Mask(true); }

  [[gnu::always_inline]] void work_out(balanced& x) const {
    const V *w = this->g_.opening, *d = this->drive_, of_n = 1.0 + x.kappa, of_t = 1.0 + ratio_ * x.kappa;
    const V both = 1.0 / (of_n * of_t);
    trial& m = x.motion;
    m.left_n = both * of_t;
    m.left_t = both * of_n;
    const V free = m.left_n * d[0] - w[0];
    m.closed = free < this->below_;
    m.opening[0] = select(m.closed, this->floor_, free);
    for (int k = 1; k < 3; ++k) m.opening[k] = m.left_t * d[k] - w[k];
    m.rub[0] = m.rub[1] = 0.0;
    if (this->bond_.friction > 0.0 && any(m.closed & (this->g_.damage > 0.0))) rub_closed(m, free);
    m.shear = this->shear_square(m.opening[1], m.opening[2]);
    m.size = this->size_of(m.opening[0], m.shear);
  }
  // See close in zone.hpp.
  [[gnu::noinline]] void rub_closed(trial& m, V free) const {
    const V rate = 1.0 / this->g_.velocity_step, target = (this->ground_ - this->x_[0]) * rate;
    const V h_t = m.left_t * this->g_.h[1],
            normal = (this->ground_ + this->x_[0] - 2.0 * free) * rate / (m.left_n * this->g_.h[0]);
    const V *y = m.opening, *u = this->g_.v_previous, rest[] = {smaller(u[0] + target, 0.0), u[1], u[2]};
    const V q[] = {0.0, 2.0 * rate * (y[1] - this->x_[1]), 2.0 * rate * (y[2] - this->x_[2])};
    const rubbing_factor<V> found = rub_from(h_t, normal, q, rest, this->bond_.friction * this->g_.damage);
    const Mask rubs = m.closed & (this->g_.damage > 0.0);
    const V way = 0.5 * this->g_.velocity_step * h_t;
    for (int k = 1; k < 3; ++k) {
      m.rub[k - 1] = select(rubs, 0.0 - found.factor * q[k], 0.0);
      const V rubbed = select(found.moves, m.opening[k] + way * m.rub[k - 1], this->x_[k]);
      m.opening[k] = select(rubs, rubbed, m.opening[k]);
    }
  }

  // -y y' = -w^+.W dw^+/dkappa.
  V along(const trial& m) const {
    const V *y = m.opening, *d = this->drive_;
    const V along_n = select(m.closed, 0.0, m.left_n * m.left_n * (d[0] * y[0]));
    return along_n + ratio_ * this->square_of_weight() * m.left_t * m.left_t * (d[1] * y[1] + d[2] * y[2]);
  }
  Mask has_slope(const trial& m) const {
    if (!this->has_short_slope()) return Mask(false);
    return this->bond_.friction > 0.0 ? !(m.closed & (this->g_.damage > 0.0)) : Mask(true);
  }

  // The impulse of bond and contact together: contact takes a closed node to the ground, whatever the bond
  // does.
  void press(V kappa, const trial& m, V (&impulse)[3]) const {
    const V *h = this->g_.h, *d = this->drive_;
    const V rate_of_step = 1.0 / this->g_.velocity_step, taken = 2.0 * kappa * rate_of_step;
    const V taken_t = taken * ratio_ * m.left_t / h[1];
    const V closing = this->g_.v_free[0] + (this->x_[0] - this->ground_) * rate_of_step;
    impulse[0] = -(select(m.closed, closing, taken * m.left_n * d[0]) / h[0]);
    impulse[1] = m.left_t * m.rub[0] - taken_t * d[1];
    impulse[2] = m.left_t * m.rub[1] - taken_t * d[2];
  }

  V ratio_;
};

}  // namespace ILAW_KIT_LEVEL
}  // namespace cohesive_law
