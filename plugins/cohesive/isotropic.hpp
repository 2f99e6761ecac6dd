// isotropic.hpp - one bonded node whose H is diag(h_N, h_T, h_T), or a pack of them: a bond that softens or
// is elastic, with contact and friction. The equations are those of zone.hpp, with kappa = c k for
// unknown.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "bond.hpp"
#include "gathered.hpp"
#include "touching.hpp"

namespace cohesive_law {
inline namespace ILAW_KIT_LEVEL {

// What is the same at all nodes of a bond.
struct of_all_nodes {
  double weight, steepest;
  softening<double> opened;      // mode I
  double flexibility, softness;  // see secant_of

  explicit of_all_nodes(const bond& b)
      : weight(b.weight()),
        steepest(b.steepest()),
        opened(b.softening_at(mode_1)),
        flexibility(b.flexibility()),
        softness(b.strength < infinity ? b.softness_scale() : 0.0) {}
};

template <class V>
class isotropic_step {
 public:
  using Mask = mask_of<V>;

  isotropic_step(const bond& b, const of_all_nodes& all, const gathered<V>& g) : bond_(b), all_(all), g_(g) {
    const V *v = g.v_free, *u = g.v_previous, *w = g.opening, step = g.position_step;
    place_bond();
    const V rounding = 0x1p-48 * (absolute(v[0]) + absolute(u[0])), lowest = smaller(x_[0], 0.0);
    const auto leaves = step * (u[0] - rounding) > x_[0] - lowest;  // see ground_below
    ground_ = select(leaves, x_[0] - step * u[0], lowest);
    floor_ = 0.5 * (x_[0] + ground_);
    for (int k = 0; k < 3; ++k) drive_[k] = 0.5 * step * v[k] + (x_[k] + w[k]);
    from_ = size_of(w[0], shear_square(w[1], w[2]));
    c_ = 0.25 * step * g.velocity_step * g.area * g.h[0];
    ratio_ = square_of_weight() * g.h[1] / g.h[0];
    now_ = secant_of(g.damage);
    const softening<double>& s = all.opened;
    opened_ = {s.strength, s.onset, s.width, s.exponential};
    opened_met_ = opened_.meets(now_);
  }

  // Says which of these lanes it leaves: those that may have several solutions, and extreme scales.
  Mask solve(Mask where, solved<V>& a) const {
    const Mask is_soft = now_.soft > 0.0;
    const V most = select(is_soft, c_ * now_.stiff / now_.soft, 1.0 / almost_nothing);
    Mask holds = where & is_soft;
    if (bond_.strength < infinity && any(holds)) holds = holds & is_below(at(most));
    const Mask is_unique = c_ * (1.0 + 2.0 * ratio_) * all_.steepest <= 1.0;
    const Mask has_scale = (most < 2.0 / almost_nothing) & (c_ > 0x1p-900);
    const Mask softens = where & has_scale & is_unique & !holds;
    V kappa = most;
    if (any(softens)) kappa = select(softens, root(most, softens), most);
    const trial found = at(kappa);
    const softening<V> s = softening_of(found);
    const V rest = excess(kappa, found, s), sum = found.size + from_;
    const Mask is_found =
        (absolute(rest) <= 0x1p-45 * (kappa + c_ * all_.steepest) * sum) & (sum > 0x1p-400) & (sum < 0x1p400);
    leave(kappa, found, damage_after(found, s, holds), a);
    return where & !(has_scale & (holds | (softens & is_found)));
  }

 private:
  // What kappa makes of the node.
  struct trial {
    V left_n, left_t;  // parts of the motion that are left
    Mask closed;
    V opening[3], rub[2], shear, size;  // rub: tangential impulse of friction on the node that the bond holds
  };
  [[gnu::always_inline]] trial at(V kappa) const {
    const V *w = g_.opening, of_n = 1.0 + kappa, of_t = 1.0 + ratio_ * kappa, both = 1.0 / (of_n * of_t);
    const V left_n = both * of_t, left_t = both * of_n;
    const V free = left_n * drive_[0] - w[0];
    const Mask closed = free < floor_;
    trial m{left_n,     left_t,
            closed,     {select(closed, floor_, free), left_t * drive_[1] - w[1], left_t * drive_[2] - w[2]},
            {0.0, 0.0}, 0.0,
            0.0};
    if (bond_.friction > 0.0 && any(closed & (g_.damage > 0.0))) rub_closed(m, free);
    m.shear = shear_square(m.opening[1], m.opening[2]);
    m.size = size_of(m.opening[0], m.shear);
    return m;
  }
  // See close in zone.hpp.
  [[gnu::noinline]] void rub_closed(trial& m, V free) const {
    const V rate = 1.0 / g_.position_step, target = (ground_ - x_[0]) * rate;
    const V h_t = m.left_t * g_.h[1], normal = (ground_ + x_[0] - 2.0 * free) * rate / (m.left_n * g_.h[0]);
    const V *y = m.opening, *u = g_.v_previous, rest[] = {smaller(u[0] + target, 0.0), u[1], u[2]};
    const V q[] = {0.0, 2.0 * rate * (y[1] - x_[1]), 2.0 * rate * (y[2] - x_[2])};
    const rubbing_factor<V> found = rub_from(h_t, normal, q, rest, bond_.friction * g_.damage);
    const Mask rubs = m.closed & (g_.damage > 0.0);
    const V way = 0.5 * g_.position_step * h_t;
    for (int k = 1; k < 3; ++k) {
      m.rub[k - 1] = select(rubs, 0.0 - found.factor * q[k], 0.0);
      const V rubbed = select(found.moves, m.opening[k] + way * m.rub[k - 1], x_[k]);
      m.opening[k] = select(rubs, rubbed, m.opening[k]);
    }
  }
  double square_of_weight() const { return all_.weight * all_.weight; }
  secant<V> secant_of(V damage) const { return {1.0 - damage, all_.flexibility + damage * all_.softness}; }
  V shear_square(V t1, V t2) const { return square_of_weight() * (t1 * t1 + t2 * t2); }
  static V size_of(V n, V shear) { return square_root(n * n + shear); }

  softening<V> softening_of(const trial& m) const {
    if (!bond_.mixes()) return opened_;
    const V n = m.opening[0], square = m.size * m.size;
    return bond_.softening_at(mix_of(n * n, m.shear, square));
  }
  V excess(V kappa, const trial& m, const softening<V>& s) const {
    const V met = bond_.mixes() ? s.meets(now_) : opened_met_;
    return kappa * (m.size + from_) - 2.0 * c_ * s.mean_traction_on_path(now_, met, from_, m.size);
  }
  V excess(V kappa, const trial& m) const { return excess(kappa, m, softening_of(m)); }

  Mask is_below(const trial& m) const {
    if (!bond_.mixes()) return m.size <= opened_met_;
    const V pull = now_.stiff * m.size;
    const double least = smaller(bond_.strength, bond_.shear_strength());
    return ((now_.stiff == 1.0) & (pull <= now_.soft * least)) |
           (pull <= now_.soft * softening_of(m).traction(m.size));
  }

  // Secants of (1 + kappa) excess, which is linear where a bilinear bond opens in one direction, inside the
  // bracket; elsewhere the fixed point kappa = 2 c T/|w^+ + w^-|, which comes closer from below.
  V root(V most, Mask active) const {
    constexpr int most_steps = 24;
    constexpr double close = 0x1p-54;  // of the product of two errors, which the next error is at most
    const trial free = at(0.0);
    V low = 0.0, high = most, before = 0.0, excess_before = excess(0.0, free);
    const V sum = free.size + from_;
    // Exact for the same bond, opened in one direction.
    const V slope = sum * (1.0 - c_ * all_.steepest) + excess_before;
    V kappa = smaller(-excess_before / select(slope > 0.0, slope, sum), most);
    for (int k = 0; k < most_steps && any(active); ++k) {
      const trial m = at(kappa);
      const V e = excess(kappa, m), scaled = (1.0 + kappa) * e;
      low = select(e < 0.0, kappa, low);
      high = select(e < 0.0, high, kappa);
      const V along = kappa - scaled * (kappa - before) / (scaled - excess_before);
      const Mask inside = (along > low) & (along < high);
      V next = along;
      if (any(active & !inside)) {
        const V nearer = smaller(larger(kappa - e / (m.size + from_), low), high);
        next = select(inside, along, nearer);
      }
      const Mask moves = absolute(next - kappa) * absolute(kappa - before) > close * (kappa * kappa);
      before = select(active, kappa, before);
      excess_before = select(active, scaled, excess_before);
      kappa = select(active, next, kappa);
      active = active & moves;
    }
    return kappa;
  }

  V damage_after(const trial& m, const softening<V>& s, Mask holds) const {
    const V traction = s.traction(m.size);
    const V reached = (m.size - all_.flexibility * traction) / (m.size + all_.softness * traction);
    return select(holds | !(m.size > s.onset), g_.damage, larger(g_.damage, reached));
  }

  // Where the bond is, see start in cohesive.cpp.
  void place_bond() {
    const V *p = g_.position, *w = g_.opening, *v = g_.v_free, *u = g_.v_previous;
    V moved = 0.0;
    for (int k = 0; k < 3; ++k) moved = moved + (absolute(p[k]) + absolute(w[k]));
    const Mask is_new = moved == 0.0;
    const V half = 0.5 * g_.position_step;
    const V normal = select(is_new & (v[0] * u[0] < 0.0), half, 0.0);
    const V tangential = select(is_new & (v[1] * u[1] + v[2] * u[2] < 0.0), half, 0.0);
    x_[0] = p[0] + normal * u[0];
    x_[1] = p[1] + tangential * u[1];
    x_[2] = p[2] + tangential * u[2];
  }

  // The impulse of bond and contact together: contact takes a closed node to the ground, whatever the bond
  // does.
  void leave(V kappa, const trial& m, V damage, solved<V>& a) const {
    const V rate_of_step = 1.0 / g_.position_step, taken = 2.0 * kappa * rate_of_step;
    const V taken_t = taken * ratio_ * m.left_t / g_.h[1];
    const V closing = g_.v_free[0] + (x_[0] - ground_) * rate_of_step;
    a.impulse[0] = -(select(m.closed, closing, taken * m.left_n * drive_[0]) / g_.h[0]);
    a.impulse[1] = m.left_t * m.rub[0] - taken_t * drive_[1];
    a.impulse[2] = m.left_t * m.rub[1] - taken_t * drive_[2];
    const V *y = m.opening, *w = g_.opening;
    const V rate = 0.5 * g_.area * (kappa / c_);
    a.normal_gain = rate * (y[0] + w[0]) * (y[0] - w[0]);
    a.tangential_gain =
        rate * square_of_weight() * ((y[1] + w[1]) * (y[1] - w[1]) + (y[2] + w[2]) * (y[2] - w[2]));
    const V stored_before = g_.area * bond_.energy_of(now_, from_);
    a.stored = g_.area * bond_.energy_of(secant_of(damage), m.size);
    a.rupture = positive_part(a.normal_gain + a.tangential_gain - (a.stored - stored_before));
    a.status = select(damage < 1.0, V(status::bonded), V(status::broken));
    a.refused = not_refused;
    a.damage = damage;
    for (int k = 0; k < 3; ++k) {
      a.position[k] = 2.0 * y[k] - x_[k];
      a.opening[k] = y[k];
    }
  }

  const bond& bond_;
  const of_all_nodes& all_;
  const gathered<V>& g_;
  V x_[3], drive_[3];   // position at the time of the impulse; w^+ + w^- without bond and contact
  V ground_, floor_;    // lowest next position, and lowest opening
  V from_, c_, ratio_;  // |w^-|
  secant<V> now_;
  softening<V> opened_;
  V opened_met_;
};

}  // namespace ILAW_KIT_LEVEL
}  // namespace cohesive_law
