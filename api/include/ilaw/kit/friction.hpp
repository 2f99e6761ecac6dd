// friction.hpp - Signorini-Moreau contact with Coulomb friction at one node, shared by all laws that need it.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit/contact.hpp>
#include <ilaw/kit/node.hpp>

namespace ilaw::kit {

// Largest tangential impulse that friction can give: mu r_N, zero without pressure also when mu is infinite.
constexpr double friction_limit(double friction, double normal_impulse) {
  return normal_impulse > 0.0 ? friction * normal_impulse : 0.0;
}

struct friction_result {
  vector impulse;
  bool slips;
};

// Solves q + H r = u, 0 <= u_N _|_ r_N >= 0, |r_T| <= mu r_N with r_T opposite to u_T where u_T != 0,
// in closed form for H = diag(h_N, h_T, h_T): the normal row stands alone (Signorini), and the slip u_T is
// parallel to q_T, so that sliding scales the sticking impulse back to the cone (de Saxce and Feng 1991).
template <class Delassus>
friction_result solve_contact_friction(const Delassus& delassus, vector q, double friction) {
  const double normal = positive_part(-q.n / delassus.normal());
  const double limit = friction_limit(friction, normal);
  const double speed = q.tangential_length();
  const bool slips = speed > limit * delassus.tangential();
  const double factor = (slips ? limit : 1.0) / (slips ? speed : delassus.tangential());
  return {{normal, -factor * q.t1, -factor * q.t2}, slips};
}

// The same where the contact may also be open; gives the node its impulse and status.
template <class Node>
void apply_contact_friction(Node& node, bool active, vector q, double friction) {
  const friction_result result = solve_contact_friction(node.delassus, q, friction);
  const bool closed = active && result.impulse.n > 0.0;
  node.impulse.n = closed ? result.impulse.n : 0.0;
  node.impulse.t1 = closed ? result.impulse.t1 : 0.0;
  node.impulse.t2 = closed ? result.impulse.t2 : 0.0;
  node.status = closed ? (result.slips ? ILAW_SLIP : ILAW_STICK) : ILAW_FREE;
  node.refused = node.delassus.tangentially_isotropic() ? refusal::none : refusal::anisotropic_delassus;
}

}  // namespace ilaw::kit
