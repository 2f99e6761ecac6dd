// friction.hpp - friction of the penalty law: in closed form for a normal impulse that is known and tangents of one
// resistance, and together with the implicit normal spring for any H. What sticks has
//
//     r_T = -A^-1 (q + c r_N/2),    which leaves a normal spring with    v_free - c.A^-1 q,    H_NN - c.A^-1 c/2.
//
// What slips along a unit vector e has r_T = -mu r_N e, and a normal spring with H_NN - mu c.e; that the slip is along
// e is one equation for its angle. penalty.md derives it.
#pragma once

#include "spring.hpp"

#include <ilaw/kit/friction.hpp>

namespace penalty_law {

// The decision between stick and slip: the impulse that would hold the node leaves the cone |r_T| <= mu r_N. Both may
// be multiplied by what resists.
template <class V>
ILAW_KIT_INLINE mask_of<V> slips(V holding, V cone) {
  return holding > cone;
}

// The tangential impulse -q/resistance within the cone; says where the node slips.
template <class Node, class V>
ILAW_KIT_INLINE mask_of<V> rub(Node& node, V normal, vector<V> q, V resistance, V friction) {
  const scaled_length<V> speed = q.scaled_tangential_length();
  const V limit = speed.down * friction_limit(friction, normal), length = speed.root();
  const mask_of<V> slides = slips(length, limit * resistance);
  node.impulse = q.against(normal, select(slides, limit, V(1.0)) / select(slides, length, resistance));
  return slides;
}

// q + c r_N/2 + A r_T is the mean velocity of what slips.
template <class V>
struct problem {
  spring_problem<V> spring;
  V friction, c1, c2;
  symmetric_2x2<V, V> a;  // H_T/2 + 2/(h^2 k_T)
  V q1, q2;
  V before1, before2;  // v_T^- of a rigid stick, whose q is that of e_T = 0; else zero
};
// status: closed where the closed form above gives the rest; no_solution: none of them.
template <class V>
struct answer {
  V normal, t1, t2, indentation, status;
};
inline constexpr double no_solution = -1.0;

// Whether r_T pushes along v_T^-, by more than rounding leaves of a velocity that was stopped.
template <class V>
ILAW_KIT_INLINE mask_of<V> pushes_on(const problem<V>& p, V t1, V t2) {
  constexpr double rounding = 0x1p-44;
  const V down = power_scale_of(larger(absolute(t1), absolute(t2))).down, r1 = down * t1, r2 = down * t2;
  return r1 * p.before1 + r2 * p.before2 > rounding * p.a.trace() * (r1 * t1 + r2 * t2);
}

// ---- regular problems, side by side ---------------------------------------------------------------------------------

// IsLinear: p = 1, else 3/2. Loses: see normal_spring.
template <class V, bool IsLinear, bool Loses>
class regular_friction {
 public:
  using mask = mask_of<V>;

  explicit regular_friction(const problem<V>& p) : p_(p), s_(p.spring), a_(p.a), spring_{p.spring} {}

  // Returns which nodes it solved.
  ILAW_KIT_INLINE mask solve(answer<V>& a) const {
    const mask pushes = this->pushes();
    const trial stuck = stick();
    const V held = p_.friction * (stuck.normal.impulse * stuck.det);
    const mask holds = !slips(stuck.length, held), regular = is_regular(stuck, holds);
    const mask slides = pushes & regular & !holds;
    motion end{};
    mask found = holds & regular;
    if (any(slides)) found = found | find_slide(slides, stuck, held, end);
    if (any(pushes & holds)) {
      const V inverse = 1.0 / stuck.det;
      end.t1 = select(holds, stuck.n1 * inverse, end.t1);
      end.t2 = select(holds, stuck.n2 * inverse, end.t2);
      end.normal.impulse = select(holds, stuck.normal.impulse, end.normal.impulse);
      end.normal.opens = select(holds, stuck.normal.opens, end.normal.opens);
      end.normal.end = select(holds, stuck.normal.end, end.normal.end);
    }
    const V r = zero_unless(pushes, end.normal.impulse), t1 = zero_unless(pushes, end.t1),
            t2 = zero_unless(pushes, end.t2);
    a = {r, 0.0 - t1, 0.0 - t2, end_of(pushes, r, end.normal, s_.free - (p_.c1 * t1 + p_.c2 * t2)),
         select(holds, V(status::stick.code), V(status::slip.code))};
    return has_usual_scales() & ((!pushes) | (found & (r > 0.0))) & !pushes_on(p_, a.t1, a.t2);
  }

 private:
  using solution = typename normal_spring<V, Loses>::solution;
  static constexpr double close = Loses ? 0x1p-40 : 0x1p-26;  // a step so small is the last
  static constexpr double least_determinant = 0x1p-20;
  static constexpr int most_steps = 16;

  ILAW_KIT_INLINE solution respond(V scale, V free, V delassus) const {
    if constexpr (IsLinear)
      return spring_.linear(scale, free, delassus);
    else
      return spring_.hertz(scale, free, delassus);
  }
  // x', v_free being what friction has made of it. Without losses, whether the spring opens is told by its way.
  ILAW_KIT_INLINE V end_of(mask pushes, V r, const solution& found, V free) const {
    normal_spring<V, Loses> moved = spring_;
    moved.free = free;
    const V left = s_.indentation - moved.way(free + s_.delassus * r);
    if constexpr (!Loses) return moved.next(r, select(left > 0.0, V(0.0), V(1.0)));
    return select(pushes, IsLinear ? moved.next(r, found.opens) : found.end, positive_part(left));
  }

  // Whether no product on the way overflows or underflows. What is allowed for H bounds a22, too.
  ILAW_KIT_INLINE mask has_usual_scales() const {
    constexpr double scale = 0x1p80;
    const V speed = absolute(s_.free) + absolute(s_.previous) + absolute(p_.q1) + absolute(p_.q2) +
                    s_.indentation * (1.0 / s_.step);
    return (a_.a11 < scale) & (s_.delassus > 1.0 / scale) & (speed > 1.0 / scale) & (speed < scale);
  }
  // Whether the spring pushes in the free step. If not, no impulse is the solution.
  ILAW_KIT_INLINE mask pushes() const {
    if constexpr (IsLinear)
      return spring_.linear_pushes();
    else
      return respond(V(1.0), s_.free, s_.delassus).impulse > 0.0;
  }

  // What sticks, without the division by the determinant of A: r_T = -A^-1 b = -(n1, n2)/det.
  struct trial {
    V det, b1, b2, n1, n2, length, condensed, coupling;
    solution normal;
  };
  ILAW_KIT_INLINE trial stick() const {
    trial x;
    const V m1 = a_.adjugate_1(p_.c1, p_.c2), m2 = a_.adjugate_2(p_.c1, p_.c2);
    x.det = a_.determinant();
    x.coupling = 0.5 * (p_.c1 * m1 + p_.c2 * m2);
    x.condensed = x.det * s_.delassus - x.coupling;
    x.normal = respond(x.det, x.det * s_.free - (m1 * p_.q1 + m2 * p_.q2), x.condensed);
    const V half = 0.5 * x.normal.impulse;
    x.b1 = p_.q1 + half * p_.c1;
    x.b2 = p_.q2 + half * p_.c2;
    x.n1 = a_.adjugate_1(x.b1, x.b2);
    x.n2 = a_.adjugate_2(x.b1, x.b2);
    x.length = square_root(x.n1 * x.n1 + x.n2 * x.n2);
    return x;
  }
  // Weak coupling, also of a rigid spring, and fair condition: |r_T| - mu r_N falls with alpha, by Cauchy and Schwarz,
  // and has one root.
  ILAW_KIT_INLINE mask is_regular(const trial& x, mask holds) const {
    const V mu = p_.friction;
    const mask is_weak = 2.0 * (mu * mu * (a_.trace() * x.coupling)) < s_.delassus * x.condensed;
    return (holds | is_weak) & (x.det > least_determinant * (a_.a11 * a_.a22)) &
           (x.condensed > least_determinant * (x.det * s_.delassus));
  }

  // r_T = -(t1, t2), against the unit vector e.
  struct motion {
    V e1, e2, t1, t2;
    solution normal;
  };
  // What motion and normal spring disagree by at an impulse r, and how that changes with r and with v_free. Without
  // losses by polynomials, which take no division; else r is found first, and is what agrees.
  struct disagreement {
    V amount, by_impulse, by_speed;
  };
  ILAW_KIT_INLINE disagreement compare(V h, solution& normal) const {
    if constexpr (Loses) {
      normal = respond(V(1.0), s_.free, h);
      return {V(0.0), normal.pace, normal.gain};
    } else {
      const V step = s_.step, k = s_.stiffness, r = normal.impulse, x = s_.indentation;
      const V v = (s_.free + s_.previous) + h * r;
      // By both, since where x is 0 the open spring's r v = k x^2 has a root at v = 0, too.
      const mask opens = (0.5 * step * v > x) & (r < 0.5 * step * k * x);
      const V by_speed = select(opens, r, 0.25 * step * step * k);
      const V given = select(opens, k * x * x, step * k * x - r);
      return {by_speed * v - given, by_speed * h + select(opens, v, V(1.0)), by_speed};
    }
  }
  ILAW_KIT_INLINE V slid_delassus(const motion& x) const {
    return s_.delassus - p_.friction * (p_.c1 * x.e1 + p_.c2 * x.e2);
  }

  // Newton's method for the angle of e, and for r_N where nothing is lost. It starts between the directions of what
  // sticks and of its q + c r_N/2, where A would be a multiple of I. Lanes that are done keep what they have, so that
  // none sees its neighbours. Says which are done.
  ILAW_KIT_INLINE mask find_slide(mask active, const trial& stuck, V held, motion& x) const {
    const V lacks = 0.5 * a_.trace() * (stuck.length - held);
    const V s1 = held * stuck.n1 + lacks * stuck.b1, s2 = held * stuck.n2 + lacks * stuck.b2;
    const V per_length = 1.0 / square_root(s1 * s1 + s2 * s2);
    x.e1 = s1 * per_length;
    x.e2 = s2 * per_length;
    if constexpr (!Loses) x.normal = respond(V(1.0), s_.free, slid_delassus(x));
    const V mu = p_.friction, c1 = mu * p_.c1, c2 = mu * p_.c2;
    const V a11 = mu * a_.a11, a22 = mu * a_.a22, a12 = mu * a_.a12;
    mask found = active & (!active);
    for (int k = 0; k < most_steps && any(active); ++k) {
      const V e1 = x.e1, e2 = x.e2, a1 = a11 * e1 + a12 * e2, a2 = a12 * e1 + a22 * e2;
      const V z1 = 0.5 * p_.c1 - a1, z2 = 0.5 * p_.c2 - a2;
      solution normal = x.normal;
      const disagreement spring = compare(s_.delassus - (c1 * e1 + c2 * e2), normal);
      const V r = normal.impulse, y1 = p_.q1 + r * z1, y2 = p_.q2 + r * z2, along = e1 * y1 + e2 * y2;
      const V across = e1 * y2 - e2 * y1, by_impulse = e1 * z2 - e2 * z1;
      const V by_turn = r * ((e1 * a1 + e2 * a2) - (a11 + a22)) - along;
      const V spring_by_turn = spring.by_speed * r * (c1 * e2 - c2 * e1);
      const V inverse = 1.0 / (by_turn * spring.by_impulse - by_impulse * spring_by_turn);
      const V turn = (by_impulse * spring.amount - across * spring.by_impulse) * inverse;
      const V more = (spring_by_turn * across - by_turn * spring.amount) * inverse;
      const V t = larger(smaller(turn, V(0.5)), V(-0.5));
      const V u1 = e1 - t * e2, u2 = e2 + t * e1, square = u1 * u1 + u2 * u2, unit = 1.5 - 0.5 * square;
      x.e1 = select(active, u1 * unit, e1);
      x.e2 = select(active, u2 * unit, e2);
      x.normal.impulse = select(active, larger(r + more, 0.5 * r), x.normal.impulse);
      const mask done = (absolute(turn) <= close) & (absolute(more) <= close * r) &
                        (absolute(square - 1.0) <= 0.25 * close);
      found = found | (active & done & (along > 0.0));
      active = active & !done;
    }
    if constexpr (Loses) x.normal = respond(V(1.0), s_.free, slid_delassus(x));
    x.t1 = mu * x.normal.impulse * x.e1;
    x.t2 = mu * x.normal.impulse * x.e2;
    return found;
  }

  const problem<V>& p_;
  const spring_problem<V>& s_;
  const symmetric_2x2<V, V>& a_;
  normal_spring<V, Loses> spring_;
};

template <bool IsLinear, bool Loses, class V>
ILAW_KIT_INLINE void solve_regular(const problem<V>& p, mask_of<V> where, answer<V>& a, mask_of<V>& left) {
  if (!any(where)) return;
  answer<V> own;
  const mask_of<V> solved = where & regular_friction<V, IsLinear, Loses>(p).solve(own);
  a = {select(solved, own.normal, a.normal), select(solved, own.t1, a.t1), select(solved, own.t2, a.t2),
       select(solved, own.indentation, a.indentation), select(solved, own.status, a.status)};
  left = left & !solved;
}
// Solves the normal springs that stand alone, since H has one tangential entry or nothing rubs, and what is regular of
// the others. Returns the lanes that it did not solve.
template <class V>
ILAW_KIT_INLINE mask_of<V> solve(const problem<V>& p, answer<V>& a) {
  const spring_problem<V>& s = p.spring;
  const mask_of<V> is_apart = (p.c1 == 0.0) & (p.c2 == 0.0) & (p.a.a12 == 0.0) & (p.a.a11 == p.a.a22);
  mask_of<V> left = (!is_apart) & (p.friction > 0.0);
  a = {0.0, 0.0, 0.0, 0.0, V(status::closed.code)};
  if (any(!left)) normal_spring<V, true>{s}.solve(a.normal, a.indentation);
  if (!any(left)) return left;
  const mask_of<V> linear = left & (s.exponent == 1.0) & (s.stiffness < infinity);
  const mask_of<V> loses = (s.lead != 0.0) | (s.damping != 0.0) | (s.stiffness == 0.0);
  const mask_of<V> hertz = left & (s.exponent == 1.5) & (s.stiffness < infinity);
  solve_regular<true, false>(p, linear & !loses, a, left);
  solve_regular<true, true>(p, linear & loses, a, left);
  solve_regular<false, true>(p, hertz, a, left);
  return left;
}

// ---- the scalar fallback: strong coupling, ill-conditioned H, extreme numbers, any exponent, rigid springs -----------

class scalar_friction {
 public:
  explicit scalar_friction(const problem<double>& p)
      : p_(p), s_(p.spring), is_rigid_(s_.stiffness == infinity), spring_{p.spring} {}

  answer<double> solve() const {
    if (is_rigid_) {  // no impulse to find: Coulomb's local problem as it is
      const double q = 0.5 * (s_.free + given_back());
      const answer<double> whole =
          coulomb({{0.5 * s_.delassus, p_.a.a11, p_.a.a22, 0.5 * p_.c1, 0.5 * p_.c2, p_.a.a12}, {q, p_.q1, p_.q2}, {}});
      if (whole.status != no_solution && !pushes_on(p_, whole.t1, whole.t2)) return whole;
    }
    double normal = 0.0, end = 0.0;
    const bool couples = p_.c1 != 0.0 || p_.c2 != 0.0;
    if (couples)
      normal = spring_.impulse_where(true, [this](double r) { return excess(free_with(rub(r)), r); });
    else
      spring_.solve(normal, end);
    answer<double> a = rub(normal);
    a.indentation = couples && !is_rigid_ ? spring_.end_with(normal, free_with(a)) : end;
    if (!is_finite(normal)) a.status = no_solution;
    return a;
  }

 private:
  answer<double> coulomb(local_coulomb problem) const {
    problem.mu[0] = problem.mu[1] = p_.friction;
    double r[3];
    const contact_mode mode = ilaw::kit::solve(problem, r);
    const double code = (mode == contact_mode::stick ? status::stick : status::slip).code;
    return {r[0], r[1], r[2], 0.0, mode == contact_mode::none ? no_solution : code};
  }
  // The tangents with a normal impulse that is known, for one e_T: without coupling, the tangential spring an inverse
  // mass beside H. A convex problem.
  answer<double> rub(double normal, double e_t) const {
    const double q1 = p_.q1 + 0.5 * e_t * p_.before1 + 0.5 * p_.c1 * normal;
    const double q2 = p_.q2 + 0.5 * e_t * p_.before2 + 0.5 * p_.c2 * normal, h = 0.5 * s_.delassus;
    answer<double> a = coulomb({{h, p_.a.a11, p_.a.a22, 0.0, 0.0, p_.a.a12}, {-h * normal, q1, q2}, {}});
    a.normal = normal;
    return a;
  }
  // With an impulse across v_T^- alone, along the unit vector n.
  answer<double> rub_across(double normal) const {
    const double speed = length(p_.before1, p_.before2), n1 = 0.0 - p_.before2 / speed, n2 = p_.before1 / speed;
    const double b = n1 * (p_.q1 + 0.5 * p_.c1 * normal) + n2 * (p_.q2 + 0.5 * p_.c2 * normal);
    const double a = n1 * p_.a.row_1(n1, n2) + n2 * p_.a.row_2(n1, n2), limit = friction_limit(p_.friction, normal);
    const bool slides = slips(absolute(b), limit * a);
    const double t = slides ? (b > 0.0 ? -limit : limit) : -b / a;
    return {normal, n1 * t, n2 * t, 0.0, (slides ? status::slip : status::stick).code};
  }
  // A rigid stick puts nothing in: r_T.v_T^- <= 0 where e_T = 0, >= 0 where e_T = 1, and 0 between.
  answer<double> rub(double normal) const {
    const answer<double> stopped = rub(normal, 0.0);
    if (!pushes_on(p_, stopped.t1, stopped.t2)) return stopped;
    const answer<double> reversed = rub(normal, 1.0);
    return pushes_on(p_, reversed.t1, reversed.t2) ? reversed : rub_across(normal);
  }

  double free_with(const answer<double>& a) const { return s_.free + p_.c1 * a.t1 + p_.c2 * a.t2; }
  // -v_N of a rigid spring after the impact: e v_N^- of a node that arrives.
  double given_back() const {
    return (s_.previous < 0.0 ? (0.5 - s_.lead) / (0.5 + s_.lead) : 1.0) * s_.previous;
  }
  // What the spring gives less r_N.
  double excess(double free, double normal) const {
    const double v = free + s_.delassus * normal;
    return is_rigid_ ? 0.0 - (v + given_back()) / s_.delassus : spring_.given(v) - normal;
  }

  const problem<double>& p_;
  const spring_problem<double>& s_;
  const bool is_rigid_;
  normal_spring<double, true> spring_;
};

}  // namespace penalty_law
