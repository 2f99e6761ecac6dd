// bond.hpp - a bond with contact and friction for any H: what it shares with others is here, what it is made of is its
// law's. The equations are derived in docs/theory/bonds.md.
//
// The bond acts on the mean of two positions, w = (x_n + x_n+1)/2, which a step moves by h (v^- + v)/2:
//   w^+ = w^- + h (v^- + v)/2,  r_b = -h A k W (w^+ + w^-)/2,  W = diag(1, weight, weight).
// So the work of r_b is -A k (w^+.W w^+ - w^-.W w^-)/2 for any H, and a law that takes as k the mean stiffness on the
// way from w^- to w^+ stores and dissipates exactly that. With kappa = h^2 A h_N k/4:
//   (I + kappa H W/h_N) (w^+ + w^-) = h v_free/2 + x + w^-.
//
// A law derives from adhesive_bond<law, V> and has, as functions of numbers on V,
//   broken                          its memory when nothing is left: 1 of a damage, 0 of an intensity of adhesion
//   friction                        a parameter: the coefficient without bond
//   prepare(step_sizes)             what is the same at all nodes; a struct with .step; "common" below
//   bonds()                         whether these parameters make a bond at all
//   weight(common)                  of the tangential opening, see W
//   friction_of(memory)             the coefficient beside what is left of the bond
//   energy(memory, size, common)    stored per area, size^2 = w.W w
//   as_it_was(step, memory, common) the step with the memory before, and where that is the answer
//   change(step, where, common, found)   the step and the memory after it, where it is not
// and, where a bond may be rigid, is_rigid(memory) and bears(impulse, capacity).
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit/rigid_bond.hpp>
#include <ilaw/kit/roots.hpp>

namespace ilaw::kit::inline ILAW_KIT_LEVEL {

// ---- problem and answer ---------------------------------------------------------------------------------------------

template <class V>
struct bond_state {
  V memory;
  vector<V> position;  // at the time of the next impulse
  vector<V> opening;   // half a step before: w
};
// The variables of a bond after its memory: k from 0 to 5.
template <class State>
constexpr state_variable<State> bond_variable(int k) {
  constexpr const char* names[] = {"opening", "slip_1", "slip_2", "mean_opening", "mean_slip_1", "mean_slip_2"};
  constexpr const char* docs[] = {"Normal displacement since the start.", "First tangential displacement.",
                                  "Second tangential displacement.",      "Mean of the last two openings.",
                                  "Mean of the last two of slip_1.",      "Mean of the last two of slip_2."};
  constexpr double vector<double>::*parts[] = {&vector<double>::n, &vector<double>::t1, &vector<double>::t2};
  return {.member = {k < 3 ? &State::position : &State::opening, parts[k % 3]},
          .name = names[k],
          .unit = "m",
          .doc = docs[k],
          .internal = k >= 3};
}

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
  V stiffness;  // k
  V status, refused;
};
// What stays where it was.
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
  a.stiffness = select(where, other.stiffness, a.stiffness);
  a.status = select(where, other.status, a.status);
  a.refused = select(where, other.refused, a.refused);
}

// ---- a node that a bond holds -----------------------------------------------------------------------------------------

// M = (I + kappa A)^-1, A = W^1/2 H W^1/2/h_N, for a trial kappa.
template <class V, class Delassus>
class held_node;

template <class V>
class held_node<V, transverse<V>> {
 public:
  ILAW_KIT_INLINE held_node(const transverse<V>& h, V weight) : h_(h), ratio_(weight * h.t / h.n), weight_(weight) {}
  ILAW_KIT_INLINE V trace() const { return 1.0 + 2.0 * ratio_; }

  ILAW_KIT_INLINE void hold(V kappa) {
    const V of_n = 1.0 + kappa, of_t = 1.0 + ratio_ * kappa, both = 1.0 / (of_n * of_t);
    kappa_ = kappa;
    left_n_ = both * of_t;
    left_t_ = both * of_n;
  }
  // What is left of a free motion, W^-1/2 M W^1/2 d, and H as the node has it now.
  ILAW_KIT_INLINE vector<V> left(vector<V> d) const { return {left_n_ * d.n, left_t_ * d.t1, left_t_ * d.t2}; }
  ILAW_KIT_INLINE transverse<V> delassus() const { return {left_n_ * h_.n, left_t_ * h_.t}; }
  // -w^+.W d(w^+)/d(kappa), where w^+ + w^- = sum. A closed node does not move along its normal.
  ILAW_KIT_INLINE V gives_way(vector<V> after, vector<V> sum, mask_of<V> closed) const {
    const V normal = zero_unless(!closed, left_n_ * normal_product(sum, after));
    return normal + ratio_ * weight_ * left_t_ * tangential_product(sum, after);
  }
  ILAW_KIT_INLINE mask_of<V> may_close(mask_of<V>) const { return V(0.0) == V(0.0); }
  // Of the bond, on a node that would move by d, and of a contact beside it, which takes a closed node to the velocity
  // arrival, whatever the bond does.
  ILAW_KIT_INLINE vector<V> impulse(vector<V> d, V per_step, vector<V> contact, mask_of<V> closed, V closing) const {
    const V taken = 2.0 * kappa_ * per_step, taken_t = taken * ratio_ * left_t_ / h_.t;
    return {-(select(closed, closing, taken * left_n_ * d.n) / h_.n), left_t_ * contact.t1 - taken_t * d.t1,
            left_t_ * contact.t2 - taken_t * d.t2};
  }

 private:
  transverse<V> h_;
  V ratio_, weight_, kappa_, left_n_, left_t_;
};

template <class V>
class held_node<V, full<V>> {
 public:
  ILAW_KIT_INLINE held_node(const full<V>& h, V weight) : normal_(h.nn), root_(square_root(weight)), per_root_(1.0 / root_) {
    const V w = root_ / h.nn, ww = weight / h.nn;
    a_ = {1.0, ww * h.t11, ww * h.t22, w * h.n1, w * h.n2, ww * h.t12};
  }
  ILAW_KIT_INLINE V trace() const { return 1.0 + (a_.t11 + a_.t22); }

  ILAW_KIT_INLINE void hold(V kappa) {
    kappa_ = kappa;
    m_ = full<V>{1.0 + kappa, 1.0 + kappa * a_.t11, 1.0 + kappa * a_.t22, kappa * a_.n1, kappa * a_.n2, kappa * a_.t12}
             .factorise();
  }
  ILAW_KIT_INLINE vector<V> left(vector<V> d) const { return times_root(m_.solve(times_root(d, root_)), per_root_); }
  full<V> delassus() const {  // h_N W^-1/2 M A W^-1/2
    const vector<V> n = m_.solve({1.0, a_.n1, a_.n2}), t1 = m_.solve({a_.n1, a_.t11, a_.t12}),
                    t2 = m_.solve({a_.n2, a_.t12, a_.t22});
    const V one = normal_ * per_root_, two = one * per_root_;
    return {normal_ * n.n, two * t1.t1, two * t2.t2, one * n.t1, one * n.t2, two * t2.t1};
  }
  ILAW_KIT_INLINE V gives_way(vector<V> after, vector<V> sum, mask_of<V>) const {
    return product(times_root(after, root_), m_.solve(a_.times(times_root(sum, root_))));
  }
  ILAW_KIT_INLINE mask_of<V> may_close(mask_of<V> closed) const { return !closed; }
  ILAW_KIT_INLINE vector<V> impulse(vector<V> d, V per_step, vector<V> contact, mask_of<V>, V) const {
    const V taken = 2.0 * kappa_ * per_step / normal_;
    return times_root(m_.solve(times_root(contact, per_root_) - taken * times_root(d, root_)), root_);
  }

 private:
  ILAW_KIT_INLINE static vector<V> times_root(vector<V> a, V by) { return {a.n, by * a.t1, by * a.t2}; }

  V normal_, root_, per_root_, kappa_;
  full<V> a_;
  typename full<V>::factors m_;
};

// ---- one bonded node in one step ----------------------------------------------------------------------------------------

template <class V, class Delassus>
class bond_step {
 public:
  using number = V;
  using mask = mask_of<V>;

  // What a mean stiffness and a coefficient of friction make of the node.
  struct motion {
    V kappa;
    held_node<V, Delassus> node;
    vector<V> opening, contact;  // w^+; impulse of contact and friction
    V size;                      // |w^+|, with W
    mask closed, rubs, unsolved;  // unsolved: its friction is left to the scalar fallback
    V refused;
  };

  ILAW_KIT_INLINE bond_step(const Delassus& h, const bond_problem<V>& p, V weight, const step_sizes& step)
      : p_(p), step_(step), h_(h), weight_(weight), node_(h, weight) {
    compliance = 0.25 * step.velocity_step * step.velocity_step * p.area * h.normal();
    before = size_of(p.state.opening);
    const V moved = sum_of_sizes(p.state.position) + sum_of_sizes(p.state.opening);
    is_new = moved == 0.0;
    place();
  }

  V compliance;  // kappa/k
  V before;      // |w^-|
  mask is_new;   // the bond is made in this step
  const bond_problem<V>& problem() const { return p_; }
  V trace() const { return node_.trace(); }

  ILAW_KIT_INLINE motion at(V kappa, V friction) const {
    motion m{kappa, node_, {}, {}, 0.0, V(0.0) != V(0.0), V(0.0) != V(0.0), V(0.0) != V(0.0), 0.0};
    m.node.hold(kappa);
    m.opening = m.node.left(drive_) - p_.state.opening;
    m.closed = m.opening.n < below_;
    if (any(m.closed)) close(m, friction);
    m.size = size_of(m.opening);
    return m;
  }

  // -d|w^+|/d(kappa), and where it is that: without friction, and where contact does not couple.
  ILAW_KIT_INLINE V gives_way(const motion& m) const {
    return m.node.gives_way(m.opening, m.opening + p_.state.opening, m.closed) / m.size;
  }
  ILAW_KIT_INLINE mask is_smooth(const motion& m) const { return m.node.may_close(m.closed) & !m.rubs; }

  ILAW_KIT_INLINE bond_answer<V> answer(const motion& m, V memory, status_of<V> status, V refused) const {
    const V per_step = 1.0 / step_.velocity_step;
    const vector<V> impulse = m.node.impulse(drive_, per_step, m.contact, m.closed,
                                             p_.v_free.n + (place_.n - ground_) * per_step);
    // Where the steps differ the mean goes on by half a step of the position.
    const V on = step_.position_step / step_.velocity_step;
    const vector<V> next =
        is_even() ? V(2.0) * m.opening - place_ : m.opening + on * (m.opening - place_);
    return {impulse, {memory, next, m.opening}, m.kappa / compliance, status.code(), larger(refused, m.refused)};
  }

  // A bond that is made now, at the node's position, would put energy in where this is negative: what its impulse works
  // on v^-, against its sign. Then it is made before, at so large a part of half a step.
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
    return square_root(normal_product(w, w) + weight_ * tangential_product(w, w));
  }

  // The lowest next position: where the bond was made, or as deep as the node is. A node that was leaving turns round at
  // most at the speed with which it left (contact_leaving_at).
  ILAW_KIT_INLINE static V ground_below(V position, V v_previous, double step) {
    return smaller(smaller(position, V(0.0)), position - step * v_previous);
  }
  // Where the bond is at the time of the impulse, and its ground, as if both steps were that of the velocity: so the
  // opening grows as the work does, whatever the steps and the axes of the step before.
  ILAW_KIT_INLINE void place() {
    const double step = step_.velocity_step;
    const vector<V> &position = p_.state.position, on = p_.state.opening + V(0.5 * step) * p_.v_previous;
    place_ = select(is_new, position, on);
    if (is_even()) {
      ground_ = ground_below(place_.n, p_.v_previous.n, step);
    } else {
      const V lowest = ground_below(position.n, p_.v_previous.n, step_.position_step);
      ground_ = place_.n + step / step_.position_step * (lowest - position.n);
    }
    drive();
  }
  // below_: what of a mean position is below the ground and not rounding of it, which a stiff bond would store.
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
    constexpr bool is_transverse = is_transverse_form<Delassus>;
    const V per_step = 1.0 / step_.velocity_step, target = (ground_ - place_.n) * per_step;
    pressed_node n{m.node.delassus(), {}};
    vector<V> q = V(2.0 * per_step) * (m.opening - place_);
    q.n = (2.0 * m.opening.n - (place_.n + ground_)) * per_step;
    n.impulse.n = positive_part(-q.n / n.delassus.normal());
    m.rubs = m.closed & (friction > 0.0);
    mask sticks = V(0.0) != V(0.0);
    if (any(m.rubs)) {
      const contact_problem<vector<V>> contact{
          0.0, q, {smaller(p_.v_previous.n + target, 0.0), p_.v_previous.t1, p_.v_previous.t2}};
      const V pressing = n.impulse.n;
      if constexpr (is_transverse)
        sticks = apply_isotropic_friction(n, contact, friction) == status::stick;
      else
        rub(m, n, contact, friction);
      n.impulse = select(m.rubs, n.impulse, {pressing, 0.0, 0.0});
    }
    m.contact = zero_unless(m.closed, n.impulse);
    const vector<V> moved = m.opening + V(0.5 * step_.velocity_step) * n.delassus.times(n.impulse);
    const mask on_floor = is_transverse ? m.closed : m.closed & !m.rubs;
    m.opening = select(m.closed, moved, m.opening);
    m.opening.n = select(on_floor, floor_, m.opening.n);
    m.opening.t1 = select(sticks & m.rubs, place_.t1, m.opening.t1);
    m.opening.t2 = select(sticks & m.rubs, place_.t2, m.opening.t2);
  }
  // Where friction couples with the normal and would do work, that may leave no push at all: then there is none of it.
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
    const V q = contact.q.n, left_n = q + n.delassus.times(n.impulse).n;
    n.impulse = select(left_n < -0x1p-30 * absolute(q), {-q / n.delassus.normal(), 0.0, 0.0}, n.impulse);
  }

  const bond_problem<V>& p_;
  const step_sizes& step_;
  Delassus h_;
  V weight_;
  held_node<V, Delassus> node_;
  vector<V> place_, drive_;    // x at the time of the impulse; w^+ + w^- without bond and contact
  V ground_, floor_, below_;   // lowest next position, lowest w^+
};

// What comes of a step. left: to the scalar fallback.
template <class Step>
struct bond_result {
  typename Step::motion motion;
  typename Step::number memory;
  mask_of<typename Step::number> holds, left;
  typename Step::number refused;
};

// ---- the law ------------------------------------------------------------------------------------------------------------

template <template <class> class Law, class V>
struct adhesive_bond {
  using state = bond_state<V>;
  using problem = bond_problem<V>;
  using answer = bond_answer<V>;

  // At once: bonds that surely stand still, contact without bond and bonds that stay as they are, the latter two where H
  // does not couple.
  template <class Node>
  ILAW_KIT_INLINE asked<V> ask(Node& node, problem& p) const {
    p = {full_of(node.delassus), node.v_free, node.v_previous, node.gap, node.area, node.state};
    const mask_of<V> may_hold = is_bonded(p), bonded = may_hold & law().bonds();
    answer a = unmoved(p, {}, V(status::free.code));
    mask_of<V> open = V(0.0) != V(0.0);
    if (any(!bonded)) {
      const auto touching = contact(node);
      if constexpr (is_transverse<Node>)
        a.status = apply_isotropic_friction(node, touching, law().friction).code();
      else
        open = (touching.slack <= 0.0) & (touching.q.n < 0.0);
      a.impulse = node.impulse;
    }
    if (any(may_hold & !bonded)) give_up(may_hold & !bonded, a);
    if (any(bonded)) {
      open = select_mask(bonded, bonded, open);
      if constexpr (can_be_rigid) open = open & !stand(node, bonded, p, a);
      if constexpr (is_transverse<Node>)
        if (any(open)) open = open & !stay(node, open, p, a);
    }
    return {open, give(node, a)};
  }
  template <class Common>
  mask_of<V> solve(const problem& p, answer& a, const Common& common) const {
    return solve_with(p, a, common);
  }
  template <class Common>
  void solve_scalar(const problem& p, answer& a, const Common& common) const {
    solve_with(p, a, common);
  }
  template <class Node>
  ILAW_KIT_INLINE status_of<V> finish(Node& node, const answer& a) const {
    node.refused = larger(node.refused, a.refused);
    return give(node, a);
  }

 private:
  using law_type = Law<V>;
  ILAW_KIT_INLINE const law_type& law() const { return static_cast<const law_type&>(*this); }
};

}  // namespace ilaw::kit
