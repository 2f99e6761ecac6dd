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

template <class Vector>
struct friction_result {
  Vector impulse;
  bool slips;
};

// Solves q + H r = u, 0 <= u_N _|_ r_N >= 0, |r_T| <= mu r_N with r_T opposite to u_T where u_T != 0,
// in closed form for H = diag(h_N, h_T, h_T): the normal row stands alone (Signorini), and the slip u_T is
// parallel to q_T, so that sliding scales the sticking impulse back to the cone (de Saxce and Feng 1991).
// Where slack > 0 the contact is open and r = 0.
template <class Delassus, class Vector>
friction_result<Vector> solve_contact_friction(const Delassus& delassus, double slack, Vector q,
                                               double friction) {
  const double normal = slack <= 0.0 ? positive_part(-q.n / delassus.normal()) : 0.0;
  const double limit = friction_limit(friction, normal);
  const double speed = q.tangential_length();
  const bool slips = speed > limit * delassus.tangential();
  const double factor = (slips ? limit : 1.0) / (slips ? speed : delassus.tangential());
  friction_result<Vector> result{-factor * q, slips};
  result.impulse.n = normal;
  return result;
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
void apply_isotropic_friction(Node& node, double slack, Vector q, double friction) {
  const auto result = solve_contact_friction(node.delassus, slack, q, friction);
  node.impulse = result.impulse;
  const double closed_status = result.slips ? double{ILAW_SLIP} : double{ILAW_STICK};
  node.status = result.impulse.n > 0.0 ? closed_status : double{ILAW_FREE};
}

// The same by the local problem, which may be of any H.
template <class Node>
void apply_local_coulomb(Node& node, double slack, const local_coulomb& problem) {
  double r[3] = {};
  const contact_mode mode = slack <= 0.0 ? solve(problem, r) : contact_mode::free;
  node.impulse = {r[0], r[1], r[2]};
  node.status = mode == contact_mode::slip    ? double{ILAW_SLIP}
                : mode == contact_mode::stick ? double{ILAW_STICK}
                                              : double{ILAW_FREE};
  node.refused = mode == contact_mode::none ? no_solution : not_refused;
}

// For an ellipse of coefficients along the tangents.
template <class Node>
void apply_any_friction(Node& node, double slack, vector q, double friction_1, double friction_2) {
  local_coulomb problem = problem_of(node.delassus);
  problem.q[0] = q.n;
  problem.q[1] = q.t1;
  problem.q[2] = q.t2;
  problem.mu[0] = friction_1;
  problem.mu[1] = friction_2;
  apply_local_coulomb(node, slack, problem);
}

// Contact with friction, by the closed form where it holds.
template <class Node, class Vector>
void apply_contact_friction(Node& node, double slack, Vector q, double friction) {
  if constexpr (std::is_same_v<decltype(node.delassus), scalar_delassus>)
    apply_isotropic_friction(node, slack, q, friction);
  else if (has_closed_form(node.delassus, q))
    apply_isotropic_friction(node, slack, q, friction);
  else
    apply_any_friction(node, slack, q, friction, friction);
}

// With two coefficients; a vector without tangents knows only the first.
template <class Node, class Vector>
void apply_contact_friction(Node& node, double slack, Vector q, double friction_1, double friction_2) {
  if constexpr (std::is_same_v<Vector, vector>)
    if (friction_1 != friction_2) return apply_any_friction(node, slack, q, friction_1, friction_2);
  apply_contact_friction(node, slack, q, friction_1);
}

}  // namespace ilaw::kit
