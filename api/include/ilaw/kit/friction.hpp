// friction.hpp - Signorini-Moreau contact with Coulomb friction at one node, shared by all laws that need it.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit/contact.hpp>
#include <ilaw/kit/node.hpp>

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

// The same, giving the node its impulse and status.
template <class Node, class Vector>
void apply_contact_friction(Node& node, double slack, Vector q, double friction) {
  const auto result = solve_contact_friction(node.delassus, slack, q, friction);
  node.impulse = result.impulse;
  const double closed_status = result.slips ? double{ILAW_SLIP} : double{ILAW_STICK};
  node.status = result.impulse.n > 0.0 ? closed_status : double{ILAW_FREE};
  node.refused = node.delassus.anisotropy() == 0.0 ? not_refused : anisotropic_delassus;
}

}  // namespace ilaw::kit
