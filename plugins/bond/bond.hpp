// bond.hpp - the step common to all bonds, with contact and friction for any H. The law gives stiffness,
// evolution and energy; docs/theory/bonds.md derives the equations.
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
//   broken_part(memory, all)           of the area, on which friction acts: 0 of an intact bond
//   energy(memory, size, all)          stored per area; size^2 = w.W w
//   as_it_was(step, memory, all, found)   the motion with the memory before, and where it holds
//   change(step, where, all, found)    motion and memory where it does not
// and may have
//   bonds()                            whether these parameters make a bond at all
// and, where a bond may be rigid, is_rigid(memory), bears(impulse, capacity) and a quick surely_bears.
#pragma once

#include <ilaw/kit/roots.hpp>
#include "bond_step.hpp"

namespace bond_law::inline ILAW_KIT_LEVEL {

using namespace ilaw::kit;

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
        // Of these lanes alone: whether a node is open must not depend on its neighbours.
        const mask_of<V> tried = open & !((node.state.memory != 1.0 - Law<V>::broken) & opens(node));
        if (any(tried)) {
          answer a;
          if (const mask_of<V> stays = stay(p, tried, a, node.prepared); any(stays)) {
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
  template <class Common>
  ILAW_KIT_INLINE V mean_friction(V before, V after, const Common& common) const {
    return friction_of(select(law().friction < infinity, 0.5 * (before + after), before), common);
  }
  template <class Common>
  ILAW_KIT_INLINE V friction_of(V memory, const Common& common) const {
    const V part = law().broken_part(memory, common);
    return zero_unless(part > 0.0, law().friction * part);
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
    node.rubbing = zero_unless(!stands, node.rubbing);
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
    const mask has_scale = is_scalar ? ilaw::kit::all<V>() : (sum > 0x1p-200) & (sum < 0x1p200);
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
      const V part = law().broken_part(0.5 * (before.memory + a.state.memory), node.prepared);
      node.rubbing = select(where, part, node.rubbing);
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

}  // namespace bond_law
