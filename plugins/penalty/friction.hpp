// friction.hpp - normal spring and friction where H couples the tangents or tells them apart. To first order
// a spring is a mass: r_N falls by 1 where v_free grows by an inertia H_s. So what is left is Coulomb's local
// problem with H_s in place of H_NN. It is solved again for the v_free that r_T leaves, until the spring
// agrees.
#pragma once

#include "spring.hpp"

#include <ilaw/kit/friction.hpp>

namespace penalty_law {

// q + c r_N/2 + A r_T is the mean velocity of what slips.
template <class V>
struct problem {
  V free, previous, delassus, indentation;                // see normal_spring
  V c1 = 0.0, c2 = 0.0, a11 = 0.0, a22 = 0.0, a12 = 0.0;  // A = H_T/2 + 2/(h^2 k_T)
  V q1 = 0.0, q2 = 0.0, before1 = 0.0,
    before2 = 0.0;   // before: v_T^- of a rigid stick, whose q is that of e_T = 0
  V withheld = 0.0;  // see normal_spring
};
// status: closed where friction has a closed form or there is none; no_solution: none of them.
template <class V>
struct answer {
  V normal, t1, t2, indentation, status;
};
inline constexpr double no_solution = -1.0;

// Whether r_T pushes along v_T^-, by more than rounding leaves of a velocity that was stopped.
template <class V>
ILAW_KIT_INLINE mask_of<V> pushes_on(const problem<V>& p, const answer<V>& a) {
  constexpr double rounding = 0x1p-44;
  const V down = power_scale_of(larger(absolute(a.t1), absolute(a.t2))).down, r1 = down * a.t1,
          r2 = down * a.t2;
  return r1 * p.before1 + r2 * p.before2 > rounding * (p.a11 + p.a22) * (r1 * a.t1 + r2 * a.t2);
}
template <class V>
[[gnu::noinline]] void solve_local(const local_problem<V>& p, local::regular_answer<V>& a) {
  a = solve_regular(p);
}

// Side by side. spring_at: the normal spring for a v_free. Returns the lanes left to the scalar fallback.
template <class V, class SpringAt>
ILAW_KIT_INLINE mask_of<V> solve(const problem<V>& p, V friction, mask_of<V> is_rigid, SpringAt spring_at,
                                 answer<V>& a) {
  constexpr int most_steps = 8;
  constexpr double close = 0x1p-46;
  const mask_of<V> couples = (p.c1 != 0.0) | (p.c2 != 0.0);
  const mask_of<V> is_apart = (friction == 0.0) | !(couples | (p.a12 != 0.0) | (p.a11 != p.a22));
  spring_solution<V> found = spring_at(p.free).solve();
  a = {found.impulse, 0.0, 0.0, found.end, V(status::closed.code)};
  mask_of<V> active = (!is_apart) & (found.impulse > 0.0), left = active;
  V moved = 0.0;  // by which r_T changes v_free
  for (int k = 0; k < most_steps && any(active); ++k) {
    const V h = select(is_rigid, p.delassus, found.inertia);
    local::regular_answer<V> rubbed;
    solve_local<V>({{0.5 * h, p.a11, p.a22, 0.5 * p.c1, 0.5 * p.c2, p.a12},
                    {-0.5 * (h * found.impulse + moved), p.q1, p.q2},
                    {friction, friction}},
                   rubbed);
    active = active & rubbed.found;
    const V r = rubbed.r[0], t1 = rubbed.r[1], t2 = rubbed.r[2];
    moved = zero_unless(active, p.c1 * t1 + p.c2 * t2);
    if (any(active & couples)) found = spring_at(p.free + moved).solve();
    const mask_of<V> done = active & (absolute(found.impulse - r) <= close * r);
    const V code = select(rubbed.sticks, V(status::stick.code), V(status::slip.code));
    a = {select(done, r, a.normal), select(done, t1, a.t1), select(done, t2, a.t2),
         select(done, found.end, a.indentation), select(done, code, a.status)};
    left = left & (!done);
    active = active & (!done) & (found.impulse > 0.0);
  }
  return left | pushes_on(p, a);
}

// The scalar fallback: strong coupling, ill-conditioned H, extreme numbers, any exponent, a rigid stick that
// turns round. r_T for a given r_N is Coulomb's local problem, and leaves one equation for r_N.
struct scalar_friction {
  const problem<double>& p;
  normal_spring<double> spring;
  double friction;

  answer<double> solve() const {
    const double normal = spring.impulse_where(true, [this](double r) { return given(rub(r), r); });
    answer<double> a = rub(normal);
    normal_spring<double> moved = spring;
    moved.free = free_with(a);
    a.indentation = moved.end_with(normal);
    if (!is_finite(normal)) a.status = no_solution;
    return a;
  }

 private:
  // A rigid stick puts nothing in: r_T.v_T^- <= 0 where e_T = 0, >= 0 where e_T = 1, and 0 between.
  answer<double> rub(double normal) const {
    const answer<double> stopped = rub(normal, 0.0);
    if (!pushes_on(p, stopped)) return stopped;
    const answer<double> reversed = rub(normal, 1.0);
    return pushes_on(p, reversed) ? reversed : rub_across(normal);
  }
  // For one e_T. Without coupling, the tangential spring an inverse mass beside H: a convex problem.
  answer<double> rub(double normal, double e_t) const {
    const double h = 0.5 * p.delassus, q1 = p.q1 + 0.5 * e_t * p.before1 + 0.5 * p.c1 * normal;
    const double q2 = p.q2 + 0.5 * e_t * p.before2 + 0.5 * p.c2 * normal;
    double r[3];
    const contact_mode mode = ilaw::kit::solve(
        {{h, p.a11, p.a22, 0.0, 0.0, p.a12}, {-h * normal, q1, q2}, {friction, friction}}, r);
    const double code = (mode == contact_mode::stick ? status::stick : status::slip).code;
    return {normal, r[1], r[2], 0.0, mode == contact_mode::none ? no_solution : code};
  }
  // With an impulse across v_T^- alone, along the unit vector n.
  answer<double> rub_across(double normal) const {
    const double speed = length(p.before1, p.before2), n1 = 0.0 - p.before2 / speed, n2 = p.before1 / speed;
    const double b = n1 * (p.q1 + 0.5 * p.c1 * normal) + n2 * (p.q2 + 0.5 * p.c2 * normal);
    const double a = n1 * (p.a11 * n1 + p.a12 * n2) + n2 * (p.a12 * n1 + p.a22 * n2);
    const auto found = ilaw::kit::rub(a, normal, scaled_length_of(b, 0.0), 0.0, 0.0, friction);
    return {normal, 0.0 - found.factor * b * n1, 0.0 - found.factor * b * n2, 0.0, found.status.code()};
  }
  double free_with(const answer<double>& a) const { return p.free + p.c1 * a.t1 + p.c2 * a.t2; }
  // The impulse that the spring gives in a step with these impulses.
  double given(const answer<double>& a, double normal) const {
    const double v = free_with(a) + p.delassus * normal, e = (0.5 - spring.lead) / (0.5 + spring.lead);
    if (spring.stiffness < infinity) return spring.given(v);
    return normal - (v + (p.previous < 0.0 ? e : 1.0) * p.previous) / p.delassus;
  }
};

}  // namespace penalty_law
