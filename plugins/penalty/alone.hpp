// alone.hpp - one node of the implicit penalty by bracketed secants: springs of any exponent, and what the
// solvers in packs (compression.hpp, rubbing.hpp) leave over: strong coupling, ill-conditioned H, extreme
// numbers.
#pragma once

#include "rubbing.hpp"

#include <ilaw/kit/friction.hpp>

namespace penalty_law {

// The normal spring where it has no closed form.
struct any_compression : compression<double> {
  // The impulse h <S - c phi vbar> that springs and damper give on a way that ends with v.
  double given(double v) const {
    const double way = travel(v), end = kit::positive_part(indentation - way);
    const double closed = way > indentation ? indentation / way : 1.0;
    const double force = closed * mean_force(indentation, end);
    return spring.step * kit::positive_part(force - closed * damping * mean_velocity(v));
  }

  // By what closes the step: closed form, or secants.
  solution solve() const {
    if (spring.exponent == 1.0 || spring.is_rigid()) {
      solution found = linear();
      found.end = next(found.impulse, found.opens);
      return found;
    }
    if (spring.exponent == 1.5) {
      const solution found = hertz(1.0, free, delassus);
      if (kit::is_finite(found.impulse)) return found;
    }
    return at(impulse_where([this](double r) { return given(free + delassus * r) - r; }), free);
  }
  // What an impulse leads to, where v_free is what friction has made of it.
  solution at(double impulse, double v_free) const {
    const double way = travel(v_free + delassus * impulse), opens = way > indentation ? 1.0 : 0.0;
    compression<double> moved = *this;
    moved.free = v_free;
    const double end =
        spring.exponent == 1.0 ? moved.next(impulse, opens) : kit::positive_part(indentation - way);
    return {impulse, opens, end, 0.0, 0.0};
  }

  // The impulse r where f(r), the force for a step with r less r itself, is zero; NaN where it has no root,
  // which only friction that is coupled to the normal brings about. f(0) is the force of the free step: an
  // upper bound without coupling. Secants that keep the root bracketed (Illinois; Dowell and Jarratt 1971),
  // and every third time the middle, so that no shape takes long.
  template <class Function>
  static double impulse_where(Function f) {
    constexpr double none = std::numeric_limits<double>::quiet_NaN();
    double low = 0.0, at_low = f(low), high = at_low;
    if (!(at_low > 0.0)) return low;
    double at_high = f(high);
    for (int k = 0; k < most_doublings && at_high > 0.0; ++k) at_high = f(high = 2.0 * high);
    if (at_high > 0.0) return none;
    double last = 0.0;
    for (int k = 0; k < most_iterations && at_high < 0.0; ++k) {
      const double secant = low + (high - low) * (at_low / (at_low - at_high));
      const bool inside = secant > low && secant < high && k % 3 != 2;
      const double x = inside ? secant : middle(low, high);
      if (!(x > low && x < high)) break;
      const double value = f(x), factor = last * value > 0.0 ? 0.5 : 1.0;
      const bool rises = value > 0.0;
      (rises ? low : high) = x;
      (rises ? at_low : at_high) = value;
      (rises ? at_high : at_low) *= factor;
      last = rises ? 1.0 : -1.0;
    }
    return high;
  }

 private:
  // (P(x) - P(x'))/(x - x'), without cancelling where both are close.
  double mean_force(double x, double end) const {
    if (spring.exponent == 1.0) return 0.5 * spring.stiffness * (x + end);
    const double most = kit::larger(x, end), least = kit::smaller(x, end);
    if (!(most > 0.0)) return 0.0;
    return spring.stiffness * kit::power(most, spring.exponent) * mean_power(least / most);
  }
  // (1 - t^(p+1))/((p + 1) (1 - t)), by its series in 1 - t where that is small.
  double mean_power(double t) const {
    const double q = spring.exponent + 1.0, d = 1.0 - t;
    if (d > 0x1p-4) return (1.0 - t * kit::power(t, spring.exponent)) / (q * d);
    double sum = 1.0, term = 1.0;
    for (int k = 1; k < series_terms; ++k) {
      term *= d * (k - q) / (k + 1);
      sum += term;
    }
    return sum;
  }
  static constexpr int series_terms = 16;
  static constexpr int most_iterations = 200, most_doublings = 64;
  // Half way as the bits count where the numbers are far apart, so that an impulse of any size is found.
  static double middle(double low, double high) {
    return high <= 4.0 * low ? 0.5 * (low + high) : kit::halfway(kit::larger(low, 0x1p-80 * high), high);
  }
};

// The tangential impulse -q/softness for a normal one that is known, within the cone.
template <class Vector>
struct rubbed_apart {
  Vector impulse;
  bool slips;
};
template <class Vector>
rubbed_apart<Vector> rub_apart(double normal, Vector q, double softness, double friction) {
  const auto speed = q.scaled_tangential_length();
  const double length = speed.root(), limit = speed.down * kit::friction_limit(friction, normal);
  const bool slips = length > limit * softness;
  const double factor = chosen(slips, limit, 1.0) / chosen(slips, length, softness);
  Vector impulse = Vector{} - factor * q;  // from zero, so that what does not rub gets 0, and not -0
  impulse.n = normal;
  return {impulse, slips};
}

// A rigid tangential spring: e_T in [0, 1] and r_T with r_T.v_T^- at most 0 where e_T is 0, 0 where it is
// between, and not less than 0 where it is 1, so that the stick puts nothing in. See penalty.md. Solve: of a
// rubbing<double>, with e_T given.
inline rubbing<double> giving_back(const rigid_rubbing<double>& p, double part) {
  rubbing<double> held = p;
  held.q1 += 0.5 * part * p.before1;
  held.q2 += 0.5 * part * p.before2;
  return held;
}
// With an impulse across v_T^- alone.
template <class Solve>
rubbed<double> rub_across(const rigid_rubbing<double>& p, Solve solve) {
  const double speed = kit::length(p.before1, p.before2);
  const double n1 = 0.0 - p.before2 / speed, n2 = p.before1 / speed;
  rubbing<double> turned = p;
  turned.c1 = n1 * p.c1 + n2 * p.c2;
  turned.a11 = turned.a22 = n1 * (p.a11 * n1 + p.a12 * n2) + n2 * (p.a12 * n1 + p.a22 * n2);
  turned.q1 = n1 * p.q1 + n2 * p.q2;
  turned.c2 = turned.a12 = turned.q2 = 0.0;
  rubbed<double> a = solve(turned);
  a.t2 = n2 * a.t1;
  a.t1 = n1 * a.t1;
  return a;
}
// e_T of a velocity whose part along v_T^- is -e_T v_T^-.
inline double part_given_back(const rigid_rubbing<double>& p, const rubbed<double>& a) {
  const auto before = kit::scaled_length_of(p.before1, p.before2);
  const double v1 = p.q1 + 0.5 * p.c1 * a.impulse + p.a11 * a.t1 + p.a12 * a.t2;
  const double v2 = p.q2 + 0.5 * p.c2 * a.impulse + p.a12 * a.t1 + p.a22 * a.t2;
  const double along = (before.down * p.before1) * v1 + (before.down * p.before2) * v2;
  return -2.0 * before.down * along / before.square;
}
// Not inlined, and of a copy: what is passed to functions goes through memory, which most nodes need not.
// Where e_T is known before.
template <class Solve>
[[gnu::noinline]] rubbed<double> stick_like_scalar(rigid_rubbing<double> p, Solve solve) {
  const kit::vector free{0.0, 2.0 * p.q1, 2.0 * p.q2}, before{0.0, p.before1, p.before2};
  return solve(giving_back(p, turned_part(free, before)));
}
inline bool pushes_on(const rigid_rubbing<double>& p, const rubbed<double>& a) {
  const auto size = kit::power_scale_of(kit::larger(kit::absolute(a.t1), kit::absolute(a.t2)));
  return a.outcome != has_none && pushes_on(p, a.t1, a.t2, size.down);
}

// Settled: the answer is one for its e_T. It always is where the normal impulse is given: a convex problem.
struct turned_round {
  rubbed<double> answer;
  bool settled;
};
// Where e_T is not zero.
template <class Solve>
[[gnu::noinline]] turned_round stick_in_turn(rigid_rubbing<double> p, Solve solve) {
  const rubbed<double> across = rub_across(p, solve);
  const double part = part_given_back(p, across);
  if (part <= 1.0) return {across, across.outcome != has_none && part >= 0.0};
  const rubbed<double> reversed = solve(giving_back(p, 1.0));
  return {reversed, part > 1.0 && pushes_on(p, reversed)};
}
template <class Solve>
turned_round stick(const rigid_rubbing<double>& p, Solve solve) {
  const rubbed<double> stopped = solve(p);
  return pushes_on(p, stopped) ? stick_in_turn(p, solve) : turned_round{stopped, stopped.outcome != has_none};
}

inline double outcome_of(kit::contact_mode mode) {
  if (mode == kit::contact_mode::none) return has_none;
  return mode == kit::contact_mode::stick ? sticks : slides;
}
inline rubbed<double> solved(const kit::local_coulomb& problem) {
  double r[3];
  const kit::contact_mode mode = kit::solve(problem, r);
  return {r[0], r[1], r[2], 0.0, outcome_of(mode)};
}
// Without coupling, and without the normal velocity.
inline kit::local_coulomb tangents(const rubbing<double>& p, double friction) {
  return {{0.5 * p.delassus, p.a11, p.a22, 0.0, 0.0, p.a12}, {0.0, p.q1, p.q2}, {friction, friction}};
}
inline double velocity_given_back(const rubbing<double>& p, double restitution) {
  return (p.previous < 0.0 ? restitution : 1.0) * p.previous;
}
// A rigid spring has no impulse to find: Coulomb's local problem as it is.
inline turned_round rub_on_rigid(const rigid_rubbing<double>& p, double friction, double restitution) {
  const double given_back = velocity_given_back(p, restitution);
  return stick(p, [=](const rubbing<double>& held) {
    kit::local_coulomb whole = tangents(held, friction);
    whole.h[3] = 0.5 * held.c1;
    whole.h[4] = 0.5 * held.c2;
    whole.q[0] = 0.5 * (held.free + given_back);
    return solved(whole);
  });
}

class node_alone {
 public:
  node_alone(const normal_spring& spring, double friction, double restitution, const rigid_rubbing<double>& p)
      : p_(p), friction_(friction), restitution_(restitution) {
    normal_.spring = spring;
    normal_.free = p.free;
    normal_.previous = p.previous;
    normal_.delassus = p.delassus;
    normal_.indentation = spring.is_rigid() ? 0.0 : p.indentation;
    normal_.damping = spring.damper(p.delassus);
  }

  rubbed<double> solve() const {
    if (is_like_scalar(p_) || !(friction_ > 0.0)) return apart();
    const bool couples = (p_.c1 != 0.0) | (p_.c2 != 0.0);
    return couples ? coupled() : uncoupled();
  }

 private:
  using solution = compression<double>::solution;

  rubbed<double> apart() const {
    const solution found = normal_.solve();
    if (!(p_.a11 > 0.0)) return {found.impulse, 0.0, 0.0, found.end, sticks};
    const auto result = rub_apart(found.impulse, kit::vector{0.0, p_.q1, p_.q2}, p_.a11, friction_);
    const double outcome = result.slips ? slides : sticks;
    return {found.impulse, result.impulse.t1, result.impulse.t2, found.end, outcome};
  }

  double given_back() const { return velocity_given_back(p_, restitution_); }
  // Tangents with a normal impulse that is known are the same without coupling, the tangential spring an
  // inverse mass beside H: a convex problem.
  rubbed<double> rub(const rubbing<double>& p, double normal) const {
    kit::local_coulomb given = tangents(p, friction_);
    given.q[0] = -given.h[0] * normal;
    given.q[1] += 0.5 * p.c1 * normal;
    given.q[2] += 0.5 * p.c2 * normal;
    rubbed<double> a = solved(given);
    a.impulse = normal;
    return a;
  }
  rubbed<double> rub_and_turn(double normal) const {
    return stick(p_, [this, normal](const rubbing<double>& p) { return rub(p, normal); }).answer;
  }

  // What the tangential impulse does to the normal leaves one equation for r_N. Most stick with e_T = 0.
  rubbed<double> coupled() const {
    const rubbed<double> stopped = coupled_by([this](double r) { return rub(p_, r); });
    if (!pushes_on(p_, stopped)) return stopped;
    return coupled_by([this](double r) { return rub_and_turn(r); });
  }
  template <class Rub>
  rubbed<double> coupled_by(Rub rub_at) const {
    const auto excess_at = [&](double r) { return excess(free_with(rub_at(r)), r); };
    const double normal = normal_.impulse_where(excess_at);
    rubbed<double> a = rub_at(normal);
    if (!kit::is_finite(normal)) a.outcome = has_none;
    if (!normal_.spring.is_rigid()) a.indentation = normal_.at(normal, free_with(a)).end;
    return a;
  }
  rubbed<double> uncoupled() const {
    const solution found = normal_.solve();
    rubbed<double> a = rub_and_turn(found.impulse);
    a.indentation = found.end;
    return a;
  }
  double free_with(const rubbed<double>& a) const { return p_.free + p_.c1 * a.t1 + p_.c2 * a.t2; }
  // What the spring gives less r_N.
  double excess(double free, double normal) const {
    const double v = free + p_.delassus * normal;
    return normal_.spring.is_rigid() ? 0.0 - (v + given_back()) / p_.delassus : normal_.given(v) - normal;
  }

  rigid_rubbing<double> p_;
  double friction_, restitution_;
  any_compression normal_;
};

// Not inlined into each of the law's loops.
[[gnu::noinline]] inline rubbed<double> solve_alone(const normal_spring& spring, double friction,
                                                    double restitution, const rigid_rubbing<double>& p) {
  if (spring.is_rigid() && friction > 0.0 && !is_like_scalar(p)) {
    const turned_round found = rub_on_rigid(p, friction, restitution);
    if (found.settled) return found.answer;
  }
  return node_alone(spring, friction, restitution, p).solve();
}

}  // namespace penalty_law
