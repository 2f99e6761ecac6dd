// friction.hpp - when a contact acts and the velocity it must leave with; Signorini-Moreau contact with
// Coulomb friction at a node, for any H.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit/local_coulomb.hpp>
#include <ilaw/kit/node.hpp>

namespace ilaw::kit::inline ILAW_KIT_LEVEL {

// ---- contact

// Values of the parameter "activation".
inline constexpr const char* activation_choices[] = {"moreau", "predictive"};
inline constexpr double moreau = 0.0, predictive = 1.0;

// Contact requires 0 <= excess + H_NN r_N _|_ r_N >= 0 where slack <= 0, and r_N = 0 elsewhere.
// rest = v_free,N + v_N^- - excess <= 0: the work of r_N over the step is r_N rest/2 then, for any H.
template <class V>
struct contact_condition {
  V slack, excess, rest;
};

// A contact that must leave with v_N = target, were it not for its energy: in a central-difference host the
// work of r over the step is r.(v^- + v)/2, whatever the steps. So v_N <= -v_N^- where it is pressed: a node
// that was leaving is not stopped, but turns round at most at the speed with which it left. Near the critical
// step such nodes occur, and stopping them makes the motion diverge. Restitution asks for less by itself.
template <class V>
ILAW_KIT_INLINE contact_condition<V> contact_leaving_at(std::type_identity_t<V> target, V slack, V v_free,
                                                        V v_previous) {
  return {slack, larger(v_free - target, v_free + v_previous), smaller(v_previous + target, 0.0)};
}

// moreau: where the gap is closed, v_N + e v_N^- >= 0 (Moreau 1988).
// predictive: where the next gap would not be positive, v_N >= -g/h, so that it is never negative. An impact
// with restitution leaves with -e v_N^- at once, which is larger; whether there is one is decided without the
// impulses of other contacts (contact.md, "Several contacts at one body"). A gap that is negative already
// must not grow; pushing it out would create energy.
template <class Node>
ILAW_KIT_INLINE auto contact_at(const Node& node, number_of<Node> restitution, double activation) {
  using V = number_of<Node>;
  // Zero for moreau: where v_N^- >= 0 no target from -e v_N^- to 0 changes excess or rest.
  const bool predicts = activation == predictive;
  const double step = predicts ? node.position_step : 0.0, rate = predicts ? -node.per_position_step : 0.0;
  const V open = positive_part(node.gap), arrival = open * rate;
  V slack = open + step * node.v_free.n;  // next_gap to the last bit where the gap is positive
  V rebound = -restitution * node.v_previous.n;
  if constexpr (has_smooth<Node>) {
    if (node.is_coupled) {
      const V smooth = open + step * node.v_smooth.n;
      rebound = zero_unless(smooth <= 0.0, rebound);
      slack = smaller(smooth, slack);
    }
  }
  return contact_leaving_at<V>(select(rebound > 0.0, rebound, arrival), slack, node.v_free.n,
                               node.v_previous.n);
}

// What a contact reads of inputs: v_smooth only where an impact may leave with a rebound.
ILAW_KIT_INLINE constexpr std::uint32_t inputs_of_contact(std::uint32_t inputs, double restitution,
                                                          double activation) {
  return restitution > 0.0 && activation != moreau ? inputs : inputs & ~reads_v_smooth;
}

template <class Law>
constexpr parameter<Law> restitution_parameter(typename number_of_law<Law>::type Law::*member) {
  return {.member = member,
          .name = "restitution",
          .symbol = "e",
          .doc = "Newton's coefficient: normal velocity after an impact over the one before, reversed.",
          .maximum = 1.0};
}
template <class Law>
constexpr parameter<Law> activation_parameter(double Law::*member) {
  return {
      .member = member,
      .name = "activation",
      .doc = "moreau: acts where the gap is closed; predictive: acts where the next gap would be negative.",
      .default_value = predictive,
      .choices = activation_choices};
}

// ---- the problem

// 0 <= q_N + (H r)_N _|_ r_N >= 0 and Coulomb's law for q + H r, where slack <= 0; r = 0 elsewhere.
// rest = v_free + v^- - q, so that the work of r is r.(q + H r + rest)/2.
template <class Vector>
struct contact_problem {
  typename Vector::number slack;
  Vector q, rest;
};

// For v_free as given, which may contain what other impulses of the step have done.
template <class V, class Vector>
ILAW_KIT_INLINE contact_problem<Vector> contact_problem_of(contact_condition<V> condition, Vector v_free,
                                                           std::type_identity_t<Vector> v_previous) {
  v_free.n = condition.excess;
  v_previous.n = condition.rest;
  return {condition.slack, v_free, v_previous};
}
// Tangential restitution is the part of v_T^- that a sticking contact reverses.
template <class V, class Vector>
ILAW_KIT_INLINE contact_problem<Vector> contact_problem_of(contact_condition<V> condition, Vector v_free,
                                                           std::type_identity_t<Vector> v_previous,
                                                           V tangential_restitution) {
  contact_problem<Vector> contact = contact_problem_of(condition, v_free, v_previous);
  if (any(tangential_restitution != 0.0)) {
    contact.q = v_free + tangential_restitution * v_previous;
    contact.rest = (1.0 - tangential_restitution) * v_previous;
    contact.q.n = condition.excess;
    contact.rest.n = condition.rest;
  }
  return contact;
}

// Largest tangential impulse that friction can give: mu r_N, zero without pressure also when mu is infinite.
template <class V>
ILAW_KIT_INLINE V friction_limit(V friction, V normal_impulse) {
  return zero_unless(normal_impulse > 0.0, friction * normal_impulse);
}

template <class Law>
constexpr parameter<Law> friction_parameter(typename number_of_law<Law>::type Law::*member) {
  return {.member = member,
          .name = "friction",
          .symbol = "mu",
          .doc = "Coefficient of friction.",
          .infinity_allowed = true};
}

// Whether the node slipped in the last step: faster than the rounding of a contact that stuck, which leaves
// with a few ulp of the free velocity.
template <class Node>
ILAW_KIT_INLINE mask_of<number_of<Node>> has_slipped(const Node& node) {
  constexpr double at_rest = 0x1p-26;
  const auto free = node.v_free.scaled_tangential_length();
  const auto slip = free.down * node.v_previous.tangential_length();
  return slip * slip > at_rest * at_rest * free.square;
}

// ---- closed form

// A number in [0, 1], not yet divided.
template <class V>
struct fraction {
  V numerator, denominator;
};

// The largest s in [0, 1] with c2 s^2 + c1 s + c0 <= 0, where c0 <= 0 <= c2 and that does not hold at 1;
// without cancellation.
template <class V>
ILAW_KIT_INLINE fraction<V> root_of_work(V c2, V c1, V c0) {
  const V root = square_root(c1 * c1 - 4.0 * c2 * c0);
  return {select(c1 <= 0.0, root - c1, -2.0 * c0), select(c1 <= 0.0, 2.0 * c2, root + c1)};
}

// A part that rounding cannot tell from 1: the contact sticks. It also sticks where the slip that is left is
// rounding beside the speed that the impulse can stop: an obstacle that moves leaves that much.
inline constexpr double sticking_part = 1.0 - 0x1p-46, rounding_of_slip = 0x1p-36;

// The tangential impulse -factor q_T, and the status where the contact is pressed.
template <class V>
struct friction_factor {
  V factor;
  status_of<V> status;
};

// The part of -q_T/h_T, which stops the slip, that may act, scaled back to the cone. With the part s the work
// of the whole impulse, times 2 h_T, is s^2 q_T^2 - s q_T.(q_T + rest_T) + h_T r_N rest_N, and must not be
// positive: the part is less than 1 only where the motion turned round within the step, as it does on a stiff
// spring, and the impact takes less than it costs to stop that from behind. speed: that of q_T; along:
// speed.down q_T.rest_T; rounded: part of the speed that the impulse can stop, of which a slip is none.
template <class V>
ILAW_KIT_INLINE friction_factor<V> rub(V h_t, V normal, scaled_length<V> speed, V along, V rest_n, V friction,
                                       double rounded = rounding_of_slip) {
  const V impact = h_t * (speed.down * normal) * rest_n,
          limit = speed.down * friction_limit(friction, normal);
  const V slip = speed.root();
  const auto slips = slip > limit * h_t;
  V factor = select(slips, limit, V(1.0)) / select(slips, slip, h_t);
  V code = select(slips, V(status::slip.code), V(status::stick.code));
  const auto gains = along < impact;
  if (any(gains)) [[unlikely]] {
    const fraction<V> part =
        root_of_work(speed.square, -(speed.square + speed.down * along), speed.down * impact);
    const auto far = part.denominator == infinity;  // v^- is so much larger than q that nothing is left
    const V numerator = select(gains, zero_unless(!far, part.numerator), 1.0);
    const V denominator = select(gains & !far, part.denominator, 1.0);
    const V whole = h_t * denominator;
    const auto slides = slip * numerator > limit * whole;
    const V stopped = rounded * (smaller(limit, speed.down * normal) * whole);
    const auto turns =
        (numerator < sticking_part * denominator) & (slip * (denominator - numerator) > stopped);
    factor = select(slides, limit, numerator) / select(slides, slip, whole);
    code = select(slides | turns, V(status::slip.code), V(status::stick.code));
  }
  return {factor, status_of<V>::from(code)};
}

// r_N where the tangential impulse does not act on it.
template <class Delassus, class Vector>
ILAW_KIT_INLINE auto pressing_impulse(const Delassus& h, const contact_problem<Vector>& contact) {
  return zero_unless(contact.slack <= 0.0, positive_part(-contact.q.n / h.normal()));
}

// Solves q + H r = u, 0 <= u_N _|_ r_N >= 0, |r_T| <= mu r_N with r_T opposite to u_T where u_T != 0, in
// closed form for H = diag(h_N, h_T, h_T): the normal row stands alone (Signorini), and the slip u_T is
// parallel to q_T, so that sliding scales the sticking impulse back to the cone (Moreau 1988).
// Gives the impulse, returns the status.
template <class Node, class Vector>
ILAW_KIT_INLINE status_of<number_of<Node>> apply_isotropic_friction(Node& node,
                                                                    const contact_problem<Vector>& contact,
                                                                    number_of<Node> friction,
                                                                    double rounded = rounding_of_slip) {
  using V = number_of<Node>;
  const V normal = pressing_impulse(node.delassus, contact);
  const scaled_length<V> speed = contact.q.scaled_tangential_length();
  const V along = tangential_product(speed.down * contact.q, contact.rest);
  const friction_factor<V> found =
      rub(node.delassus.tangential(), normal, speed, along, contact.rest.n, friction, rounded);
  node.impulse = contact.q.against(normal, found.factor);
  return select(normal > 0.0, found.status, status::free);
}

// ---- any H, and coefficients along the tangents

// A pressed contact, and its answer.
template <class V>
struct friction_problem {
  local_problem<V> contact;
  V rest[3];
};
template <class V>
struct friction_answer {
  V r[3], status, refused;
};

template <class V>
ILAW_KIT_INLINE void fill(local_problem<V>& p, const transverse<V>& h) {
  p.h[0] = h.n;
  p.h[1] = p.h[2] = h.t;
  p.h[3] = p.h[4] = p.h[5] = 0.0;
}
template <class V>
ILAW_KIT_INLINE void fill(local_problem<V>& p, const full<V>& h) {
  p.h[0] = h.nn;
  p.h[1] = h.t11;
  p.h[2] = h.t22;
  p.h[3] = h.n1;
  p.h[4] = h.n2;
  p.h[5] = h.t12;
}
template <class V, class Delassus>
ILAW_KIT_INLINE void fill(friction_problem<V>& p, const Delassus& delassus,
                          const contact_problem<vector<V>>& contact, std::type_identity_t<V> friction_1,
                          std::type_identity_t<V> friction_2) {
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
ILAW_KIT_INLINE V dissipative_part(V r_a, V r_Hr) {
  return select(r_a + r_Hr > 0.0, positive_part(-r_a / r_Hr), 1.0);
}

// Takes the positive work off a solution for any H, whose work is r.(rest + u)/2 with u_N = 0, r_T.u_T <= 0.
// The part s of r_T may act, with the r_N(s) for which u_N stays 0: the work is that of c2 s^2 + c1 s + c0,
// c0 = r_N(0) rest_N, and the part the largest without positive work. Between s = 0 and 1 r_N(s) and the cone
// go along a line, so r stays in it. Where c0 > 0, as it may where a bond pulls, the whole impulse is scaled.
template <class V>
void take_off_positive_work(const friction_problem<V>& p, friction_answer<V>& a) {
  const V *h = p.contact.h, *q = p.contact.q, *rest = p.rest;
  V* r = a.r;
  const V slid_n = h[3] * r[1] + h[4] * r[2], slid_1 = h[1] * r[1] + h[5] * r[2],
          slid_2 = h[5] * r[1] + h[2] * r[2];
  const V along = r[1] * (q[1] + (h[3] * r[0] + slid_1)) + r[2] * (q[2] + (h[4] * r[0] + slid_2));
  const V slip = select(a.status == status::stick.code, 0.0, smaller(along, 0.0));
  const V work = r[0] * rest[0] + (r[1] * rest[1] + r[2] * rest[2]) + slip;
  const auto gains = work > 0.0;
  if (!any(gains)) return;
  const V c2 = r[1] * slid_1 + r[2] * slid_2 - slid_n * slid_n / h[0], c0 = -q[0] / h[0] * rest[0];
  const V c1 = work - c0 - c2;
  const fraction<V> root = root_of_work(c2, c1, smaller(c0, 0.0));
  const V part = select(gains & (root.numerator < root.denominator), root.numerator / root.denominator, 1.0);
  r[0] = select(part < 1.0, -(q[0] + part * slid_n) / h[0], r[0]);
  r[1] = r[1] * part;
  r[2] = r[2] * part;
  const V r_a = r[0] * (q[0] + rest[0]) + (r[1] * (q[1] + rest[1]) + r[2] * (q[2] + rest[2]));
  const V r_n = r[0] * (h[0] * r[0] + h[3] * r[1] + h[4] * r[2]);
  const V r_1 = r[1] * (h[3] * r[0] + h[1] * r[1] + h[5] * r[2]);
  const V r_2 = r[2] * (h[4] * r[0] + h[5] * r[1] + h[2] * r[2]);
  const V whole = select(gains, dissipative_part(r_a, r_n + (r_1 + r_2)), 1.0);
  for (int k = 0; k < 3; ++k) r[k] = r[k] * whole;
  const V moved = select(r[0] > 0.0, V(status::slip.code), V(status::free.code));
  const V kept = part * whole, left = (1.0 - kept) * (absolute(q[1]) + absolute(q[2]));
  const V pressed = smaller(smaller(p.contact.mu[0], p.contact.mu[1]), 1.0) * r[0] * smaller(h[1], h[2]);
  a.status = select((kept < sticking_part) & (left > rounding_of_slip * pressed), moved, a.status);
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
  const scaled_length<V> speed = scaled_length_of(q[1], q[2]);
  const V along = (speed.down * q[1]) * p.rest[1] + (speed.down * q[2]) * p.rest[2];
  const friction_factor<V> found = rub(h[1], normal, speed, along, p.rest[0], p.contact.mu[0]);
  a.r[0] = select(where, normal, a.r[0]);
  for (int k = 1; k < 3; ++k) a.r[k] = select(where, 0.0 - found.factor * q[k], a.r[k]);
  a.status = select(where, select(normal > 0.0, found.status.code(), V(status::free.code)), a.status);
}

// Solves what is regular or has a closed form; says which are left to solve_friction_exactly.
template <class V>
mask_of<V> solve_friction(const friction_problem<V>& p, friction_answer<V>& a) {
  const local::regular_answer<V> found = solve_regular(p.contact);
  for (int k = 0; k < 3; ++k) a.r[k] = found.r[k];
  a.status = select(found.sticks, V(status::stick.code), V(status::slip.code));
  a.refused = static_cast<double>(refusal::none);
  take_off_positive_work(p, a);
  const mask_of<V> closed = has_closed_form(p.contact);
  if (any(closed)) solve_isotropic(p, closed, a);
  return !(found.found | closed);
}

[[gnu::noinline]] inline void solve_friction_exactly(const friction_problem<double>& p,
                                                     friction_answer<double>& a) {
  a = {};
  const contact_mode mode = solve_pressed(p.contact, a.r);
  a.status = (mode == contact_mode::slip ? status::slip : status::stick).code;
  if (mode == contact_mode::none) a.status = status::free.code;
  a.refused = static_cast<double>(mode == contact_mode::none ? refusal::no_solution : refusal::none);
  take_off_positive_work(p, a);
}

// Fills the problem of a node. Nothing is left to a solver where the contact is open.
template <class Node>
ILAW_KIT_INLINE asked<number_of<Node>> ask_friction(Node& node,
                                                    const contact_problem<vector<number_of<Node>>>& contact,
                                                    std::type_identity_t<number_of<Node>> friction_1,
                                                    std::type_identity_t<number_of<Node>> friction_2,
                                                    friction_problem<number_of<Node>>& problem) {
  fill(problem, node.delassus, contact, friction_1, friction_2);
  return {(contact.slack <= 0.0) & (contact.q.n < 0.0), status::free};
}
template <class Node>
ILAW_KIT_INLINE status_of<number_of<Node>> finish_friction(Node& node,
                                                           const friction_answer<number_of<Node>>& a) {
  using V = number_of<Node>;
  node.impulse = {a.r[0], a.r[1], a.r[2]};
  node.refused = larger(node.refused, a.refused);
  return status_of<V>::from(a.status);
}

// Base of a law that leaves its contact to the solver as it is.
template <class V>
struct friction_solver {
  using problem = friction_problem<V>;
  using answer = friction_answer<V>;
  static mask_of<V> solve(const problem& p, answer& a) { return solve_friction(p, a); }
  static void solve_scalar(const problem& p, answer& a) { solve_friction_exactly(p, a); }
  template <class Node>
  status_of<V> finish(Node& node, const answer& a) const {
    return finish_friction(node, a);
  }
};

}  // namespace ilaw::kit
