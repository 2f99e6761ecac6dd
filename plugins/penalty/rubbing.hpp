// rubbing.hpp - normal spring and friction where H couples them, for a node or a pack of them. Sliding with
// the multiplier alpha, (A + alpha I) r_T = -(q + c r_N/2), makes the normal spring one with
//
//     v_free' = v_free - c.(A + alpha I)^-1 q,    H' = H_NN - c.(A + alpha I)^-1 c/2,
//
// whose impulse has its closed form (compression.hpp): |r_T| = mu r_N is one equation for alpha, and sticking
// is alpha = 0. penalty.md derives it. What is not regular is left to the solvers of alone.hpp.
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
template <class V>
struct rubbed {
  V impulse, t1, t2, indentation, outcome;
};
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
    return !((found.impulse < kit::infinity) & has_usual_scales(p_.delassus, p_.delassus));
  }

  // With friction.
  [[gnu::flatten]] Mask solve(rubbed<V>& a) const {
    const Mask pushes = this->pushes();
    trial end;
    work_out(0.0, end);
    const Mask holds = end.length <= friction_ * end.held();
    const Mask regular = is_regular(end, holds);
    find_multiplier(pushes & regular & !holds, end);
    const V over = kit::select(holds, V(1.0), friction_ * end.normal.impulse);
    const V factor = kit::select(pushes, over / kit::select(holds, end.det, end.length), V(0.0));
    const V r = kit::select(pushes, end.normal.impulse, V(0.0));
    const V t1 = -end.n1 * factor, t2 = -end.n2 * factor;
    const V free = p_.free + (p_.c1 * t1 + p_.c2 * t2);
    const V moved = kit::positive_part(p_.indentation - normal_.travel(p_.free));
    const V indentation = kit::select(pushes, next(end.normal, free), moved);
    a = {r, t1, t2, indentation, kit::select(holds, V(sticks), V(slides))};
    const Mask is_met = meets(end), plain = is_plain(), usual = has_usual_scales(p_.a11, p_.a22);
    const Mask found = (holds | is_met) & regular & (r > 0.0);
    return plain | !usual | (pushes & !found);
  }

 private:
  using solution = typename compression<V, IsPlain>::solution;
  static constexpr double tolerance = 0x1p-46, least_determinant = 0x1p-20;
  static constexpr int most_steps = 16;

  solution respond(V scale, V free, V delassus) const {
    if constexpr (IsLinear)
      return normal_.linear(scale, free, delassus);
    else
      return normal_.hertz(scale, free, delassus);
  }
  V next(const solution& found, V free) const {
    if constexpr (!IsLinear) return found.end;
    compression<V, IsPlain> moved = normal_;
    moved.free = free;
    return moved.next(found.impulse, found.opens);
  }

  // Lanes without coupling and with one tangential entry have a closed form, that of a scalar H.
  Mask is_plain() const { return (p_.c1 == 0.0) & (p_.c2 == 0.0) & (p_.a12 == 0.0) & (p_.a11 == p_.a22); }
  // Whether no product on the way overflows or underflows.
  Mask has_usual_scales(V t11, V t22) const {
    constexpr double scale = 0x1p80;
    const V least = kit::smaller(kit::smaller(t11, t22), p_.delassus);
    const V most = kit::larger(kit::larger(t11, t22), p_.delassus);
    const V speed = kit::absolute(p_.free) + kit::absolute(p_.previous) + kit::absolute(p_.q1) +
                    kit::absolute(p_.q2) + p_.indentation / normal_.spring.step;
    return (least > 1.0 / scale) & (most < scale) & (speed > 1.0 / scale) & (speed < scale);
  }
  // Whether the spring pushes in the free step. If not, no impulse is the solution.
  Mask pushes() const {
    if constexpr (IsLinear) return normal_.linear_pushes();
    return respond(V(1.0), p_.free, p_.delassus).impulse > 0.0;
  }

  // All without their division by the determinant: r_T = -(n1, n2)/det.
  struct trial {
    V det, s11, s22, n1, n2, length, condensed, coupling;
    solution normal;
    V held() const { return normal.impulse * det; }
  };
  // In place, since copies of so many packs take as long as what is worked out.
  void work_out(V alpha, trial& x) const {
    const V a12 = p_.a12;
    x.s11 = p_.a11 + alpha;
    x.s22 = p_.a22 + alpha;
    x.det = x.s11 * x.s22 - a12 * a12;
    const V g1 = x.s22 * p_.q1 - a12 * p_.q2, g2 = x.s11 * p_.q2 - a12 * p_.q1;
    const V m1 = x.s22 * p_.c1 - a12 * p_.c2, m2 = x.s11 * p_.c2 - a12 * p_.c1;
    x.coupling = 0.5 * (p_.c1 * m1 + p_.c2 * m2);
    x.condensed = x.det * p_.delassus - x.coupling;
    x.normal = respond(x.det, x.det * p_.free - (p_.c1 * g1 + p_.c2 * g2), x.condensed);
    const V half = 0.5 * x.normal.impulse;
    x.n1 = g1 + half * m1;
    x.n2 = g2 + half * m2;
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

  // Whether |r_T| is mu r_N.
  Mask meets(const trial& x) const {
    const V held = friction_ * x.held();
    return kit::absolute(x.length - held) <= tolerance * held;
  }

  // Newton's method from alpha = 0 on 1/need = 1/n, where need = |r_T|/mu + w.r_T, n = r_N + w.r_T, and w is
  // what the spring, as it stands, makes of c: linear in alpha where A is a multiple of I and the spring is
  // linear. Lanes that are done keep their alpha, so that none sees its neighbours.
  void find_multiplier(Mask active, trial& x) const {
    V alpha = 0.0;
    for (int k = 0; k < most_steps && kit::any(active); ++k) {
      const double mu = friction_;
      const V gain = x.normal.gain, pace = x.normal.pace, held = mu * x.held();
      const V y1 = x.s22 * x.n1 - p_.a12 * x.n2, y2 = x.s11 * x.n2 - p_.a12 * x.n1;
      const V bends = gain * (p_.c1 * y1 + p_.c2 * y2), excess = x.length - held;
      const V slope = (x.n1 * y1 + x.n2 * y2) * pace +
                      bends * (0.5 * (p_.c1 * y1 + p_.c2 * y2) - mu * (x.det * x.length));
      const V whole = pace + gain * x.coupling, lifted = mu * x.det * gain * (p_.c1 * x.n1 + p_.c2 * x.n2);
      const V target = held * whole - lifted;
      const Mask bounded = target > 0.0;
      const V over = kit::select(bounded, x.length * whole - lifted, V(1.0));
      const V step = excess * x.det * x.length * pace * over / (slope * kit::select(bounded, target, V(1.0)));
      alpha = kit::select(active, kit::positive_part(alpha + step), alpha);
      work_out(alpha, x);
      active = active & !meets(x);
    }
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
kit::mask_of<V> solve(const normal_spring& spring, double friction, const pressing<V>& p, pressed<V>& a) {
  rubbed<V> found;
  const auto left = rubbing_node<V, IsLinear, IsPlain>(spring, friction, p).press(found);
  a = {found.impulse, found.indentation};
  return left;
}

}  // namespace penalty_law
