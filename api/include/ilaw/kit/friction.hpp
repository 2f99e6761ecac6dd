// friction.hpp - Signorini-Moreau contact with Coulomb friction at one node, shared by all laws that need it.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit/contact.hpp>
#include <ilaw/kit/local_coulomb.hpp>
#include <ilaw/kit/node.hpp>

#include <type_traits>

namespace ilaw::kit::inline ILAW_KIT_LEVEL {

// Largest tangential impulse that friction can give: mu r_N, zero without pressure also when mu is infinite.
constexpr double friction_limit(double friction, double normal_impulse) {
  return normal_impulse > 0.0 ? friction * normal_impulse : 0.0;
}

// What a contact with friction is asked: 0 <= q_N + (H r)_N _|_ r_N >= 0 and Coulomb's law for q + H r, where
// slack <= 0; r = 0 elsewhere. rest = v_free + v^- - q, so that the work of r is r.(q + H r + rest)/2.
template <class Vector>
struct contact_problem {
  double slack;
  Vector q, rest;
};

// For v_free as given, which may contain what other impulses of the step have done. Tangential restitution is
// the part of v_T^- that a sticking contact reverses.
template <class Vector>
contact_problem<Vector> contact_problem_of(contact_condition condition, Vector v_free, Vector v_previous,
                                           double tangential_restitution = 0.0) {
  auto q = v_free + tangential_restitution * v_previous;
  auto rest = (1.0 - tangential_restitution) * v_previous;
  q.n = condition.excess;
  rest.n = condition.rest;
  return {condition.slack, q, rest};
}

// A number in [0, 1], not yet divided.
struct fraction {
  double over = 1.0, under = 1.0;
};

// The largest s in [0, 1] with c2 s^2 + c1 s + c0 <= 0, where c0 <= 0 <= c2 and that does not hold at 1;
// without cancellation.
inline fraction root_of_work(double c2, double c1, double c0) {
  const double root = square_root(c1 * c1 - 4.0 * c2 * c0);
  return {c1 <= 0.0 ? root - c1 : -2.0 * c0, c1 <= 0.0 ? 2.0 * c2 : root + c1};
}

// A part that rounding cannot tell from 1: the contact sticks.
inline constexpr double sticking_part = 1.0 - 0x1p-46;

// What of the impulse -q_T/h_T, which stops the slip, may act: with the part s the work of the whole impulse,
// times 2 h_T, is s^2 q_T^2 - s q_T.(q_T + rest_T) + h_T r_N rest_N, and must not be positive. Less than 1
// only where the motion turned round within the step, as it does on a stiff spring, and the impact takes less
// than it costs to stop that from behind.
template <class Delassus, class Vector>
fraction stopping_part(const Delassus& delassus, double normal, Vector q, double speed, Vector rest) {
  const double down = power_scale_of(speed).down;  // without overflow or underflow on the way
  const double along = tangential_product(down * q, down * rest), square = (down * speed) * (down * speed);
  const double impact = delassus.tangential() * (down * normal) * (down * rest.n);
  const fraction part = root_of_work(square, -(square + along), impact);
  const bool gains = along < impact;
  const bool far = part.under == infinity;  // v^- is so much larger than q that nothing is left
  return {gains ? (far ? 0.0 : part.over) : 1.0, (gains & !far) ? part.under : 1.0};
}

template <class Vector>
struct friction_result {
  Vector impulse;
  bool slips;
};

// The tangential impulse along q_T: the part of -q_T/h_T that may act, scaled back to the cone.
template <class Delassus, class Vector>
friction_result<Vector> rub(const Delassus& delassus, double normal, Vector q, double speed, fraction part,
                            double friction) {
  const double limit = friction_limit(friction, normal), under = delassus.tangential() * part.under;
  const bool slips = speed * part.over > limit * under;
  const double factor = (slips ? limit : part.over) / (slips ? speed : under);
  const bool moves = slips | (part.over < sticking_part * part.under);
  friction_result<Vector> result{-factor * q, moves};
  result.impulse.n = normal;
  return result;
}

// Solves q + H r = u, 0 <= u_N _|_ r_N >= 0, |r_T| <= mu r_N with r_T opposite to u_T where u_T != 0,
// in closed form for H = diag(h_N, h_T, h_T): the normal row stands alone (Signorini), and the slip u_T is
// parallel to q_T, so that sliding scales the sticking impulse back to the cone (de Saxce and Feng 1991).
// Where slack > 0 the contact is open and r = 0.
template <class Delassus, class Vector>
friction_result<Vector> solve_contact_friction(const Delassus& delassus, double slack, Vector q,
                                               double friction) {
  const double normal = slack <= 0.0 ? positive_part(-q.n / delassus.normal()) : 0.0;
  return rub(delassus, normal, q, q.tangential_length(), {}, friction);
}

// The same, without positive work.
template <class Delassus, class Vector>
friction_result<Vector> solve_contact_friction(const Delassus& delassus,
                                               const contact_problem<Vector>& contact, double friction) {
  const auto& [slack, q, rest] = contact;
  const double normal = slack <= 0.0 ? positive_part(-q.n / delassus.normal()) : 0.0;
  const double speed = q.tangential_length();
  return rub(delassus, normal, q, speed, stopping_part(delassus, normal, q, speed, rest), friction);
}

// The entries of H in the order of local_coulomb, and whether the closed form above holds: without coupling,
// and with one tangential entry or one tangential velocity.
inline local_coulomb problem_of(const scalar_delassus& h) {
  return {.h = {h.h, h.h, h.h}, .q = {}, .mu = {}};
}
inline local_coulomb problem_of(const diagonal_delassus& h) {
  return {.h = {h.n, h.t1, h.t2}, .q = {}, .mu = {}};
}
inline local_coulomb problem_of(const full_delassus& h) {
  return {.h = {h.nn, h.t11, h.t22, h.n1, h.n2, h.t12}, .q = {}, .mu = {}};
}
template <class Vector>
bool has_closed_form(const scalar_delassus&, Vector) {
  return true;
}
inline bool has_closed_form(const diagonal_delassus& h, vector q) { return h.t1 == h.t2 || q.t2 == 0.0; }
inline bool has_closed_form(const full_delassus& h, vector) { return h.anisotropy() == 0.0; }

// Gives the node its impulse and status, by the closed form.
template <class Node, class Vector>
void apply_isotropic_friction(Node& node, const contact_problem<Vector>& problem, double friction) {
  const auto result = solve_contact_friction(node.delassus, problem, friction);
  node.impulse = result.impulse;
  const double closed_status = result.slips ? status::slip : status::stick;
  node.status = result.impulse.n > 0.0 ? closed_status : status::free;
}

// The same by the local problem, which may be of any H.
template <class Node>
void apply_local_coulomb(Node& node, double slack, const local_coulomb& problem) {
  double r[3] = {};
  const contact_mode mode = slack <= 0.0 ? solve(problem, r) : contact_mode::free;
  node.impulse = {r[0], r[1], r[2]};
  node.status = mode == contact_mode::slip    ? status::slip
                : mode == contact_mode::stick ? status::stick
                                              : status::free;
  node.refused = mode == contact_mode::none ? no_solution : not_refused;
}

// The largest part s <= 1 of an impulse r whose work s r.(a + s H r)/2 is not positive.
inline double dissipative_part(double r_a, double r_Hr) {
  return r_a + r_Hr > 0.0 ? positive_part(-r_a / r_Hr) : 1.0;
}

// Takes the positive work off a solution for any H, whose work is r.(rest + u)/2 with u_N = 0, r_T.u_T <= 0.
// With the part s of r_T alone it is that of c2 s^2 + c1 s + c0; the largest part without positive work is
// that of the closed form where H does not couple. Where it does, c0 > 0 may be left, and the whole impulse
// is scaled. Neither leaves the cone.
template <class Node>
void take_off_positive_work(Node& node, vector q, vector rest) {
  vector& r = node.impulse;
  const vector slid{0.0, r.t1, r.t2}, h_slid = node.delassus.times(slid), h_r = node.delassus.times(r);
  const double slip = node.status == status::stick ? 0.0 : smaller(tangential_product(r, q + h_r), 0.0);
  const double work = r.n * rest.n + tangential_product(r, rest) + slip;
  if (!(work > 0.0)) return;
  const double c2 = tangential_product(slid, h_slid), c0 = r.n * (rest.n - h_slid.n), c1 = work - c0 - c2;
  const fraction root = root_of_work(c2, c1, smaller(c0, 0.0));
  const double part = root.over < root.under ? root.over / root.under : 1.0;
  r.t1 *= part;
  r.t2 *= part;
  const vector a = q + rest, h_all = node.delassus.times(r);
  const double whole = dissipative_part(normal_product(r, a) + tangential_product(r, a),
                                        normal_product(r, h_all) + tangential_product(r, h_all));
  r = whole * r;
  if (part * whole < sticking_part) node.status = r.n > 0.0 ? status::slip : status::free;
}

// The impulse that stops the node, r = -H^-1 v_free, without positive work r.v^-/2: all of it unless the node
// was moving before, and turned round within the step.
template <class Node>
vector stopping_impulse(Node node) {
  node.impulse = -node.delassus.solve(node.v_free);
  node.status = status::stick;
  take_off_positive_work(node, node.v_free, node.v_previous);
  return node.impulse;
}

// For an ellipse of coefficients along the tangents.
template <class Node>
void apply_any_friction(Node& node, const contact_problem<vector>& contact, double friction_1,
                        double friction_2) {
  local_coulomb problem = problem_of(node.delassus);
  problem.q[0] = contact.q.n;
  problem.q[1] = contact.q.t1;
  problem.q[2] = contact.q.t2;
  problem.mu[0] = friction_1;
  problem.mu[1] = friction_2;
  apply_local_coulomb(node, contact.slack, problem);
  take_off_positive_work(node, contact.q, contact.rest);
}

// Contact with friction, by the closed form where it holds.
template <class Node, class Vector>
void apply_contact_friction(Node& node, const contact_problem<Vector>& contact, double friction) {
  if constexpr (std::is_same_v<decltype(node.delassus), scalar_delassus>)
    apply_isotropic_friction(node, contact, friction);
  else if (has_closed_form(node.delassus, contact.q))
    apply_isotropic_friction(node, contact, friction);
  else
    apply_any_friction(node, contact, friction, friction);
}

// With two coefficients; a vector without tangents knows only the first.
template <class Node, class Vector>
void apply_contact_friction(Node& node, const contact_problem<Vector>& contact, double friction_1,
                            double friction_2) {
  if constexpr (std::is_same_v<Vector, vector>)
    if (friction_1 != friction_2) return apply_any_friction(node, contact, friction_1, friction_2);
  apply_contact_friction(node, contact, friction_1);
}

// Contact and friction where the gap is closed and nothing rebounds: what is left of a bond.
template <class Node, class Vector>
void apply_plain_contact(Node& node, Vector v_free, double friction) {
  const contact_condition condition = contact_leaving_at(0.0, node.gap, v_free.n, node.v_previous.n);
  apply_contact_friction(node, contact_problem_of(condition, v_free, node.v_previous), friction);
}

}  // namespace ilaw::kit
