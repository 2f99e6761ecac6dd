// rubbing.hpp - normal spring and friction where H couples them, for a node or a pack of them. What sticks
// has r_T = -A^-1 (q + c r_N/2), which leaves a normal spring with
//
//     v_free' = v_free - c.A^-1 q,    H' = H_NN - c.A^-1 c/2.
//
// What slides along a unit vector e has r_T = -mu r_N e, and a normal spring with H' = H_NN - mu c.e; that
// the slip is along e is one equation for its angle. penalty.md derives it. What is not regular is left to
// the solvers of alone.hpp.
#pragma once

#include "compression.hpp"

#include <ilaw/kit/friction.hpp>

namespace penalty_law {

template <class V>
struct rubbing {
  V step;                                   // the same in all lanes
  V free, previous, delassus, indentation;  // as compression has them
  V c1, c2;                                 // what H couples the tangents to the normal by
  V a11, a22, a12;  // A = H_T/2 + 2/(h^2 k_T); zero where the normal spring alone is asked for
  V q1, q2;         // q + c r_N/2 + A r_T is the mean velocity of what slips
};
// What an H that couples the tangents makes of the spring in them, whose softness is 2/(h^2 k_T).
template <class Delassus>
void couple(rubbing<double>& open, const Delassus& delassus, kit::vector q, double softness) {
  kit::local_coulomb entries{};
  fill(entries, delassus);
  open.c1 = entries.h[3];
  open.c2 = entries.h[4];
  open.a11 = 0.5 * entries.h[1] + softness;
  open.a22 = 0.5 * entries.h[2] + softness;
  open.a12 = 0.5 * entries.h[5];
  open.q1 = q.t1;
  open.q2 = q.t2;
}
// With a rigid tangential spring, which sticks at -e_T v_T^-; q is that of e_T = 0.
template <class V>
struct rigid_rubbing : rubbing<V> {
  V before1, before2;  // v_T^-; zero where the spring is soft
};
template <class V>
struct rubbed {
  V impulse, t1, t2, indentation, outcome;
};
// Lanes without coupling and with one tangential entry have a closed form, that of a scalar H.
template <class V>
auto is_like_scalar(const rubbing<V>& p) {
  return (p.c1 == 0.0) & (p.c2 == 0.0) & (p.a12 == 0.0) & (p.a11 == p.a22);
}
// Whether r_T pushes along v_T^-, by more than rounding leaves of a velocity that was stopped.
template <class V>
auto pushes_on(const rigid_rubbing<V>& p, V t1, V t2, V down = 1.0) {
  constexpr double rounding = 0x1p-44;
  const V r1 = down * t1, r2 = down * t2;
  return r1 * p.before1 + r2 * p.before2 > rounding * (p.a11 + p.a22) * (r1 * t1 + r2 * t2);
}
// The normal spring alone.
template <class V>
struct pressing {
  V step, free, previous, delassus, indentation;
  operator rubbing<V>() const {
    return {step, free, previous, delassus, indentation, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0};
  }
};
template <class V>
struct pressed {
  V impulse, indentation;
};
// False where a plain spring that is not without stiffness gives nothing: it would not push in the free step.
template <bool IsPlain, class Problem>
auto may_push(const Problem& p) {
  if constexpr (IsPlain)
    return (p.indentation > 0.0) | (p.free + p.previous < 0.0);
  else
    return true;
}
// Outcomes.
inline constexpr double sticks = 0.0, slides = 1.0, has_none = 2.0;

inline double first_of(double x) { return x; }
inline double first_of(kit::pack x) { return x[0]; }

// IsLinear: p = 1, else 3/2. IsPlain: see compression.
template <class V, bool IsLinear, bool IsPlain>
class rubbing_node {
 public:
  using Mask = kit::mask_of<V>;

  rubbing_node(const normal_spring& spring, double friction, const rubbing<V>& p)
      : p_(p),
        friction_(friction),
        normal_{spring, p.free, p.previous, p.delassus, p.indentation, {}},
        trace_(p.a11 + p.a22) {
    if constexpr (!IsPlain) normal_.damping = spring.damper(p.delassus);
  }

  // The normal spring alone. Returns the lanes that it did not solve. Flat, as below: a pack that is passed
  // to a function goes through memory.
  [[gnu::flatten]] Mask press(rubbed<V>& a) const {
    const auto found = respond(V(1.0), p_.free, p_.delassus);
    a = {found.impulse, V(0.0), V(0.0), next(found, p_.free), V(sticks)};
    return !((found.impulse < kit::infinity) & has_usual_scales(p_.delassus));
  }

  // With friction.
  [[gnu::flatten]] Mask solve(rubbed<V>& a) const {
    const Mask pushes = this->pushes();
    trial stuck;
    work_out(stuck);
    const V held = friction_ * stuck.held(), none = 0.0;
    const Mask holds = stuck.length <= held, regular = is_regular(stuck, holds);
    const Mask slips = pushes & regular & !holds;
    slide end{};
    Mask found(false);
    if (kit::any(slips)) found = find_slide(slips, stuck, held, end);
    if (kit::any(pushes & holds)) {
      stay(holds, stuck, end);
      found = found | (holds & regular);
    }
    const V t1 = kit::select(pushes, end.t1, none), t2 = kit::select(pushes, end.t2, none);
    const V r = kit::select(pushes, end.normal.impulse, none), free = p_.free - (p_.c1 * t1 + p_.c2 * t2);
    end.normal.impulse = r;
    a = {r, none - t1, none - t2, end_of(pushes, end.normal, free), kit::select(holds, V(sticks), V(slides))};
    const Mask plain = is_like_scalar(p_), usual = has_usual_scales(p_.a11), is_found = found & (r > 0.0);
    return plain | !usual | (pushes & !is_found);
  }

 private:
  using solution = typename compression<V, IsPlain>::solution;
  static constexpr double close = IsPlain ? 0x1p-26 : 0x1p-40;  // a step so small is the last
  static constexpr double least_determinant = 0x1p-20;
  static constexpr int most_steps = 16;

  solution respond(V scale, V free, V delassus) const {
    if constexpr (IsLinear)
      return normal_.linear(scale, free, delassus);
    else
      return normal_.hertz(scale, free, delassus);
  }
  compression<V, IsPlain> moving_by(V free) const {
    compression<V, IsPlain> moved = normal_;
    moved.free = free;
    return moved;
  }
  V next(const solution& found, V free) const {
    if constexpr (!IsLinear) return found.end;
    return moving_by(free).next(found.impulse, found.opens);
  }
  // x' of all. Of a plain spring as compression has it, but that whether it opens is told by its way.
  V end_of(Mask pushes, const solution& found, V free) const {
    if constexpr (IsPlain) {
      const auto moved = moving_by(free);
      const V r = found.impulse, left = p_.indentation - moved.travel(free + p_.delassus * r);
      const V pressed = 2.0 / (normal_.spring.stiffness * normal_.spring.step) * r - p_.indentation;
      return kit::positive_part(kit::select(moved.is_told_by_force(r) & (left > 0.0), pressed, left));
    } else {
      const V left = kit::positive_part(p_.indentation - normal_.travel(p_.free));
      return kit::select(pushes, next(found, free), left);
    }
  }

  // Whether no product on the way overflows or underflows. What is allowed for H bounds t22, too.
  Mask has_usual_scales(V t11) const {
    constexpr double scale = 0x1p80;
    const double per_step = 1.0 / normal_.spring.step;
    const V speed = kit::absolute(p_.free) + kit::absolute(p_.previous) + kit::absolute(p_.q1) +
                    kit::absolute(p_.q2) + p_.indentation * per_step;
    return (t11 < scale) & (p_.delassus > 1.0 / scale) & (speed > 1.0 / scale) & (speed < scale);
  }
  // Whether the spring pushes in the free step. If not, no impulse is the solution.
  Mask pushes() const {
    if constexpr (IsPlain) return may_push<true>(p_);
    if constexpr (IsLinear) return normal_.linear_pushes();
    return respond(V(1.0), p_.free, p_.delassus).impulse > 0.0;
  }

  // What sticks, without the division by the determinant of A: r_T = -A^-1 b = -(n1, n2)/det.
  struct trial {
    V det, b1, b2, n1, n2, length, condensed, coupling;
    solution normal;
    V held() const { return normal.impulse * det; }
  };
  // In place, since copies of so many packs take as long as what is worked out.
  void work_out(trial& x) const {
    const V a11 = p_.a11, a22 = p_.a22, a12 = p_.a12;
    x.det = a11 * a22 - a12 * a12;
    const V m1 = a22 * p_.c1 - a12 * p_.c2, m2 = a11 * p_.c2 - a12 * p_.c1;
    x.coupling = 0.5 * (p_.c1 * m1 + p_.c2 * m2);
    x.condensed = x.det * p_.delassus - x.coupling;
    x.normal = respond(x.det, x.det * p_.free - (m1 * p_.q1 + m2 * p_.q2), x.condensed);
    const V half = 0.5 * x.normal.impulse;
    x.b1 = p_.q1 + half * p_.c1;
    x.b2 = p_.q2 + half * p_.c2;
    x.n1 = a22 * x.b1 - a12 * x.b2;
    x.n2 = a11 * x.b2 - a12 * x.b1;
    x.length = kit::square_root(x.n1 * x.n1 + x.n2 * x.n2);
  }

  // Weak coupling, also of a rigid spring, and fair condition: |r_T| - mu r_N falls with alpha, by Cauchy and
  // Schwarz, and has one root.
  Mask is_regular(const trial& x, Mask holds) const {
    const double mu = friction_;
    const Mask is_weak = 2.0 * (mu * mu * (trace_ * x.coupling)) < p_.delassus * x.condensed;
    return (holds | is_weak) & (x.det > least_determinant * (p_.a11 * p_.a22)) &
           (x.condensed > least_determinant * (x.det * p_.delassus));
  }

  // Sliding along the unit vector e: r_T = -(t1, t2).
  struct slide {
    V e1, e2, t1, t2;
    solution normal;
  };
  void stay(Mask holds, const trial& stuck, slide& x) const {
    const V inverse = 1.0 / stuck.det;
    x.t1 = kit::select(holds, stuck.n1 * inverse, x.t1);
    x.t2 = kit::select(holds, stuck.n2 * inverse, x.t2);
    x.normal.impulse = kit::select(holds, stuck.normal.impulse, x.normal.impulse);
    if constexpr (IsPlain) return;
    x.normal.opens = kit::select(holds, stuck.normal.opens, x.normal.opens);
    x.normal.end = kit::select(holds, stuck.normal.end, x.normal.end);
  }
  // What motion and normal spring disagree by at an impulse r, and how that changes with r and with v_free.
  // Plain springs by polynomials, which take no division; for others r is found first, and is what agrees.
  struct disagreement {
    V amount, by_impulse, by_speed;
  };
  disagreement compare(V h, solution& normal) const {
    if constexpr (!IsPlain) {
      normal = respond(V(1.0), p_.free, h);
      return {V(0.0), normal.pace, normal.gain};
    } else {
      const double step = normal_.spring.step, k = normal_.spring.stiffness;
      const V r = normal.impulse, x = p_.indentation, v = (p_.free + p_.previous) + h * r;
      // By both, since where x is 0 the open spring's r v = k x^2 has a root at v = 0, too.
      const Mask opens = (0.5 * step * v > x) & (r < 0.5 * step * k * x);
      const V by_speed = kit::select(opens, r, V(0.25 * step * step * k));
      const V given = kit::select(opens, k * x * x, step * k * x - r);
      return {by_speed * v - given, by_speed * h + kit::select(opens, v, V(1.0)), by_speed};
    }
  }
  // Between the directions of what sticks and of its q + c r_N/2, where A would be a multiple of I.
  void start_slide(const trial& stuck, V held, slide& x) const {
    const V lacks = 0.5 * trace_ * (stuck.length - held);
    x.e1 = held * stuck.n1 + lacks * stuck.b1;
    x.e2 = held * stuck.n2 + lacks * stuck.b2;
    const V inverse = 1.0 / kit::square_root(x.e1 * x.e1 + x.e2 * x.e2);
    x.e1 = x.e1 * inverse;
    x.e2 = x.e2 * inverse;
    if constexpr (IsPlain) x.normal = respond(V(1.0), p_.free, slid_delassus(x));
  }
  V slid_delassus(const slide& x) const { return p_.delassus - friction_ * (p_.c1 * x.e1 + p_.c2 * x.e2); }

  // Newton's method for the angle of e, and for r_N where the spring is plain. Lanes that are done keep what
  // they have, so that none sees its neighbours. Says who is done.
  Mask find_slide(Mask active, const trial& stuck, V held, slide& x) const {
    Mask found(false);
    start_slide(stuck, held, x);
    const double mu = friction_;
    const V a11 = mu * p_.a11, a22 = mu * p_.a22, a12 = mu * p_.a12, c1 = mu * p_.c1, c2 = mu * p_.c2;
    for (int k = 0; k < most_steps && kit::any(active); ++k) {
      const V e1 = x.e1, e2 = x.e2, a1 = a11 * e1 + a12 * e2, a2 = a12 * e1 + a22 * e2;
      const V z1 = 0.5 * p_.c1 - a1, z2 = 0.5 * p_.c2 - a2;
      solution normal = x.normal;
      const disagreement spring = compare(p_.delassus - (c1 * e1 + c2 * e2), normal);
      const V r = normal.impulse, y1 = p_.q1 + r * z1, y2 = p_.q2 + r * z2, along = e1 * y1 + e2 * y2;
      const V across = e1 * y2 - e2 * y1, by_impulse = e1 * z2 - e2 * z1;
      const V by_turn = r * ((e1 * a1 + e2 * a2) - (a11 + a22)) - along;
      const V spring_by_turn = spring.by_speed * r * (c1 * e2 - c2 * e1);
      const V inverse = 1.0 / (by_turn * spring.by_impulse - by_impulse * spring_by_turn);
      const V turn = (by_impulse * spring.amount - across * spring.by_impulse) * inverse;
      const V more = (spring_by_turn * across - by_turn * spring.amount) * inverse;
      const V t = kit::larger(kit::smaller(turn, V(0.5)), V(-0.5));
      const V u1 = e1 - t * e2, u2 = e2 + t * e1, square = u1 * u1 + u2 * u2, unit = 1.5 - 0.5 * square;
      x.e1 = kit::select(active, u1 * unit, e1);
      x.e2 = kit::select(active, u2 * unit, e2);
      x.normal.impulse = kit::select(active, kit::larger(r + more, 0.5 * r), x.normal.impulse);
      const Mask turned = kit::absolute(turn) <= close, pressed = kit::absolute(more) <= close * r,
                 is_unit = kit::absolute(square - 1.0) <= 0.25 * close, done = turned & pressed & is_unit;
      found = found | (active & done & (along > 0.0));
      active = active & !done;
    }
    finish(x);
    return found;
  }
  void finish(slide& x) const {
    if constexpr (!IsPlain) x.normal = respond(V(1.0), p_.free, slid_delassus(x));
    const V rubs = friction_ * x.normal.impulse;
    x.t1 = rubs * x.e1;
    x.t2 = rubs * x.e2;
  }

  const rubbing<V>& p_;
  double friction_;
  compression<V, IsPlain> normal_;
  V trace_;
};

// What is asked in pack form. Return the lanes that they did not solve.
template <bool IsLinear, bool IsPlain, class V>
kit::mask_of<V> solve(const normal_spring& spring, double friction, const rubbing<V>& p, rubbed<V>& a) {
  const rubbing_node<V, IsLinear, IsPlain> node(spring, friction, p);
  return friction > 0.0 && kit::any(p.a11 > 0.0) ? node.solve(a) : node.press(a);
}
template <bool IsLinear, bool IsPlain, class V>
kit::mask_of<V> solve(const normal_spring& spring, double friction, const rigid_rubbing<V>& p, rubbed<V>& a) {
  const rubbing<V>& stopped = p;
  const auto left = solve<IsLinear, IsPlain>(spring, friction, stopped, a);
  return left | pushes_on(p, a.t1, a.t2);
}
template <bool IsLinear, bool IsPlain, class V>
kit::mask_of<V> solve(const normal_spring& spring, double friction, const pressing<V>& p, pressed<V>& a) {
  rubbed<V> found;
  const auto left = rubbing_node<V, IsLinear, IsPlain>(spring, friction, p).press(found);
  a = {found.impulse, found.indentation};
  return left;
}

}  // namespace penalty_law
