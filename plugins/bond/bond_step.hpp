// bond_step.hpp - one step of a node with a bond (bond.hpp), contact and friction: its motion for a mean
// stiffness of the bond.
#pragma once

#include <ilaw/kit/friction.hpp>
#include <ilaw/kit/rigid_bond.hpp>
#include "bonded_inertia.hpp"

namespace bond_law::inline ILAW_KIT_LEVEL {

using namespace ilaw::kit;

// ---- problem and answer

template <class V>
struct bond_state {
  V memory;
  vector<V> position;  // at the time of the next impulse
  vector<V> opening;   // half a step before: w
};
template <class V>
struct bond_problem {
  full<V> h;
  vector<V> v_free, v_previous;
  V gap, area;
  bond_state<V> state;
};
template <class V>
struct bond_answer {
  vector<V> impulse;
  bond_state<V> state;
  V rate;  // A k/2
  V status, refused;
};
// The answer for a node that keeps its state.
template <class V>
ILAW_KIT_INLINE bond_answer<V> unmoved(const bond_problem<V>& p, vector<V> impulse, V status) {
  return {impulse, p.state, 0.0, status, 0.0};
}
template <class V>
ILAW_KIT_INLINE void choose(mask_of<V> where, const bond_answer<V>& other, bond_answer<V>& a) {
  a.impulse = select(where, other.impulse, a.impulse);
  a.state.memory = select(where, other.state.memory, a.state.memory);
  a.state.position = select(where, other.state.position, a.state.position);
  a.state.opening = select(where, other.state.opening, a.state.opening);
  a.rate = select(where, other.rate, a.rate);
  a.status = select(where, other.status, a.status);
  a.refused = select(where, other.refused, a.refused);
}

// ---- one bonded node in one step

template <class V, class Delassus>
class bond_step {
 public:
  using number = V;
  using mask = mask_of<V>;

  // Motion of the node for a mean stiffness and a coefficient of friction.
  struct motion {
    typename bonded_inertia<V, Delassus>::held held;
    vector<V> opening, contact;   // w^+; impulse of contact and friction
    V size;                       // |w^+|, with W
    mask closed, rubs, unsolved;  // unsolved: its friction is left to the scalar fallback
    V refused;
  };

  ILAW_KIT_INLINE bond_step(const Delassus& h, const bond_problem<V>& p, const bond_common<V>& all)
      : p_(p), step_(all.step), weight_(all.weight), root_(all.root), inertia_(h, all) {
    compliance = 0.25 * step_.velocity_step * step_.velocity_step * p.area * h.normal();
    before = size_of(p.state.opening);
    is_new = sum_of_sizes(p.state.position) + sum_of_sizes(p.state.opening) == 0.0;
    place();
  }

  V compliance;  // kappa/k
  V before;      // |w^-|
  mask is_new;   // the bond is made in this step
  const bond_problem<V>& problem() const { return p_; }
  V trace() const { return inertia_.trace(); }
  // Whether no product on the way overflows or underflows; else a node is left to the scalar fallback.
  mask has_scale(V kappa) const {
    return std::is_same_v<V, double> ? kappa == kappa : (kappa < 0x1p101) & (compliance > 0x1p-900);
  }

  ILAW_KIT_INLINE void move(motion& m, V kappa, V friction) const {
    m.held = inertia_.hold(kappa);
    m.opening = inertia_.left(m.held, drive_) - p_.state.opening;
    m.closed = m.opening.n < below_;
    m.rubs = m.unsolved = none<V>();
    m.contact = {};
    m.refused = 0.0;
    if (any(m.closed)) close(m, friction);
    m.size = size_of(m.opening);
  }

  // -|w^+| d|w^+|/d(kappa), and where it is that: without friction, and where contact does not couple.
  ILAW_KIT_INLINE V gives_way(const motion& m) const {
    return inertia_.gives_way(m.held, m.opening, drive_, m.closed);
  }
  ILAW_KIT_INLINE mask is_smooth(const motion& m) const { return inertia_.is_smooth(m.closed) & !m.rubs; }

  ILAW_KIT_INLINE bond_answer<V> answer(const motion& m, V memory, status_of<V> status, V refused) const {
    const V per_step = 1.0 / step_.velocity_step;
    const vector<V> impulse = inertia_.impulse(m.held, drive_, per_step, m.contact, m.closed,
                                               p_.v_free.n + (place_.n - ground_) * per_step);
    // Where the steps differ the mean goes on by half a step of the position.
    const V on = step_.position_step / step_.velocity_step;
    const vector<V> next = is_even() ? V(2.0) * m.opening - place_ : m.opening + on * (m.opening - place_);
    return {impulse,
            {memory, next, m.opening},
            2.0 * m.held.kappa * (per_step * per_step) * inertia_.per_normal(),
            status.code(),
            larger(refused, m.refused)};
  }

  // A bond that is made now, at the node's position, would put energy in where this is negative: what its
  // impulse works on v^-, against its sign. Then it is made before, at so large a part of half a step.
  ILAW_KIT_INLINE V taken_from_before(const motion& m) const {
    const vector<V> v = velocity_before(p_.v_previous, p_.v_free);
    return normal_product(v, m.opening) + weight_ * tangential_product(v, m.opening);
  }
  void make_before(V part) {
    place_ = (0.5 * part * step_.velocity_step) * p_.v_previous;
    ground_ = ground_below(place_.n, p_.v_previous.n, step_.velocity_step);
    drive();
  }

 private:
  bool is_even() const { return step_.velocity_step == step_.position_step; }
  ILAW_KIT_INLINE V size_of(vector<V> w) const {
    if constexpr (std::is_same_v<V, double>)
      return length(w.n, root_ * w.t1, root_ * w.t2);  // of extreme scales
    return square_root(normal_product(w, w) + weight_ * tangential_product(w, w));
  }

  // The lowest next position: where the bond was made, or as deep as the node is. A node that was leaving
  // turns round at most at the speed with which it left (contact_leaving_at).
  ILAW_KIT_INLINE static V ground_below(V position, V v_previous, double step) {
    return smaller(smaller(position, V(0.0)), position - step * v_previous);
  }
  // Where the bond is at the time of the impulse, and its ground, as if both steps were that of the velocity:
  // so the opening grows as the work does, whatever the steps and the axes of the step before.
  ILAW_KIT_INLINE void place() {
    const double step = step_.velocity_step;
    const vector<V>&position = p_.state.position, on = p_.state.opening + V(0.5 * step) * p_.v_previous;
    place_ = select(is_new, position, on);
    if (is_even()) {
      ground_ = ground_below(place_.n, p_.v_previous.n, step);
    } else {
      const V lowest = ground_below(position.n, p_.v_previous.n, step_.position_step);
      ground_ = place_.n + step / step_.position_step * (lowest - position.n);
    }
    drive();
  }
  // below_: what of a mean position is below the ground and not rounding of it, which a stiff bond would
  // store.
  ILAW_KIT_INLINE void drive() {
    drive_ = V(0.5 * step_.velocity_step) * p_.v_free + (place_ + p_.state.opening);
    floor_ = 0.5 * (place_.n + ground_);
    below_ = 0.5 * (place_.n + (ground_ - 0x1p-49 * (absolute(place_.n) + absolute(ground_))));
  }

  // Contact and friction see a node that the bond holds.
  struct pressed_node {
    using number = V;
    Delassus delassus;
    vector<V> impulse;
  };
  [[gnu::noinline]] void close(motion& m, V friction) const {
    constexpr bool couples = !is_transverse_form<Delassus>;
    const V per_step = 1.0 / step_.velocity_step, target = (ground_ - place_.n) * per_step;
    pressed_node n{inertia_.delassus(m.held), {}};
    vector<V> q = V(2.0 * per_step) * (m.opening - place_);
    q.n = (2.0 * m.opening.n - (place_.n + ground_)) * per_step;
    n.impulse.n = positive_part(-q.n / n.delassus.normal());
    m.rubs = m.closed & (friction > 0.0);
    mask sticks = none<V>();
    if (any(m.rubs)) {
      const contact_problem<vector<V>> contact{
          0.0, q, {smaller(p_.v_previous.n + target, 0.0), p_.v_previous.t1, p_.v_previous.t2}};
      const V pressing = n.impulse.n;
      if constexpr (couples)
        rub(m, n, contact, friction);
      else
        sticks = m.rubs & (apply_isotropic_friction(n, contact, friction, 0.0) == status::stick);
      n.impulse = select(m.rubs, n.impulse, {pressing, 0.0, 0.0});
    }
    m.contact = zero_unless(m.closed, n.impulse);
    const vector<V> moved = m.opening + V(0.5 * step_.velocity_step) * n.delassus.times(n.impulse);
    m.opening = select(m.closed, moved, m.opening);
    m.opening.n = select(couples ? m.closed & !m.rubs : m.closed, floor_, m.opening.n);
    m.opening.t1 = select(sticks, place_.t1, m.opening.t1);
    m.opening.t2 = select(sticks, place_.t2, m.opening.t2);
  }
  void rub(motion& m, pressed_node& n, const contact_problem<vector<V>>& contact, V friction) const {
    friction_problem<V> p;
    friction_answer<V> a;
    fill(p, n.delassus, contact, friction, friction);
    const mask left = solve_friction(p, a);
    if constexpr (std::is_same_v<V, double>) {
      if (left) solve_friction_exactly(p, a);
    } else {
      m.unsolved = m.rubs & left;
    }
    n.impulse = {a.r[0], a.r[1], a.r[2]};
    m.refused = zero_unless(m.rubs, a.refused);
  }

  const bond_problem<V>& p_;
  const step_sizes& step_;
  V weight_, root_;
  bonded_inertia<V, Delassus> inertia_;
  vector<V> place_, drive_;   // x at the time of the impulse; w^+ + w^- without bond and contact
  V ground_, floor_, below_;  // lowest next position, lowest w^+
};

// Result of a step. left: nodes for the scalar fallback.
template <class Step>
struct bond_result {
  using V = typename Step::number;
  typename Step::motion motion;
  V memory;
  mask_of<V> holds, left = none<V>();
  V refused = 0.0;

  ILAW_KIT_INLINE explicit bond_result(V before) : memory(before) {}
};

}  // namespace bond_law
