// two_impulses.hpp - an impact resolved to second order in its instant, by an impulse in its step and one in
// the next; docs/theory/resolved_impact.md derives the equations and proves that no energy is added.
#pragma once

#include <ilaw/kit/friction.hpp>

namespace impact_law {

using namespace ilaw::kit;

// The impulse of a step, and the work W that the impact leaves to the impulse of the next step; 0: none. W >
// 0 is energy that this contact stores; W < 0 is still to be dissipated, as if the contact were alone at its
// bodies.
// For friction: the gain that the last impact left to this step, and the impact of this step, if it bounces,
// at the part `instant` of the step; this contact stops the part `speed` of the approach.
template <class V>
struct two_impulses {
  V impulse, work, rebound, instant, speed;
  mask_of<V> lands, bounces;
};

// The part of the mass 1/H that a contact stops: its own gain over the one that all contacts of the step give
// it, of which the impulses of others gave `others`. 1 where the contact is alone, or where others press on
// it.
template <class V>
ILAW_KIT_INLINE V part_of_impact(V gain, V others) {
  return select((gain > 0.0) & (others > 0.0), gain / (gain + others), V(1.0));
}

// Marks an impact that has no work left to do, but a rebound.
inline constexpr double no_work = -std::numeric_limits<double>::denorm_min();

// A node that rests seems to approach with half of what the step's forces give it. With e = 1 a rounding
// decides whether it leaves as fast and is back at the end of the step: it rests if it leaves no faster than
// that, but for this part of it.
inline constexpr double lasting_part = 0x1p-30;

// What is left of a gain where the impulses of others give `others` of it.
template <class V>
ILAW_KIT_INLINE V rest_of_gain(V gain, V others) {
  return zero_unless(gain > 0.0, positive_part(gain - others));
}

// (v_n)^2 = mean^2 + 2 H W, the velocity with which the rebound of the last step leaves, less the mean.
template <class V>
ILAW_KIT_INLINE V gain_of_work(V mean, V twice) {
  const V speed = square_root(positive_part(mean * mean + twice));
  const mask_of<V> leaves = mean > 0.0;
  return positive_part(select(leaves, twice, speed - mean) / select(leaves, speed + mean, V(1.0)));
}

// gain: v_N - v_free,N. mean + gain/2 is the mean velocity of the step, along which the impulse works. The
// impact is found on the motion without the impulses of this step, as if the contact were alone: `alone`.
template <class Node>
ILAW_KIT_INLINE auto resolve_impact(const Node& node, number_of<Node> restitution, number_of<Node> work) {
  using V = number_of<Node>;
  const V inverse_mass = node.delassus.normal(), free = node.v_free.n, before = node.v_previous.n;
  const V alone = smooth_velocity(node).n;
  const V mean = 0.5 * (before + free), mean_alone = 0.5 * (before + alone), change = alone - before;

  // The rebound of the last step; no more than it may gain, and no pull.
  V gain = 0.0, gain_alone = 0.0, most = positive_part(-(before + free));
  const mask_of<V> rebounds = work != 0.0;
  if (any(rebounds)) {
    const V twice = 2.0 * (inverse_mass * work);
    gain = gain_of_work(mean, twice);
    gain_alone = gain_of_work(mean_alone, twice);
    // The same velocity, whatever the impulses of other contacts: equal contacts share what is to be
    // dissipated.
    gain = zero_unless(rebounds, select(work > 0.0, gain, rest_of_gain(gain_alone, free - alone)));
    gain_alone = zero_unless(rebounds, gain_alone);
    most = select(work > 0.0, gain, most);
  }

  // gamma + v_n s + change s^2/2 = 0: the impact at the part s of the step, with the velocity -speed.
  const V open = positive_part(node.gap);
  const mask_of<V> strikes = open + node.position_step * (alone + gain_alone) <= 0.0,
                   hits = strikes | (open + node.position_step * (free + gain) <= 0.0);
  two_impulses<V> found{.impulse = 0.0,
                        .work = 0.0,
                        .rebound = gain,
                        .instant = 0.0,
                        .speed = 0.0,
                        .lands = hits,
                        .bounces = hits};
  if (any(hits)) {
    const V gamma = open * node.per_position_step, now = mean_alone + gain_alone;
    const V square = positive_part(now * now - 2.0 * change * gamma), speed = square_root(square);
    const mask_of<V> approaches = now <= 0.0;
    const V s = select(approaches, 2.0 * gamma, speed + now) / select(approaches, speed - now, -change);
    const V rest = 1.0 - s, leaving = restitution * speed, rise = leaving + 0.5 * change * rest;
    const mask_of<V> bounces = strikes & (leaving > 0.0) & (rise > lasting_part * leaving);
    const V target = select(bounces, rest * rise - gamma, -gamma);
    const V needed = positive_part(smaller(target - free, most));
    const V loss = 0.5 * (1.0 - restitution * restitution) * square;
    const V share = part_of_impact(needed, free - alone), all = needed + (free - alone);
    const V own = work - (share * loss + needed * (mean + 0.5 * needed)) / inverse_mass,
            left = work - (loss + all * (mean_alone + 0.5 * all)) / inverse_mass;
    const V after = select(left < 0.0, left, own);
    // Only the impulses of others close it: it arrives, and keeps e^2 of what that took for the next step.
    const V taken = positive_part(work - needed * (mean + 0.5 * needed) / inverse_mass);
    const V left_by_impact =
                zero_unless(bounces, select((after == 0.0) & (needed < most), V(no_work), after)),
            left_by_arrival = restitution * restitution * taken;
    found.work = zero_unless(hits & (needed > 0.0), select(strikes, left_by_impact, left_by_arrival));
    found.bounces = hits & bounces;
    found.instant = zero_unless(found.bounces, s);
    found.speed = zero_unless(found.bounces, share * speed);
    gain = select(hits, needed, gain);
  }
  found.impulse = gain / inverse_mass;
  found.work = zero_unless(found.impulse > 0.0, found.work);
  return found;
}

// A tangential impulse, and the status where the contact is pressed.
template <class Vector>
struct rubbing {
  Vector impulse;
  status_of<typename Vector::number> status;
};

// That of a node that lands and stays, or was there: the friction of `predictive`. friction: at rest the
// static coefficient. ratio is the impulse that held the node in the last step over its limit, 0 where it was
// not held. Where the load passes the limit before the next half step, the kinetic coefficient acts from that
// instant on. The energy that an arrival keeps for the next step is not there for friction to use.
template <class Node, class V>
ILAW_KIT_INLINE auto rub_in_touch(const Node& node, const two_impulses<V>& impact, V friction, V kinetic,
                                  V& ratio) {
  using Vector = std::remove_cvref_t<decltype(node.v_free)>;
  const Vector &free = node.v_free, &before = node.v_previous;
  const V normal = impact.impulse, waiting = zero_unless(impact.work > 0.0, 2.0 * impact.work / normal);
  const V h_t = node.delassus.tangential(), arrival = positive_part(node.gap) * -node.per_position_step;
  const scaled_length<V> speed = free.scaled_tangential_length();
  friction_factor<V> found = rub(h_t, normal, speed, tangential_product(speed.down * free, before),
                                 smaller(before.n + arrival + waiting, V(0.0)), friction);
  if (any((kinetic < friction) | (ratio > 0.0))) {
    const V slip = speed.root(), limit = speed.down * friction_limit(friction, normal),
            now = slip / (h_t * limit), rate = now - ratio;
    const mask_of<V> starts = (kinetic < friction) & (ratio > 0.0) & (rate > 0.0) & (now + 0.5 * rate > 1.0);
    const V until = smaller(larger((1.0 - now) / rate, V(-0.5)), V(0.5));
    const V slides = (0.5 - until) * (slip - h_t * (speed.down * friction_limit(kinetic, normal)));
    const V factor = positive_part(slip - slides) / (slip * h_t);
    found.factor = select(starts & (factor < found.factor), factor, found.factor);
    found.status = select(starts, status_of<V>(status::slip), found.status);
    ratio = zero_unless((found.status == status::stick) & (normal > 0.0) & (kinetic < friction),
                        smaller(now, V(1.0)));
  }
  return rubbing<Vector>{free.against(V(0.0), found.factor), found.status};
}

// The part of its step at which the last impact was, from the rebound that it left: rebound = s (1 + e) w and
// v_n = e w + change (1 - s), so that (1 + e) change s^2 + (1 + e) (v_n - change) s = e rebound.
template <class V>
ILAW_KIT_INLINE V instant_of_rebound(V restitution, V rebound, V velocity, V change) {
  const V c2 = (1.0 + restitution) * change, c1 = (1.0 + restitution) * (velocity - change),
          c0 = restitution * rebound;
  const V root = c1 + square_root(positive_part(c1 * c1 + 4.0 * c2 * c0));
  return select(2.0 * c0 < root, 2.0 * c0 / root, 1.0);
}

// That of a node that rebounds: the part s_0 of the friction of the last impact and the part 1 - s of that of
// this one, each in its cone, less what is outside the cone of r_N or would be positive work.
template <class Node, class V>
ILAW_KIT_INLINE auto rub_at_impact(const Node& node, const two_impulses<V>& impact, V restitution,
                                   V friction) {
  using Vector = std::remove_cvref_t<decltype(node.v_free)>;
  const V h_n = node.delassus.normal(), h_t = node.delassus.tangential();
  const Vector motion = node.v_previous + node.v_free, change = smooth_velocity(node) - node.v_previous;
  const auto rub_on = [&](V normal, const Vector& q) ILAW_KIT_LAMBDA {
    return rub(h_t, normal, q.scaled_tangential_length(), V(0.0), V(0.0), friction);
  };
  const V then = instant_of_rebound(restitution, impact.rebound, 0.5 * motion.n + impact.rebound, change.n);
  const Vector last = node.v_previous + (then - 0.5) * change;
  const friction_factor<V> of_last = rub_on(impact.rebound / h_n, last);
  Vector r = last.against(V(0.0), of_last.factor);
  const Vector now = V(0.5) * motion + h_t * r + impact.instant * change;
  const friction_factor<V> of_this = rub_on((1.0 + restitution) * impact.speed / h_n, now);
  r = r + (1.0 - impact.instant) * now.against(V(0.0), of_this.factor);

  const scaled_length<V> size = r.scaled_tangential_length();
  const Vector scaled = size.down * r;
  const V limit = size.down * friction_limit(friction, impact.impulse), length = size.root();
  const V inside = select(length > limit, limit / length, 1.0);
  const V part = smaller(
      inside, dissipative_part(tangential_product(scaled, motion), h_t * tangential_product(scaled, r)));
  const status_of<V> moved = select(impact.bounces, of_this.status, of_last.status);
  return rubbing<Vector>{part * r, select(part < sticking_part, status_of<V>(status::slip), moved)};
}

// Friction for H = diag(h_N, h_T, h_T). Writes the tangential impulse, returns the status where it is
// pressed.
template <class Node>
ILAW_KIT_INLINE status_of<number_of<Node>> apply_friction(Node& node,
                                                          const two_impulses<number_of<Node>>& impact,
                                                          number_of<Node> restitution,
                                                          number_of<Node> friction, number_of<Node> kinetic,
                                                          number_of<Node>& ratio) {
  auto found = rub_in_touch(node, impact, friction, kinetic, ratio);
  const mask_of<number_of<Node>> rebounds = impact.bounces | ((impact.rebound > 0.0) & !impact.lands);
  if (any(rebounds)) {
    const auto other = rub_at_impact(node, impact, restitution, kinetic);
    found = {select(rebounds, other.impulse, found.impulse), select(rebounds, other.status, found.status)};
    ratio = zero_unless(!rebounds, ratio);
  }
  node.impulse = found.impulse;
  return found.status;
}

}  // namespace impact_law
