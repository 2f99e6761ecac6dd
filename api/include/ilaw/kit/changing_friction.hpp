// changing_friction.hpp - contact whose coefficient of friction depends on the slip speed of the step, for
// any H.
//
// A law gives the coefficient of a node and step, Mu, with
//   coefficient<V> operator()(V v) const   mu and dmu/dv at the slip speed v >= 0 after the step
//   V start(V most, V drag) const          optional: where to begin; most is the speed without friction and
//                                          drag = h_T r_N
//   V speed(V most, V drag) const          optional: the solution of v + drag mu(v) = most to take, where
//                                          there are several; the derivative may be an estimate then
// as a struct of V, or as such a struct and a curve_of(struct) of the law that makes Mu from it. The speed
// follows from v = |u_T|, u = q + H r, with the contact of friction.hpp for mu(v). Without speed() the node
// sticks where it can stick with mu(0). Else a solution exists, since |u_T| is bounded; it is the only one
// for H = diag(h_N, h_T, h_T) where mu is convex or nowhere falls faster than 1/drag.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit/friction.hpp>
#include <ilaw/kit/roots.hpp>

namespace ilaw::kit::inline ILAW_KIT_LEVEL {

template <class V>
using coefficient = value_and_slope<V>;

// a asinh(e^x), where e^x may overflow, and its derivative by x.
template <class V>
coefficient<V> regularized_logarithm(V a, V x) {
  constexpr double middle = -0.5;
  const V below = exp(smaller(x, middle)), of_below = square_root(1.0 + below * below);
  const V of_above = square_root(1.0 + exp(-2.0 * larger(x, middle)));
  const auto is_small = x < middle;
  const V small = log_one_plus(below + below * below / (1.0 + of_below)), large = x + log(1.0 + of_above);
  return {a * select(is_small, small, large), a * select(is_small, below / of_below, 1.0 / of_above)};
}

// ---- H = diag(h_N, h_T, h_T)

template <class Mu, class V>
concept chooses_speed = requires(const Mu& mu, V v) {
  mu.speed(v, v);
};

// v + drag mu(v) = most, 0 where the node sticks.
template <class V, class Mu>
ILAW_KIT_INLINE V slip_speed(V most, V drag, const Mu& mu) {
  if constexpr (chooses_speed<Mu, V>) return mu.speed(most, drag);
  const mask_of<V> slips = most > drag * mu(V(0.0)).value;
  if (!any(slips)) return 0.0;
  const V low = 0x1p-900 * most;  // slower is sticking
  V start = most;
  if constexpr (requires { mu.start(most, drag); }) start = larger(mu.start(most, drag), low);
  const auto trial = [&](V v) ILAW_KIT_LAMBDA {
    const coefficient<V> c = mu(v);
    return root_trial<V>{(v - most) + drag * c.value, 1.0, 1.0 + drag * c.slope, 1.0, slips};
  };
  return zero_unless(slips, root_between(low, most, start, slips, trial));
}

// The status, and the slip speed that mu is taken at.
template <class V>
struct changing_slip {
  status_of<V> status;
  V speed;
};
template <class Node, class Vector, class Mu>
ILAW_KIT_INLINE changing_slip<number_of<Node>> apply_changing_friction(Node& node,
                                                                       const contact_problem<Vector>& contact,
                                                                       const Mu& mu) {
  using V = number_of<Node>;
  const V drag = node.delassus.tangential() * pressing_impulse(node.delassus, contact);
  const V speed = slip_speed(contact.q.tangential_length(), drag, mu);
  return {apply_isotropic_friction(node, contact, mu(speed).value), speed};
}

// ---- any H

template <class V, class Mu>
struct changing_problem {
  friction_problem<V> friction;
  Mu mu;
};
template <class V>
struct changing_answer {
  friction_answer<V> friction;
  V speed;
};

// |u_T|; what a sticking contact leaves of it is rounding.
template <class V>
V slip_speed_of(const friction_problem<V>& p, const friction_answer<V>& a) {
  const V *h = p.contact.h, *q = p.contact.q, *r = a.r;
  const V u1 = q[1] + (h[3] * r[0] + (h[1] * r[1] + h[5] * r[2]));
  const V u2 = q[2] + (h[4] * r[0] + (h[5] * r[1] + h[2] * r[2]));
  return zero_unless(a.status == status::slip.code, length(u1, u2));
}

// By the solver of Coulomb's law for a given coefficient, solve(problem, answer, lanes that need the answer).
template <class V, class Mu, class Solve>
void solve_changing_friction_by(const friction_problem<V>& p, const Mu& mu_at, changing_answer<V>& a,
                                Solve solve) {
  friction_problem<V> tried = p;
  for (V& rest : tried.rest) rest = 0.0;  // positive work is taken off the solution alone
  const V *h = p.contact.h, *q = p.contact.q;
  const V normal = positive_part(-q[0] / h[0]), most = length(q[1], q[2]);
  const V rounding = 0x1p-50 * (most + normal * length(h[3], h[4]));
  const V frictionless = length(q[1] + h[3] * normal, q[2] + h[4] * normal);
  a.friction = {};
  // The solver takes no coefficient of 0, with which friction often begins.
  const auto speed_with = [&](V mu, mask_of<V> needed) {
    const mask_of<V> resists = needed & !(mu <= 0.0);
    tried.contact.mu[0] = tried.contact.mu[1] = mu;
    if (any(resists)) solve(tried, a.friction, resists);
    return select(mu <= 0.0, frictionless, slip_speed_of(tried, a.friction));
  };
  tried.contact.mu[0] = tried.contact.mu[1] = 0.0;
  const mask_of<V> closed = has_closed_form(tried.contact);
  mask_of<V> slips = !closed;
  if constexpr (!chooses_speed<Mu, V>) slips = slips & (speed_with(mu_at(V(0.0)).value, slips) > 0.0);
  const full<V> inertia{h[0], h[1], h[2], h[3], h[4], h[5]};
  const vector<V> whole{q[0], q[1], q[2]};
  const vector<V> holding = inertia.solve(whole);  // as an impulse in the other direction it stops the node
  const V most_mu = select(holding.n < 0.0, holding.tangential_length() / -holding.n, infinity);
  // The speed falls almost linearly with the coefficient, to 0 at that which holds the node: secants of that
  // line, on which mu is exact.
  V drag = select(closed, h[1], 0.5 * (h[1] + h[2])) * normal;
  const V uncoupled = slip_speed(most, drag, mu_at);
  V v = uncoupled;
  V mu = mu_at(v).value, speed = speed_with(mu, slips);
  for (int k = 0; k < 12 && any(slips & (absolute(v - speed) > rounding)); ++k) {
    const mask_of<V> goes_on = slips & (absolute(v - speed) > rounding);
    mu = select(speed > 0.0, mu, smaller(mu, most_mu));
    const V next = slip_speed(speed + drag * mu, drag, mu_at), next_mu = mu_at(next).value;
    const V next_speed = speed_with(next_mu, goes_on);
    const V slope =
        (speed - next_speed) / (select(next_speed > 0.0, next_mu, smaller(next_mu, most_mu)) - mu);
    drag = select(goes_on & (slope > 0.0) & (slope < infinity), slope, drag);
    v = select(goes_on, next, v);
    mu = select(goes_on, next_mu, mu);
    speed = select(goes_on, next_speed, speed);
  }
  const mask_of<V> unsolved = slips & (absolute(v - speed) > rounding);
  if (any(unsolved)) {
    const auto trial = [&](V at) {
      const coefficient<V> c = mu_at(at);
      const V residual = at - speed_with(c.value, unsolved);
      return root_trial<V>{zero_unless(absolute(residual) > rounding, residual), 1.0, 1.0 + drag * c.slope,
                           1.0, !slips};
    };
    // |u|^2 <= |H| q.(H^-1 q), as no impulse does positive work on u.
    const V energy = normal_product(whole, holding) + tangential_product(whole, holding);
    const V high = 2.0 * square_root((h[0] + (h[1] + h[2])) * energy);
    const V coupled = root_between(0x1p-200 * high, high, select(v > 0.0, v, most), unsolved, trial);
    v = select(unsolved, coupled, v);
  }
  a.speed = select(closed, uncoupled, zero_unless(slips, v));
  tried = p;
  tried.contact.mu[0] = tried.contact.mu[1] = mu_at(a.speed).value;
  solve(tried, a.friction, h[0] > 0.0);
}
// A call: the solver of a changing coefficient needs it at several places, and would hold a copy at each.
template <class V>
[[gnu::noinline]] mask_of<V> solve_friction_apart(const friction_problem<V>& p, friction_answer<V>& a) {
  return solve_friction(p, a);
}
template <class V, class Mu>
mask_of<V> solve_changing_friction(const friction_problem<V>& p, const Mu& mu, changing_answer<V>& a) {
  mask_of<V> left = none<V>();
  solve_changing_friction_by(
      p, mu, a, [&](const friction_problem<V>& tried, friction_answer<V>& found, mask_of<V> needed) {
        left = left | (solve_friction_apart(tried, found) & needed);
      });
  return left;
}
template <class Mu>
void solve_changing_friction_exactly(const friction_problem<double>& p, const Mu& mu,
                                     changing_answer<double>& a) {
  solve_changing_friction_by(p, mu, a,
                             [](const friction_problem<double>& tried, friction_answer<double>& found, bool) {
                               if (solve_friction_apart(tried, found)) solve_friction_exactly(tried, found);
                             });
}

// ---- the law

template <template <class> class Law, template <class> class Mu, class V>
struct changing_friction {
  using problem = changing_problem<V, Mu<V>>;
  using answer = changing_answer<V>;

  template <class Node>
  status_of<V> step(Node& node) const requires is_transverse<Node> {
    const changing_slip<V> found =
        apply_changing_friction(node, contact(node), curve(law().coefficient_in(node)));
    law().slide(node, found.speed);
    return found.status;
  }
  template <class Node>
  asked<V> ask(Node& node, problem& open) const requires(!is_transverse<Node>) {
    open.mu = law().coefficient_in(node);
    return ask_friction(node, contact(node), 0.0, 0.0, open.friction);
  }
  mask_of<V> solve(const problem& p, answer& a) const {
    return solve_changing_friction(p.friction, curve(p.mu), a);
  }
  void solve_scalar(const problem& p, answer& a) const {
    solve_changing_friction_exactly(p.friction, curve(p.mu), a);
  }
  template <class Node>
  status_of<V> finish(Node& node, const answer& a) const {
    const status_of<V> found = finish_friction(node, a.friction);
    law().slide(node, a.speed);
    return found;
  }

  // The pressure in the step; for an H that is not transverse that of the contact without friction.
  template <class Node>
  V pressure_in(const Node& node) const {
    const V normal = pressing_impulse(node.delassus, contact(node));
    return zero_unless(normal > 0.0, normal / node.velocity_step / node.area);
  }

 private:
  ILAW_KIT_INLINE const Law<V>& law() const { return static_cast<const Law<V>&>(*this); }
  ILAW_KIT_INLINE auto curve(const Mu<V>& mu) const {
    if constexpr (requires { law().curve_of(mu); })
      return law().curve_of(mu);
    else
      return mu;
  }
  template <class Node>
  ILAW_KIT_INLINE auto contact(const Node& node) const {
    return contact_problem_of(contact_at(node, law().restitution, law().activation), node.v_free,
                              node.v_previous);
  }
};

}  // namespace ilaw::kit
