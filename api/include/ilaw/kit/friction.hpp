// friction.hpp - Signorini-Moreau contact with Coulomb friction at one node, shared by all laws that need it.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit/contact.hpp>
#include <ilaw/kit/local_coulomb.hpp>
#include <ilaw/kit/node.hpp>

#include <type_traits>

namespace ilaw::kit::inline ILAW_KIT_LEVEL {

// Largest tangential impulse that friction can give: mu r_N, zero without pressure also when mu is infinite.
template <class V>
V friction_limit(V friction, V normal_impulse) {
  return select(normal_impulse > 0.0, friction * normal_impulse, V(0.0));
}

// What a contact with friction is asked: 0 <= q_N + (H r)_N _|_ r_N >= 0 and Coulomb's law for q + H r, where
// slack <= 0; r = 0 elsewhere. rest = v_free + v^- - q, so that the work of r is r.(q + H r + rest)/2.
template <class Vector>
struct contact_problem {
  double slack;
  Vector q, rest;
};

// For v_free as given, which may contain what other impulses of the step have done.
template <class Vector>
contact_problem<Vector> contact_problem_of(contact_condition condition, Vector v_free,
                                           std::type_identity_t<Vector> v_previous) {
  v_free.n = condition.excess;
  v_previous.n = condition.rest;
  return {condition.slack, v_free, v_previous};
}
// Tangential restitution is the part of v_T^- that a sticking contact reverses.
template <class Vector>
contact_problem<Vector> contact_problem_of(contact_condition condition, Vector v_free,
                                           std::type_identity_t<Vector> v_previous,
                                           double tangential_restitution) {
  return contact_problem_of(condition, v_free + tangential_restitution * v_previous,
                            (1.0 - tangential_restitution) * v_previous);
}

// A number in [0, 1], not yet divided.
template <class V>
struct fraction {
  V over = 1.0, under = 1.0;
};

// The largest s in [0, 1] with c2 s^2 + c1 s + c0 <= 0, where c0 <= 0 <= c2 and that does not hold at 1;
// without cancellation.
template <class V>
fraction<V> root_of_work(V c2, V c1, V c0) {
  const V root = square_root(c1 * c1 - 4.0 * c2 * c0);
  return {select(c1 <= 0.0, root - c1, -2.0 * c0), select(c1 <= 0.0, 2.0 * c2, root + c1)};
}

// A part that rounding cannot tell from 1: the contact sticks.
inline constexpr double sticking_part = 1.0 - 0x1p-46;

// What of the impulse -q_T/h_T, which stops the slip, may act: with the part s the work of the whole impulse,
// times 2 h_T, is s^2 q_T^2 - s q_T.(q_T + rest_T) + h_T r_N rest_N, and must not be positive. Less than 1
// only where the motion turned round within the step, as it does on a stiff spring, and the impact takes less
// than it costs to stop that from behind.
template <class V>
struct turning {
  // q_T^2, q_T.rest_T, h_T r_N rest_N: against overflow, times a power of two, down, and the first times its
  // square.
  V square, along, impact, down;

  auto gains() const { return along < impact; }
};
template <class V>
turning<V> turning_of(V h_t, V normal, scaled_length<V> speed, V along, V rest_n) {
  return {speed.square, along, h_t * (speed.down * normal) * rest_n, speed.down};
}
template <class V>
fraction<V> stopping_part(turning<V> t) {
  const fraction<V> part = root_of_work(t.square, -(t.square + t.down * t.along), t.down * t.impact);
  const auto gains = t.gains();
  const auto far = part.under == infinity;  // v^- is so much larger than q that nothing is left
  return {select(gains, select(far, V(0.0), part.over), V(1.0)), select(gains & !far, part.under, V(1.0))};
}

// The tangential impulse -factor q_T: the part of -q_T/h_T that may act, scaled back to the cone.
template <class V>
struct rubbing_factor {
  V factor;
  mask_of<V> moves;
  V status;  // where the contact is pressed
};
// speed: down |q_T|.
template <class V>
rubbing_factor<V> rub(V h_t, V normal, V speed, fraction<V> part, V friction, V down) {
  const V limit = down * friction_limit(friction, normal), under = h_t * part.under;
  const auto slips = speed * part.over > limit * under;
  // Before the division, of which GCC would else make two; a choice between numbers, not between truths.
  const auto turns = part.over < sticking_part * part.under;
  const mask_of<V> moves = slips | turns;
  const V held = select(turns, V(status::slip), V(status::stick));
  const V closed = select(slips, V(status::slip), held);
  return {select(slips, limit, part.over) / select(slips, speed, under), moves, closed};
}

// The same without positive work; entry 0 of the vectors is the normal one.
template <class V>
rubbing_factor<V> rub_from(V h_t, V normal, const V* q, const V* rest, V friction) {
  const scaled_length<V> speed = scaled_length_of(q[1], q[2]);
  const V down = speed.down;
  const V along = (down * q[1]) * rest[1] + (down * q[2]) * rest[2];
  const turning<V> turns = turning_of(h_t, normal, speed, along, rest[0]);
  return rub(h_t, normal, speed.root(), stopping_part(turns), friction, down);
}

template <class Vector>
struct friction_result {
  Vector impulse;
  bool slips;
  double status;  // where the contact is pressed
};
// speed: down |q_T|.
template <class Delassus, class Vector>
friction_result<Vector> rub_along(const Delassus& delassus, double normal, Vector q, double speed,
                                  fraction<double> part, double friction, double down = 1.0) {
  const auto found = rub(delassus.tangential(), normal, speed, part, friction, down);
  // From zero, so that what does not rub gets 0, and not -0.
  friction_result<Vector> result{Vector{} - found.factor * q, found.moves, found.status};
  result.impulse.n = normal;
  return result;
}

template <class Delassus, class Vector>
double pressing_impulse(const Delassus& delassus, const contact_problem<Vector>& contact) {
  return contact.slack <= 0.0 ? positive_part(-contact.q.n / delassus.normal()) : 0.0;
}
template <class Delassus, class Vector>
turning<double> turning_at(const Delassus& delassus, double normal, const contact_problem<Vector>& contact,
                           scaled_length<double> speed) {
  const double along = tangential_product(speed.down * contact.q, contact.rest);
  return turning_of(delassus.tangential(), normal, speed, along, contact.rest.n);
}

// Solves q + H r = u, 0 <= u_N _|_ r_N >= 0, |r_T| <= mu r_N with r_T opposite to u_T where u_T != 0,
// in closed form for H = diag(h_N, h_T, h_T): the normal row stands alone (Signorini), and the slip u_T is
// parallel to q_T, so that sliding scales the sticking impulse back to the cone (de Saxce and Feng 1991).
// Of that impulse acts what does no positive work. Where slack > 0 the contact is open and r = 0.
template <class Delassus, class Vector>
friction_result<Vector> solve_contact_friction(const Delassus& delassus,
                                               const contact_problem<Vector>& contact, double friction) {
  const double normal = pressing_impulse(delassus, contact);
  const auto speed = contact.q.scaled_tangential_length();
  const auto part = stopping_part(turning_at(delassus, normal, contact, speed));
  return rub_along(delassus, normal, contact.q, speed.root(), part, friction, speed.down);
}

template <class Node, class Vector>
void give(Node& node, const friction_result<Vector>& result) {
  node.impulse = result.impulse;
  node.status = result.impulse.n > 0.0 ? result.status : status::free;
}

// Gives the node its impulse and status, by the closed form.
template <class Node, class Vector>
void apply_isotropic_friction(Node& node, const contact_problem<Vector>& problem, double friction) {
  give(node, solve_contact_friction(node.delassus, problem, friction));
}

// The same without the root that a motion needs that turned round within the step. False: it did.
template <class Node, class Vector>
bool try_isotropic_friction(Node& node, const contact_problem<Vector>& contact, double friction) {
  const double normal = pressing_impulse(node.delassus, contact);
  const auto speed = contact.q.scaled_tangential_length();
  give(node, rub_along(node.delassus, normal, contact.q, speed.root(), {}, friction, speed.down));
  return !turning_at(node.delassus, normal, contact, speed).gains();
}

// The entries of H in the order of local_problem.
inline void fill(local_coulomb& p, const transverse_delassus& h) {
  p.h[0] = h.n;
  p.h[1] = p.h[2] = h.t;
  p.h[3] = p.h[4] = p.h[5] = 0.0;
}
inline void fill(local_coulomb& p, const diagonal_delassus& h) {
  p.h[0] = h.n;
  p.h[1] = h.t1;
  p.h[2] = h.t2;
  p.h[3] = p.h[4] = p.h[5] = 0.0;
}
inline void fill(local_coulomb& p, const full_delassus& h) {
  p.h[0] = h.nn;
  p.h[1] = h.t11;
  p.h[2] = h.t22;
  p.h[3] = h.n1;
  p.h[4] = h.n2;
  p.h[5] = h.t12;
}

// A pressed contact with any H and coefficients along the tangents, as contact_problem has it, and its
// answer: for one node or a pack of them.
template <class V>
struct friction_problem {
  local_problem<V> contact;
  V rest[3];
};
template <class V>
struct friction_answer {
  V r[3], status, refused;
};

// Number by number: loops in which structs are copied do not vectorise.
template <class Delassus>
void fill(friction_problem<double>& p, const Delassus& delassus, const contact_problem<vector>& contact,
          double friction_1, double friction_2) {
  fill(p.contact, delassus);
  p.contact.q[0] = contact.q.n;
  p.contact.q[1] = contact.q.t1;
  p.contact.q[2] = contact.q.t2;
  p.contact.mu[0] = friction_1;
  p.contact.mu[1] = friction_2;
  p.rest[0] = contact.rest.n;
  p.rest[1] = contact.rest.t1;
  p.rest[2] = contact.rest.t2;
}

// The largest part s <= 1 of an impulse r whose work s r.(a + s H r)/2 is not positive.
template <class V>
V dissipative_part(V r_a, V r_Hr) {
  return select(r_a + r_Hr > 0.0, positive_part(-r_a / r_Hr), 1.0);
}

// Takes the positive work off a solution for any H, whose work is r.(rest + u)/2 with u_N = 0, r_T.u_T <= 0.
// With the part s of r_T alone it is that of c2 s^2 + c1 s + c0; the largest part without positive work is
// that of the closed form where H does not couple. Where it does, c0 > 0 may be left, and the whole impulse
// is scaled. Neither leaves the cone.
template <class V>
void take_off_positive_work(const friction_problem<V>& p, friction_answer<V>& a) {
  const V *h = p.contact.h, *q = p.contact.q, *rest = p.rest;
  V* r = a.r;
  const V slid_n = h[3] * r[1] + h[4] * r[2], slid_1 = h[1] * r[1] + h[5] * r[2],
          slid_2 = h[5] * r[1] + h[2] * r[2];
  const V along = r[1] * (q[1] + (h[3] * r[0] + slid_1)) + r[2] * (q[2] + (h[4] * r[0] + slid_2));
  const V slip = select(a.status == status::stick, 0.0, smaller(along, 0.0));
  const V work = r[0] * rest[0] + (r[1] * rest[1] + r[2] * rest[2]) + slip;
  const auto gains = work > 0.0;
  if (!any(gains)) return;
  const V c2 = r[1] * slid_1 + r[2] * slid_2, c0 = r[0] * (rest[0] - slid_n), c1 = work - c0 - c2;
  const fraction<V> root = root_of_work(c2, c1, smaller(c0, 0.0));
  const V part = select(gains & (root.over < root.under), root.over / root.under, 1.0);
  r[1] = r[1] * part;
  r[2] = r[2] * part;
  const V r_a = r[0] * (q[0] + rest[0]) + (r[1] * (q[1] + rest[1]) + r[2] * (q[2] + rest[2]));
  const V r_n = r[0] * (h[0] * r[0] + h[3] * r[1] + h[4] * r[2]);
  const V r_1 = r[1] * (h[3] * r[0] + h[1] * r[1] + h[5] * r[2]);
  const V r_2 = r[2] * (h[4] * r[0] + h[5] * r[1] + h[2] * r[2]);
  const V whole = select(gains, dissipative_part(r_a, r_n + (r_1 + r_2)), 1.0);
  for (int k = 0; k < 3; ++k) r[k] = r[k] * whole;
  const V moves = select(r[0] > 0.0, V(status::slip), V(status::free));
  a.status = select(part * whole < sticking_part, moves, a.status);
}

// Without coupling, and with one tangential entry or one tangential velocity, the closed form above holds.
template <class V>
mask_of<V> has_closed_form(const local_problem<V>& p) {
  return (p.h[3] == 0.0) & (p.h[4] == 0.0) & (p.h[5] == 0.0) & ((p.h[1] == p.h[2]) | (p.q[2] == 0.0)) &
         (p.mu[0] == p.mu[1]);
}

// The closed form at a pressed contact.
template <class V>
void solve_isotropic(const friction_problem<V>& p, mask_of<V> where, friction_answer<V>& a) {
  const V *h = p.contact.h, *q = p.contact.q;
  const V normal = positive_part(-q[0] / h[0]);
  const rubbing_factor<V> found = rub_from(h[1], normal, q, p.rest, p.contact.mu[0]);
  a.r[0] = select(where, normal, a.r[0]);
  for (int k = 1; k < 3; ++k) a.r[k] = select(where, 0.0 - found.factor * q[k], a.r[k]);
  a.status = select(where, select(normal > 0.0, found.status, V(status::free)), a.status);
}

// Solves what is regular or has a closed form; says which are left to solve_friction_alone.
template <class V>
mask_of<V> solve_friction(const friction_problem<V>& p, friction_answer<V>& a) {
  const local::regular_answer<V> found = solve_regular(p.contact);
  for (int k = 0; k < 3; ++k) a.r[k] = found.r[k];
  a.status = select(found.sticks, V(status::stick), V(status::slip));
  a.refused = not_refused;
  take_off_positive_work(p, a);
  const mask_of<V> closed = has_closed_form(p.contact);
  if (any(closed)) solve_isotropic(p, closed, a);
  return !(found.found | closed);
}

[[gnu::noinline]] inline void solve_friction_alone(const friction_problem<double>& p,
                                                   friction_answer<double>& a) {
  a = {};
  const contact_mode mode = solve_pressed(p.contact, a.r);
  a.status = mode == contact_mode::slip ? status::slip : status::stick;
  if (mode == contact_mode::none) a.status = status::free;
  a.refused = mode == contact_mode::none ? no_solution : not_refused;
  take_off_positive_work(p, a);
}

// What of it is asked at a node: nothing where the contact is open, or, with one coefficient, where H is
// transverse.
template <class Node, class Vector>
bool ask_friction(Node& node, const contact_problem<Vector>& contact, double friction_1, double friction_2,
                  friction_problem<double>& problem) {
  fill(problem, node.delassus, contact, friction_1, friction_2);
  node.impulse = {};
  node.status = status::free;
  return (contact.slack <= 0.0) & (contact.q.n < 0.0);
}
template <class Node, class Vector>
bool ask_friction(Node& node, const contact_problem<Vector>& contact, double friction,
                  friction_problem<double>& problem) {
  if constexpr (has_transverse_delassus<Node>) {
    fill(problem, node.delassus, contact, friction, friction);
    apply_isotropic_friction(node, contact, friction);
    return false;
  } else {
    return ask_friction(node, contact, friction, friction, problem);
  }
}

template <class Node>
void give_friction(Node& node, const friction_answer<double>& a) {
  node.impulse = {a.r[0], a.r[1], a.r[2]};
  node.status = a.status;
  node.refused = larger(node.refused, a.refused);
}

// What makes a law whose only problem is friction one in pack form: it has but to ask.
struct friction_in_packs {
  template <class V>
  using problem = friction_problem<V>;
  template <class V>
  using answer = friction_answer<V>;

  template <class V>
  static mask_of<V> solve(const friction_problem<V>& p, friction_answer<V>& a) {
    return solve_friction(p, a);
  }
  static void solve_alone(const friction_problem<double>& p, friction_answer<double>& a) {
    solve_friction_alone(p, a);
  }
  template <class Node>
  void answered(Node& node, const friction_answer<double>& a) const {
    give_friction(node, a);
  }
};

// The same for a node on its own.
template <class Node>
void apply_any_friction(Node& node, const contact_problem<vector>& contact, double friction_1,
                        double friction_2) {
  friction_problem<double> problem;
  if (!ask_friction(node, contact, friction_1, friction_2, problem)) return;
  friction_answer<double> answer;
  if (solve_friction(problem, answer)) solve_friction_alone(problem, answer);
  give_friction(node, answer);
}

// Contact with friction, by the closed form where it holds.
template <class Node, class Vector>
void apply_contact_friction(Node& node, const contact_problem<Vector>& contact, double friction) {
  if constexpr (has_transverse_delassus<Node>)
    apply_isotropic_friction(node, contact, friction);
  else
    apply_any_friction(node, contact, friction, friction);
}

}  // namespace ilaw::kit
