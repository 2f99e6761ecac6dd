// friction.hpp - normal spring and friction where H couples the tangents or tells them apart. To first order the
// spring is a mass: v_N falls by 1 where r_N grows by 1/H_s. So what is left is Coulomb's local problem, with H_s in
// place of H_NN, and is solved again from what its r_T leaves of v_free, until the spring agrees. See penalty.md.
#pragma once

#include "spring.hpp"

#include <ilaw/kit/friction.hpp>

namespace penalty_law {

// q + c r_N/2 + A r_T is the mean velocity of what slips.
template <class V>
struct problem {
  V free, previous, delassus, indentation;  // see normal_spring
  V c1, c2, a11, a22, a12;                  // A = H_T/2 + 2/(h^2 k_T)
  V q1, q2;
  V before1, before2;  // v_T^- of a rigid stick, whose q is that of e_T = 0; else zero
};
// status: closed where friction has a closed form, or there is none; no_solution: none of them.
template <class V>
struct answer {
  V normal, t1, t2, indentation, status;
};
inline constexpr double no_solution = -1.0;

// Whether r_T pushes along v_T^-, by more than rounding leaves of a velocity that was stopped.
template <class V>
ILAW_KIT_INLINE mask_of<V> pushes_on(const problem<V>& p, const answer<V>& a) {
  constexpr double rounding = 0x1p-44;
  const V down = power_scale_of(larger(absolute(a.t1), absolute(a.t2))).down, r1 = down * a.t1, r2 = down * a.t2;
  return r1 * p.before1 + r2 * p.before2 > rounding * (p.a11 + p.a22) * (r1 * a.t1 + r2 * a.t2);
}

// Side by side. Returns the lanes that are left to the scalar fallback.
template <class V>
ILAW_KIT_INLINE mask_of<V> solve(const problem<V>& p, normal_spring<V> spring, V friction, answer<V>& a) {
  constexpr int most_steps = 8;
  constexpr double close = 0x1p-46;
  const mask_of<V> couples = (p.c1 != 0.0) | (p.c2 != 0.0);
  const mask_of<V> is_apart = (friction == 0.0) | !(couples | (p.a12 != 0.0) | (p.a11 != p.a22));
  auto found = spring.solve();
  a = {found.impulse, 0.0, 0.0, found.end, V(status::closed.code)};
  mask_of<V> active = (!is_apart) & (found.impulse > 0.0), left = active;
  V t1 = 0.0, t2 = 0.0;
  for (int k = 0; k < most_steps && any(active); ++k) {
    const V h = select(spring.stiffness == infinity, spring.delassus, found.inertia);
    const V moved = p.c1 * t1 + p.c2 * t2;
    const local_problem<V> local{{0.5 * h, p.a11, p.a22, 0.5 * p.c1, 0.5 * p.c2, p.a12},
                                 {-0.5 * (h * found.impulse + moved), p.q1, p.q2},
                                 {friction, friction}};
    const auto rubbed = solve_regular(local);
    active = active & rubbed.found;
    t1 = select(active, rubbed.r[1], t1);
    t2 = select(active, rubbed.r[2], t2);
    if (any(active & couples)) {
      spring.free = p.free + (p.c1 * t1 + p.c2 * t2);
      found = spring.solve();
    }
    const V r = rubbed.r[0];
    const mask_of<V> done = active & (absolute(found.impulse - r) <= close * r);
    const V code = select(rubbed.sticks, V(status::stick.code), V(status::slip.code));
    a = {select(done, r, a.normal), select(done, t1, a.t1), select(done, t2, a.t2),
         select(done, found.end, a.indentation), select(done, code, a.status)};
    left = left & (!done);
    active = active & (!done) & (found.impulse > 0.0);
  }
  return left | pushes_on(p, a);
}

// The scalar fallback: strong coupling, ill-conditioned H, extreme numbers, any exponent, a rigid stick that turns
// round. r_T for a given r_N is Coulomb's local problem, and leaves one equation for r_N.
class scalar_friction {
 public:
  scalar_friction(const problem<double>& p, const normal_spring<double>& spring, double friction)
      : p_(p), spring_(spring), friction_(friction), is_rigid_(spring.stiffness == infinity) {}

  answer<double> solve() const {
    if (is_rigid_) {  // which has no impulse to find: Coulomb's local problem as it is
      const double h = 0.5 * p_.delassus, q = 0.5 * (p_.free + given_back());
      const answer<double> whole =
          coulomb({{h, p_.a11, p_.a22, 0.5 * p_.c1, 0.5 * p_.c2, p_.a12}, {q, p_.q1, p_.q2}, {}});
      if (whole.status != no_solution && !pushes_on(p_, whole)) return whole;
    }
    if (p_.c1 == 0.0 && p_.c2 == 0.0) {
      const auto found = spring_.solve();
      answer<double> a = rub(found.impulse);
      a.indentation = found.end;
      return a;
    }
    const double normal = spring_.impulse_where(true, [this](double r) { return given(rub(r), r); });
    answer<double> a = rub(normal);
    normal_spring<double> moved = spring_;
    moved.free = free_with(a);
    a.indentation = is_rigid_ ? 0.0 : moved.end_with(normal);
    if (!is_finite(normal)) a.status = no_solution;
    return a;
  }

 private:
  answer<double> coulomb(local_coulomb problem) const {
    problem.mu[0] = problem.mu[1] = friction_;
    double r[3];
    const contact_mode mode = ilaw::kit::solve(problem, r);
    const double code = (mode == contact_mode::stick ? status::stick : status::slip).code;
    return {r[0], r[1], r[2], 0.0, mode == contact_mode::none ? no_solution : code};
  }
  // For one e_T: without coupling, the tangential spring an inverse mass beside H. A convex problem.
  answer<double> rub(double normal, double e_t) const {
    const double q1 = p_.q1 + 0.5 * e_t * p_.before1 + 0.5 * p_.c1 * normal;
    const double q2 = p_.q2 + 0.5 * e_t * p_.before2 + 0.5 * p_.c2 * normal, h = 0.5 * p_.delassus;
    answer<double> a = coulomb({{h, p_.a11, p_.a22, 0.0, 0.0, p_.a12}, {-h * normal, q1, q2}, {}});
    a.normal = normal;
    return a;
  }
  // With an impulse across v_T^- alone, along the unit vector n.
  answer<double> rub_across(double normal) const {
    const double speed = length(p_.before1, p_.before2), n1 = 0.0 - p_.before2 / speed, n2 = p_.before1 / speed;
    const double b = n1 * (p_.q1 + 0.5 * p_.c1 * normal) + n2 * (p_.q2 + 0.5 * p_.c2 * normal);
    const double a = n1 * (p_.a11 * n1 + p_.a12 * n2) + n2 * (p_.a12 * n1 + p_.a22 * n2);
    const auto found = ilaw::kit::rub(a, normal, scaled_length_of(b, 0.0), 0.0, 0.0, friction_);
    return {normal, 0.0 - found.factor * b * n1, 0.0 - found.factor * b * n2, 0.0, found.status.code()};
  }
  // A rigid stick puts nothing in: r_T.v_T^- <= 0 where e_T = 0, >= 0 where e_T = 1, and 0 between.
  answer<double> rub(double normal) const {
    const answer<double> stopped = rub(normal, 0.0);
    if (!pushes_on(p_, stopped)) return stopped;
    const answer<double> reversed = rub(normal, 1.0);
    return pushes_on(p_, reversed) ? reversed : rub_across(normal);
  }

  double free_with(const answer<double>& a) const { return p_.free + p_.c1 * a.t1 + p_.c2 * a.t2; }
  // -v_N of a rigid spring after the impact: e v_N^- of a node that arrives.
  double given_back() const {
    const double part = (0.5 - spring_.lead) / (0.5 + spring_.lead);
    return p_.previous < 0.0 ? part * p_.previous : p_.previous;
  }
  // What the spring gives in a step with these impulses.
  double given(const answer<double>& a, double normal) const {
    const double v = free_with(a) + p_.delassus * normal;
    return is_rigid_ ? normal - (v + given_back()) / p_.delassus : spring_.given(v);
  }

  const problem<double>& p_;
  const normal_spring<double>& spring_;
  const double friction_;
  const bool is_rigid_;
};

}  // namespace penalty_law
