// bond.hpp - a bond with contact and friction for any H: what it shares with others is here, what it is made
// of is its law's. plugins/cohesive/cohesive.md derives the equations.
//
// The bond acts on the mean of two positions, w = (x_n + x_n+1)/2, which a step moves by h (v^- + v)/2:
//   w^+ = w^- + h (v^- + v)/2,  r_b = -h A k W (w^+ + w^-)/2,  W = diag(1, weight, weight).
// So the work of r_b is -A k (w^+.W w^+ - w^-.W w^-)/2 for any H, and a law that takes as k the mean
// stiffness on the way from w^- to w^+ stores and dissipates exactly that. With kappa = h^2 A h_N k/4:
//   (I + kappa H W/h_N) (w^+ + w^-) = h v_free/2 + x + w^-.
//
// A law derives from adhesive_bond<law, V> and has, on V,
//   broken                             its memory when nothing is left: 1 of damage, 0 of adhesion
//   friction                           a parameter: the coefficient without bond
//   prepare(step_sizes)                a bond_common, or what derives from it: "all" below
//   friction_of(memory)                the coefficient beside what is left of the bond
//   energy(memory, size, all)          stored per area; size^2 = w.W w
//   as_it_was(step, memory, all, found)   the motion with the memory before, and where it holds
//   change(step, where, all, found)    motion and memory where it does not
// and may have
//   bonds()                            whether these parameters make a bond at all
// and, where a bond may be rigid, is_rigid(memory), bears(impulse, capacity) and a quick surely_bears.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit/rigid_bond.hpp>
#include <ilaw/kit/roots.hpp>

namespace ilaw::kit::inline ILAW_KIT_LEVEL {

template <class V>
ILAW_KIT_INLINE mask_of<V> none() {
  return detail::mask_from<V>(0U);
}

// ---- problem and answer

template <class V>
struct bond_state {
  V memory;
  vector<V> position;  // at the time of the next impulse
  vector<V> opening;   // half a step before: w
};
// The variables of a bond: its memory, from 0 to 1, and where it is.
constexpr auto bond_variables(const char* name, const char* doc) {
  using vec = vector<double>;
  using State = bond_state<double>;
  using variable = state_variable<State>;
  const auto part = [](vec State::*member, double vec::*component, const char* called, const char* says,
                       bool internal) {
    return variable{
        .member = {member, component}, .name = called, .unit = "m", .doc = says, .internal = internal};
  };
  return std::array<variable, 7>{
      variable{.member = &State::memory, .name = name, .doc = doc, .minimum = 0.0, .maximum = 1.0},
      part(&State::position, &vec::n, "opening", "Normal displacement since the start.", false),
      part(&State::position, &vec::t1, "slip_1", "First tangential displacement.", false),
      part(&State::position, &vec::t2, "slip_2", "Second tangential displacement.", false),
      part(&State::opening, &vec::n, "mean_opening", "Mean of the last two openings.", true),
      part(&State::opening, &vec::t1, "mean_slip_1", "Mean of the last two of slip_1.", true),
      part(&State::opening, &vec::t2, "mean_slip_2", "Mean of the last two of slip_2.", true)};
}

// What is the same at all nodes. weight: of the tangential opening, see W; root: its square root.
template <class V>
struct bond_common {
  step_sizes step;
  V weight, root, per_root;
  bond_common(const step_sizes& s, V w) : step(s), weight(w), root(square_root(w)), per_root(1.0 / root) {}
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
  a.rate = select(where, other.rate, a.rate);
  a.status = select(where, other.status, a.status);
  a.refused = select(where, other.refused, a.refused);
}

// ---- a node that a bond holds

// M = (I + kappa A)^-1, A = W^1/2 H W^1/2/h_N, as far as H and what a trial kappa makes of it are concerned.
template <class V, class Delassus>
class bonded_inertia;

template <class V>
class bonded_inertia<V, transverse<V>> {
 public:
  struct held {
    V kappa, left_n, left_t;
  };
  ILAW_KIT_INLINE bonded_inertia(const transverse<V>& h, const bond_common<V>& all)
      : h_(h), per_normal_(1.0 / h.n), weight_(all.weight), ratio_(weight_ * h.t * per_normal_) {}
  ILAW_KIT_INLINE V per_normal() const { return per_normal_; }
  ILAW_KIT_INLINE V trace() const { return 1.0 + 2.0 * ratio_; }

  ILAW_KIT_INLINE held hold(V kappa) const {
    const V of_n = 1.0 + kappa, of_t = 1.0 + ratio_ * kappa;
    if constexpr (std::is_same_v<V, double>) return {kappa, 1.0 / of_n, 1.0 / of_t};  // of extreme scales
    const V both = 1.0 / (of_n * of_t);
    return {kappa, both * of_t, both * of_n};
  }
  // What is left of a free motion, W^-1/2 M W^1/2 d, and H as the node has it now.
  ILAW_KIT_INLINE vector<V> left(const held& m, vector<V> d) const {
    return {m.left_n * d.n, m.left_t * d.t1, m.left_t * d.t2};
  }
  ILAW_KIT_INLINE transverse<V> delassus(const held& m) const { return {m.left_n * h_.n, m.left_t * h_.t}; }
  // -w^+.W d(w^+)/d(kappa), where w^+ + w^- = left(d). A closed node does not move along its normal.
  ILAW_KIT_INLINE V gives_way(const held& m, vector<V> after, vector<V> d, mask_of<V> closed) const {
    const V normal = zero_unless(!closed, m.left_n * m.left_n * normal_product(d, after));
    return normal + ratio_ * weight_ * m.left_t * m.left_t * tangential_product(d, after);
  }
  ILAW_KIT_INLINE mask_of<V> is_smooth(mask_of<V> /*closed*/) const { return !none<V>(); }
  // Of the bond, on a node that would move by d, and of a contact beside it, which stops a closed node from
  // closing, whatever the bond does.
  ILAW_KIT_INLINE vector<V> impulse(const held& m, vector<V> d, V per_step, vector<V> contact,
                                    mask_of<V> closed, V closing) const {
    const V twice = 2.0 * per_step, normal = twice * taken(m.kappa, m.left_n) * d.n;
    const V by_t = 1.0 / h_.t, shear = twice * taken(ratio_ * m.kappa, m.left_t) * by_t;
    return {-(select(closed, closing, normal) * per_normal_), m.left_t * contact.t1 - shear * d.t1,
            m.left_t * contact.t2 - shear * d.t2};
  }

 private:
  // kappa/(1 + kappa), what is not left: with all its digits also where that is little.
  ILAW_KIT_INLINE static V taken(V kappa, V left) { return select(kappa > 1.0, 1.0 - left, kappa * left); }

  transverse<V> h_;
  V per_normal_, weight_, ratio_;
};

template <class V>
class bonded_inertia<V, full<V>> {
 public:
  // LDL^T without quotients but one: the minors are a, d = a d_1 and e = a d d_2.
  struct held {
    V kappa, by_d0, by_d1, by_d2, l10, l20, l21;
    ILAW_KIT_INLINE vector<V> solve(vector<V> v) const {
      const V y1 = v.t1 - l10 * v.n, y2 = (v.t2 - l20 * v.n) - l21 * y1;
      const V x2 = by_d2 * y2, x1 = y1 * by_d1 - l21 * x2;
      return {(v.n * by_d0 - l10 * x1) - l20 * x2, x1, x2};
    }
  };
  ILAW_KIT_INLINE bonded_inertia(const full<V>& h, const bond_common<V>& all)
      : normal_(h.nn), per_normal_(1.0 / h.nn), root_(all.root), per_root_(all.per_root) {
    const V w = root_ * per_normal_, ww = all.weight * per_normal_;
    a_ = {1.0, ww * h.t11, ww * h.t22, w * h.n1, w * h.n2, ww * h.t12};
  }
  ILAW_KIT_INLINE V per_normal() const { return per_normal_; }
  ILAW_KIT_INLINE V trace() const { return 1.0 + (a_.t11 + a_.t22); }

  ILAW_KIT_INLINE held hold(V k) const {
    const V a = 1.0 + k, n1 = k * a_.n1, n2 = k * a_.n2;
    const V d = a * (1.0 + k * a_.t11) - n1 * n1, f = a * (k * a_.t12) - n1 * n2;
    const V e = d * (a * (1.0 + k * a_.t22) - n2 * n2) - f * f, ad = a * d, inverse = 1.0 / (ad * e);
    const V by_a = inverse * (d * e), by_d = inverse * (a * e);
    return {k, by_a, a * by_d, ad * (inverse * ad), n1 * by_a, n2 * by_a, f * by_d};
  }
  ILAW_KIT_INLINE vector<V> left(const held& m, vector<V> d) const {
    return times_root(m.solve(times_root(d, root_)), per_root_);
  }
  full<V> delassus(const held& m) const {  // h_N W^-1/2 M A W^-1/2
    const vector<V> n = m.solve({1.0, a_.n1, a_.n2}), t1 = m.solve({a_.n1, a_.t11, a_.t12}),
                    t2 = m.solve({a_.n2, a_.t12, a_.t22});
    const V one = normal_ * per_root_, two = one * per_root_;
    return {normal_ * n.n, two * t1.t1, two * t2.t2, one * n.t1, one * n.t2, two * t2.t1};
  }
  ILAW_KIT_INLINE V gives_way(const held& m, vector<V> after, vector<V> d, mask_of<V>) const {
    const vector<V> sum = m.solve(times_root(d, root_));
    return product(times_root(after, root_), m.solve(a_.times(sum)));
  }
  ILAW_KIT_INLINE mask_of<V> is_smooth(mask_of<V> closed) const { return !closed; }
  ILAW_KIT_INLINE vector<V> impulse(const held& m, vector<V> d, V per_step, vector<V> contact, mask_of<V>,
                                    V) const {
    const V taken = 2.0 * m.kappa * per_step * per_normal_;
    return times_root(m.solve(times_root(contact, per_root_) - taken * times_root(d, root_)), root_);
  }

 private:
  ILAW_KIT_INLINE static vector<V> times_root(vector<V> a, V by) { return {a.n, by * a.t1, by * a.t2}; }

  V normal_, per_normal_, root_, per_root_;
  full<V> a_;
};

// ---- one bonded node in one step

template <class V, class Delassus>
class bond_step {
 public:
  using number = V;
  using mask = mask_of<V>;

  // What a mean stiffness and a coefficient of friction make of the node.
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
        sticks = m.rubs & (apply_isotropic_friction(n, contact, friction) == status::stick);
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

// What comes of a step. left: to the scalar fallback.
template <class Step>
struct bond_result {
  using V = typename Step::number;
  typename Step::motion motion;
  V memory;
  mask_of<V> holds, left = none<V>();
  V refused = 0.0;

  ILAW_KIT_INLINE explicit bond_result(V before) : memory(before) {}
};

// ---- the law

template <template <class> class Law, class V>
struct adhesive_bond {
  using state = bond_state<V>;
  using problem = bond_problem<V>;
  using answer = bond_answer<V>;

  // At once: bonds that surely stand still, and, where H does not couple, contact without bond and bonds that
  // stay as they are.
  template <class Node>
  ILAW_KIT_INLINE asked<V> ask(Node& node, problem& p) const {
    const mask_of<V> may_hold = is_bonded(node.state.memory, node.area), bonded = may_hold & makes_bond();
    status_of<V> status = status::free;
    mask_of<V> open = none<V>();
    if (any(!bonded)) {
      const auto touching = contact(node);
      if constexpr (is_transverse<Node>)
        status = apply_isotropic_friction(node, touching, law().friction);
      else
        open = (!bonded) & (touching.slack <= 0.0) & (touching.q.n < 0.0);
    }
    if (any(bonded)) {
      mask_of<V> stands = none<V>();
      if constexpr (can_be_rigid()) stands = stand(node, bonded);
      open = open | (bonded & !stands);
      status = select(stands, status_of<V>(status::bonded), status);
    }
    if (any(open)) {
      p = {as_full(node.delassus), node.v_free, node.v_previous, node.gap, node.area, node.state};
      if constexpr (is_transverse<Node>) {
        const mask_of<V> changes = (node.state.memory != 1.0 - Law<V>::broken) & opens(node);
        if (any(open & !changes)) {
          answer a;
          if (const mask_of<V> stays = stay(p, open, a, node.prepared); any(stays)) {
            give(node, a, stays);
            status = select(stays, status_of<V>(status::bonded), status);
            open = open & !stays;
          }
        }
      }
    }
    if (const mask_of<V> lost = may_hold & !bonded; any(lost)) {
      node.state.memory = select(lost, V(Law<V>::broken), node.state.memory);
      status = select(lost, status_of<V>(status::broken), status);
    }
    return {open, status};
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
    give(node, a, !none<V>());
    return status_of<V>::from(a.status);
  }

  // The coefficient of friction with the mean memory of the step, as the bond has its mean traction: second
  // order. An infinite one would jump as the memory first changes, and is that before the step.
  ILAW_KIT_INLINE V mean_friction(V before, V after) const {
    return law().friction_of(select(law().friction < infinity, 0.5 * (before + after), before));
  }

 private:
  using mask = mask_of<V>;
  static constexpr bool is_scalar = std::is_same_v<V, double>;
  ILAW_KIT_INLINE mask makes_bond() const {
    if constexpr (requires(const Law<V>& l) { l.bonds(); })
      return law().bonds();
    else
      return !none<V>();
  }
  ILAW_KIT_INLINE const Law<V>& law() const { return static_cast<const Law<V>&>(*this); }

  ILAW_KIT_INLINE static full<V> as_full(const full<V>& h) { return h; }
  ILAW_KIT_INLINE static full<V> as_full(const transverse<V>& h) { return {h.n, h.t, h.t, 0.0, 0.0, 0.0}; }
  ILAW_KIT_INLINE static mask is_bonded(V memory, V area) {
    return (memory != Law<V>::broken) & (area > 0.0);
  }

  // ---- without bond

  template <class Node>
  ILAW_KIT_INLINE static auto contact(const Node& node) {
    return contact_problem_of(contact_at(node, 0.0, predictive), node.v_free, node.v_previous);
  }
  struct touching_node {
    using number = V;
    V gap;
    vector<V> v_free, v_previous;
    double position_step, per_position_step;
  };
  // Contact with any H, as coulomb; returns the lanes left.
  mask touch(const problem& p, const step_sizes& step, answer& a) const {
    const touching_node node{p.gap, p.v_free, p.v_previous, step.position_step, step.per_position_step};
    friction_problem<V> pressed;
    friction_answer<V> found;
    fill(pressed, p.h, contact(node), law().friction, law().friction);
    mask left = solve_friction(pressed, found);
    if constexpr (is_scalar)
      if (left) solve_friction_exactly(pressed, found);
    a.impulse = {found.r[0], found.r[1], found.r[2]};
    a.status = found.status;
    a.refused = found.refused;
    return left;
  }

  // ---- a bond that stays as it is

  // Rigid, up to its strength: the node is stopped. Where that would do work it is left to the solver.
  template <class Node>
  ILAW_KIT_INLINE mask stand(Node& node, mask bonded) const {
    const mask rigid = bonded & law().is_rigid(node.state.memory);
    if (!any(rigid)) return rigid;
    const vector<V> r = -node.delassus.solve(node.v_free);
    const mask takes = product(r, velocity_before(node.v_previous, node.v_free)) <= 0.0;
    const mask stands = rigid & takes & law().surely_bears(r, node.velocity_step * node.area);
    node.impulse = select(stands, r, node.impulse);
    return stands;
  }
  // A bond that has changed before and opens further most likely changes: it is left to the solver untried.
  template <class Node>
  ILAW_KIT_INLINE static mask opens(const Node& node) {
    return product(node.state.opening, node.v_free) > 0.0;
  }
  template <class Common>
  [[gnu::noinline]] mask stay(const problem& p, mask open, answer& a, const Common& common) const {
    const transverse<V> h{p.h.nn, p.h.t11};
    const bond_step<V, transverse<V>> step(h, p, common);
    bond_result<bond_step<V, transverse<V>>> found(p.state.memory);
    law().as_it_was(step, p.state.memory, common, found);
    const mask stays = open & found.holds & !put_in(step, found.motion);
    if (any(stays)) a = step.answer(found.motion, found.memory, status::bonded, 0.0);
    return stays;
  }
  template <class Step>
  ILAW_KIT_INLINE static mask put_in(const Step& step, const typename Step::motion& m) {
    if (!any(step.is_new)) return step.is_new;
    return step.is_new & (step.taken_from_before(m) < 0.0);
  }

  // ---- a bond that changes

  template <class Common>
  mask solve_with(const problem& p, answer& a, const Common& common) const {
    const mask may_hold = is_bonded(p.state.memory, p.area), bonded = may_hold & makes_bond();
    const mask even = (p.h.n1 == 0.0) & (p.h.n2 == 0.0) & (p.h.t12 == 0.0) & (p.h.t11 == p.h.t22);
    mask left = none<V>();
    a = unmoved(p, {}, V(status::free.code));
    if (any(!bonded)) {
      left = (!bonded) & touch(p, common.step, a);
      const mask lost = may_hold & !bonded;
      a.state.memory = select(lost, V(Law<V>::broken), a.state.memory);
      a.status = select(lost, V(status::broken.code), a.status);
    }
    if (any(bonded & even))
      left = left | solve_bond(transverse<V>{p.h.nn, p.h.t11}, p, bonded & even, a, common);
    if (any(bonded & !even)) left = left | solve_bond(p.h, p, bonded & !even, a, common);
    return left;
  }

  template <class Delassus, class Common>
  [[gnu::noinline]] mask solve_bond(const Delassus& h, const problem& p, mask where, answer& a,
                                    const Common& common) const {
    mask open = where;
    if constexpr (can_be_rigid()) open = open & !stop(h, p, where, a, common.step);
    if (!any(open)) return open;
    bond_step<V, Delassus> step(h, p, common);
    bond_result<bond_step<V, Delassus>> found(p.state.memory);
    respond(step, open, common, found);
    const V sum = found.motion.size + step.before;
    const mask has_scale = is_scalar ? found.holds | !found.holds : (sum > 0x1p-200) & (sum < 0x1p200);
    mask left = found.left | found.motion.unsolved | !(found.holds | has_scale);
    const mask gains = open & put_in(step, found.motion);
    if (any(gains)) {
      if constexpr (is_scalar)
        make_before(step, common, found);
      else
        left = left | gains;
    }
    const auto reached =
        select(found.memory == Law<V>::broken, status_of<V>(status::broken), status_of<V>(status::bonded));
    choose(open, step.answer(found.motion, found.memory, reached, found.refused), a);
    return open & left;
  }
  static constexpr bool can_be_rigid() {
    return requires(const Law<V>& l, V x) { l.is_rigid(x); };
  }
  template <class Delassus>
  mask stop(const Delassus& h, const problem& p, mask where, answer& a, const step_sizes& step) const {
    const mask rigid = where & law().is_rigid(p.state.memory);
    if (!any(rigid)) return rigid;
    const vector<V> r = stopping_impulse(h, p.v_free, p.v_previous);
    const mask stands = rigid & law().bears(r, step.velocity_step * p.area);
    choose(stands, unmoved(p, r, V(status::bonded.code)), a);
    return stands;
  }
  template <class Step, class Common>
  void respond(const Step& step, mask open, const Common& common, bond_result<Step>& found) const {
    const V before = step.problem().state.memory;
    found.memory = before;
    found.left = none<V>();
    found.refused = 0.0;
    law().as_it_was(step, before, common, found);
    if (const mask changes = open & !found.holds; any(changes)) law().change(step, changes, common, found);
  }
  // Where a bond that is made in this step, at the node's position, would put energy in, it is made before,
  // at the least part of half a step at which it does not.
  template <class Step, class Common>
  void make_before(Step& step, const Common& common, bond_result<Step>& found) const {
    if (found.refused != 0.0) return;
    const auto taken = [&](double part) {
      step.make_before(part);
      respond(step, true, common, found);
      return step.taken_from_before(found.motion);
    };
    const double first = taken(0.0), last = taken(1.0);
    double part = 1.0;
    if (last > 0.0)
      part = root_between(0.0, 1.0, 0.0, true, [&](double x) {
        return root_trial<double>{taken(x), last - first, last - first, 1.0, false};
      });
    for (double more = 0x1p-52; taken(part) < 0.0 && part < 1.0; more *= 2.0)
      part = smaller(part + more, 1.0);
  }

  // ---- what a node is given

  template <class Node>
  ILAW_KIT_INLINE void give(Node& node, const answer& a, mask where) const {
    if (node.wants_energy) {
      const state before = node.state;
      const energies e = energies_of(before, a, node.area, node.prepared);
      node.normal_gain = zero_unless(where, e.normal_gain);
      node.tangential_gain = zero_unless(where, e.tangential_gain);
      node.stored = zero_unless(where, e.stored);
      node.rupture = zero_unless(where, e.rupture);
    }
    node.impulse = select(where, a.impulse, node.impulse);
    node.state.memory = select(where, a.state.memory, node.state.memory);
    node.state.position = select(where, a.state.position, node.state.position);
    node.state.opening = select(where, a.state.opening, node.state.opening);
  }
  struct energies {
    V normal_gain, tangential_gain, stored, rupture;
  };
  template <class Common>
  [[gnu::noinline]] energies energies_of(const state& before, const answer& a, V area,
                                         const Common& common) const {
    const V weight = common.weight, rate = a.rate;
    const vector<V> sum = a.state.opening + before.opening, change = a.state.opening - before.opening;
    const auto stored = [&](const state& s) ILAW_KIT_LAMBDA {
      const V square =
          normal_product(s.opening, s.opening) + weight * tangential_product(s.opening, s.opening);
      return area * law().energy(s.memory, square_root(square), common);
    };
    const V normal = rate * normal_product(sum, change),
            shear = rate * weight * tangential_product(sum, change);
    const V after = stored(a.state);
    return {normal, shear, after, positive_part(normal + shear - (after - stored(before)))};
  }
};

}  // namespace ilaw::kit
