// pack_step.hpp - one bonded node in one step, or a pack of them: a bond that softens or is elastic. The
// equations are those of zone.hpp, with kappa = c k for unknown. What H makes of a trial is said by
// isotropic.hpp and coupled.hpp, which derive from this.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "bond.hpp"
#include "gathered.hpp"

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

// Step: what derives from this. Response: what it keeps of a trial.
template <class V, class Step, class Response>
class pack_step {
 public:
  using Mask = mask_of<V>;

  pack_step(const bond& b, const of_all_nodes& all, const gathered<V>& g)
      : bond_(b), all_(all), g_(g), is_new_(is_made_now(g)) {
    const V *v = g.v_free, *w = g.opening, step = g.velocity_step;
    place_bond(g, is_new_, x_, ground_);
    floor_ = 0.5 * (x_[0] + ground_);
    below_ = 0.5 * (x_[0] + below(x_[0], ground_));
    for (int k = 0; k < 3; ++k) drive_[k] = 0.5 * step * v[k] + (x_[k] + w[k]);
    from_ = size_of(w[0], shear_square(w[1], w[2]));
    c_ = 0.25 * step * g.velocity_step * g.area * g.h[0];
    now_ = secant_of(g.damage);
    stiffness_ = now_.stiffness();
    const softening<double>& s = all.opened;
    opened_ = {s.strength, s.onset, s.width, s.exponential};
    opened_met_ = opened_.meets(now_);
  }

  // Says which of these lanes it leaves: those that may have several solutions, and extreme scales. Flat: a
  // pack that is passed to a function goes through memory.
  [[gnu::flatten]] Mask solve(Mask where, solved<V>& a) const {
    const Mask is_soft = now_.soft > 0.0;
    const V most = select(is_soft, c_ * now_.stiff / now_.soft, 1.0 / almost_nothing);
    const V first = select(is_soft, most, 0.0);
    balanced found(first);
    self().work_out(found);
    Mask holds = where & is_soft;
    if (bond_.strength < infinity && any(holds)) holds = holds & is_below(found.motion);
    const Mask is_unique = c_ * self().trace_ratio() * all_.steepest <= 1.0;
    const Mask has_scale = (most < 2.0 / almost_nothing) & (c_ > 0x1p-900);
    const Mask softens = where & has_scale & is_unique & !holds;
    if (any(softens)) find_balance(most, softens, found);
    const V sum = found.motion.size + from_;
    const Mask is_found =
        (absolute(found.excess) <= 0x1p-45 * scale_of(found)) & (sum > 0x1p-200) & (sum < 0x1p200);
    leave(found.kappa, found.motion, damage_after(found.motion, softening_of(found.motion), holds), a);
    const Mask is_solved = has_scale & self().is_whole(found.motion, most) & (holds | (softens & is_found));
    return where & !(is_solved & !turns_round(found.motion));
  }

 protected:
  // What kappa makes of the node.
  struct trial : Response {
    Mask closed = Mask(false);
    V opening[3], shear, size;
  };
  // A trial kappa, what it makes of the node, and by how much it is more than the traction asks for.
  struct balanced {
    V kappa;
    trial motion;
    V excess = 0.0;
    explicit balanced(V first) : kappa(first) {}
  };
  double square_of_weight() const { return all_.weight * all_.weight; }
  secant<V> secant_of(V damage) const { return {1.0 - damage, all_.flexibility + damage * all_.softness}; }
  V shear_square(V t1, V t2) const { return square_of_weight() * (t1 * t1 + t2 * t2); }
  static V size_of(V n, V shear) { return square_root(n * n + shear); }

  softening<V> softening_of(const trial& m) const {
    if (!bond_.mixes()) return opened_;
    const V n = m.opening[0], square = m.size * m.size;
    return bond_.softening_at(mix_of(n * n, m.shear, square));
  }
  // On the way from w^- to w^+; with delay what the mean of the stiffnesses before and after makes of it.
  V mean_traction(const trial& m) const {
    const softening<V> s = softening_of(m);
    if (bond_.is_delayed()) {
      const secant<V> after = secant_of(delayed(m, s));
      return 0.25 * (stiffness_ + after.stiffness()) * (m.size + from_);
    }
    const V met = bond_.mixes() ? s.meets(now_) : opened_met_;
    return s.mean_traction_on_path(stiffness_, met, from_, m.size);
  }

  V delayed(const trial& m, const softening<V>& s) const {
    return bond_.delayed_damage(g_.damage, g_.position_step, m.size, s);
  }

  // Whether the bond stays as it is.
  Mask is_below(const trial& m) const {
    if (bond_.is_delayed()) return delayed(m, softening_of(m)) == g_.damage;
    if (!bond_.mixes()) return m.size <= opened_met_;
    const V pull = now_.stiff * m.size;
    const double least = smaller(bond_.strength, bond_.shear_strength());
    return ((g_.damage == 0.0) & (pull <= now_.soft * least)) |
           (pull <= now_.soft * softening_of(m).traction(m.size));
  }

  // Whether a bond that is made where the node is now would put energy in: it is made before then.
  Mask turns_round(const trial& m) const {
    if (!any(is_new_)) return Mask(false);
    return is_new_ & (taken_from_before(g_, m.opening, V(square_of_weight())) < 0.0);
  }

  // What the excess is small beside.
  V scale_of(const balanced& x) const { return (x.kappa + c_ * all_.steepest) * (x.motion.size + from_); }

  // Newton's steps for (1 + kappa) excess, which is linear where a bilinear bond opens in one direction,
  // inside the bracket; where its slope has no short form, secants after the first; elsewhere the fixed point
  // kappa = 2 c T/|w^+ + w^-|, which comes closer from below. From the bond as it was, but not if that is
  // stiff. A lane that is done keeps its kappa, so that its motion is the same when it is worked out again.
  void find_balance(V most, Mask active, balanced& x) const {
    constexpr int most_steps = 24;
    constexpr double balanced_to = 0x1p-50,
                     close = 0x1p-54;  // close: of a product of errors, see cohesive.md
    const Mask is_far = active & (x.kappa > 1.0);
    if (any(is_far)) {
      x.kappa = select(is_far, 0.0, x.kappa);
      self().work_out(x);
    }
    V low = 0.0, high = most, before = most - x.kappa, scaled_before = 0.0;
    for (int k = 0; k <= most_steps; ++k) {
      const V mean = mean_traction(x.motion), sum = x.motion.size + from_;
      x.excess = x.kappa * sum - 2.0 * c_ * mean;
      active = active & (absolute(x.excess) > balanced_to * (x.kappa * sum));
      if (!any(active)) return;
      const V scaled = (1.0 + x.kappa) * x.excess;
      slope s = slope_of(x, mean);
      const Mask is_straight = self().has_slope(x.motion);
      if (k > 0) {
        s.rise = select(is_straight, s.rise, scaled - scaled_before);
        s.way = select(is_straight, s.way, x.kappa - before);
      }
      const V along = x.kappa - scaled * s.way / s.rise;
      low = select(x.excess < 0.0, x.kappa, low);
      high = select(x.excess < 0.0, high, x.kappa);
      const Mask inside = (along > low) & (along < high);
      V next = along;
      if (any(!inside)) next = select(inside, along, smaller(larger(x.kappa - x.excess / sum, low), high));
      const V step = absolute(next - x.kappa);
      const V other = select(is_straight, step, absolute(x.kappa - before));
      const Mask moves = step * other > close * (x.kappa * x.kappa);
      before = select(active, x.kappa, before);
      scaled_before = select(active, scaled, scaled_before);
      x.kappa = select(active, next, x.kappa);
      active = active & moves;
      self().work_out(x);
    }
  }

  // Of (1 + kappa) excess, as a quotient: y' = -along/y, and the mean traction on the way from f to y changes
  // by (T - mean)/(y - f).
  struct slope {
    V rise, way;
  };
  slope slope_of(const balanced& x, V mean) const {
    const trial& m = x.motion;
    const V one_more = 1.0 + x.kappa, sum = m.size + from_, along = self().along(m);
    V way = m.size - from_, gain = -0.5 * all_.steepest;
    if (has_short_slope()) {
      const V end = opened_.onset + opened_.width, left = end - smaller(m.size, end);
      const V traction = select(m.size < opened_met_, stiffness_ * m.size, all_.steepest * left);
      const Mask moves = absolute(way) > 0x1p-26 * sum;
      gain = select(moves, traction - mean, gain);
      way = select(moves, way, 1.0);
    } else {
      way = 1.0;
    }
    return {m.size * way * (x.excess + one_more * sum) - one_more * along * (x.kappa * way - 2.0 * c_ * gain),
            m.size * way};
  }
  bool has_short_slope() const { return !(bond_.mixes() || opened_.exponential || bond_.is_delayed()); }
  const Step& self() const { return static_cast<const Step&>(*this); }

  V damage_after(const trial& m, const softening<V>& s, Mask holds) const {
    if (bond_.is_delayed()) return select(holds, g_.damage, delayed(m, s));
    const V traction = s.traction(m.size);
    const V reached = (m.size - all_.flexibility * traction) / (m.size + all_.softness * traction);
    return select(holds | !(m.size > s.onset), g_.damage, larger(g_.damage, reached));
  }

  void leave(V kappa, const trial& m, V damage, solved<V>& a) const {
    self().press(kappa, m, a.impulse);
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
    const Mask is_uneven = g_.velocity_step != g_.position_step;
    if (!any(is_uneven)) return;
    for (int k = 0; k < 3; ++k)
      a.position[k] = select(is_uneven, uneven_position(y[k], x_[k], g_), a.position[k]);
  }

  const bond& bond_;
  const of_all_nodes& all_;
  const gathered<V>& g_;
  Mask is_new_;               // made in this step
  V x_[3], drive_[3];         // position at the time of the impulse; w^+ + w^- without bond and contact
  V ground_, floor_, below_;  // lowest next position, lowest opening, and what is below it
  V from_, c_;                // |w^-|
  secant<V> now_;
  V stiffness_;  // its
  softening<V> opened_;
  V opened_met_;
};

}  // namespace ILAW_KIT_LEVEL
}  // namespace cohesive_law
