// bonded_inertia.hpp - the inertia of a node that a bond (bond.hpp) holds.
#pragma once

#include <ilaw/kit/law.hpp>
#include <ilaw/kit/vector.hpp>

namespace bond_law::inline ILAW_KIT_LEVEL {

using namespace ilaw::kit;

// Values that all nodes share. weight: of the tangential opening, see W; root: its square root.
template <class V>
struct bond_common {
  step_sizes step;
  V weight, root, per_root;
  bond_common(const step_sizes& s, V w) : step(s), weight(w), root(square_root(w)), per_root(1.0 / root) {}
};

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
  // The part of a free motion d that the bond leaves, W^-1/2 M W^1/2 d, and H with the bond.
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
  // Impulse of the bond on a node that would move by d, and of a contact beside it, which stops a closed
  // node from closing, whatever the bond does.
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

}  // namespace bond_law
