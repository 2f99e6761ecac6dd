// load_node.hpp - what all laws have at a node, from the arrays of a view: H of any form and the local frame;
// and which nodes are bad.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit/detail/frame.hpp>
#include <ilaw/kit/detail/view.hpp>

namespace ilaw::kit::inline ILAW_KIT_LEVEL::detail {

// Finds bad lanes: a product of all numbers that must be finite, zero where they are. Careful: and why.
template <class V, bool Careful>
struct checks {
  V found = 0.0;

  ILAW_KIT_INLINE void finite(V x, reason) { found = found * x; }
  template <class Vector>
  ILAW_KIT_INLINE void finite_vector(Vector a, reason, bool /*of_frame*/ = false) {
    found = residual(a, found);
  }
  ILAW_KIT_INLINE void require(mask_of<V> good, reason) { found = nan_unless(good, found); }
  ILAW_KIT_INLINE void frame(mask_of<V>) {}
  ILAW_KIT_INLINE mask_of<V> bad() const { return !(found == 0.0); }
};
template <class V>
struct checks<V, true> {
  V code = 0.0;
  mask_of<V> framed = all<V>();

  ILAW_KIT_INLINE void require(mask_of<V> good, reason why) {
    code = select((code == 0.0) & (!good), V(static_cast<double>(why)), code);
  }
  ILAW_KIT_INLINE void finite(V x, reason why) { require(0.0 * x == 0.0, why); }
  // A vector that was turned by a frame that is none says nothing.
  template <class Vector>
  ILAW_KIT_INLINE void finite_vector(Vector a, reason why, bool of_frame = false) {
    const auto good = residual(a, V(0.0)) == 0.0;
    require(of_frame ? good | !framed : good, why);
  }
  ILAW_KIT_INLINE void frame(mask_of<V> good) { framed = good; }
  ILAW_KIT_INLINE mask_of<V> bad() const { return code != 0.0; }
};

// ---- H

// Diagonal with three entries, or full with six; of copies always all six.
template <class V, class Array>
ILAW_KIT_INLINE void load_symmetric(full<V>& h, const Array& a, std::int64_t i) {
  if (a.count == 6) {
    V c[6];
    load_numbers(c, a, i);
    h.nn = c[0], h.t11 = c[1], h.t22 = c[2], h.n1 = c[3], h.n2 = c[4], h.t12 = c[5];
  } else {
    axis<V> d;
    V unused = 0.0;
    load_vector(d, a, i, unused);
    h.nn = d.x, h.t11 = d.y, h.t22 = d.z;
    h.n1 = 0.0, h.n2 = 0.0, h.t12 = 0.0;
  }
}
// H = diag(h_N, h_T, h_T), of one number or two.
template <class V, class View>
ILAW_KIT_INLINE void load_delassus(transverse<V>& h, const View& b, std::int64_t i) {
  const auto& a = b.delassus;
  if (b.is_scalar) {
    h.n = load<V>(a.at + i);
    h.t = h.n;
  } else {
    V c[2];
    load_numbers(c, a, i);
    h.n = c[0], h.t = c[1];
  }
}
template <class V, class View>
ILAW_KIT_INLINE void load_delassus(transverse_spin<V>& h, const View& b, std::int64_t i) {
  V c[5];
  load_numbers(c, b.delassus, i);
  h.n = c[0], h.t = c[1], h.k = c[2], h.j_n = c[3], h.j_t = c[4];
}
template <class V, class View>
ILAW_KIT_INLINE void load_delassus(full<V>& h, const View& b, std::int64_t i) {
  load_symmetric(h, b.delassus, i);
}

// ---- the local frame

// framed: whether the tangents are orthogonal to the normal, where they are given.
template <class V, template <class> class Frame, class View, class Checks>
ILAW_KIT_INLINE void load_frame(Frame<V>& f, const View& b, std::int64_t i, Checks& c, mask_of<V>& framed) {
  if constexpr (requires { f.is_local; }) {
    f.is_local = !b.normal.at;
    if (f.is_local) return;
  }
  if constexpr (Frame<V>::has_normal) {
    V unused = 0.0;
    load_vector(f.n, b.normal, i, unused);
    c.require(is_unit(f.n), reason_normal);
  }
  if constexpr (Frame<V>::has_axes) {
    if (b.tangents_from == tangents::of_plane) {
      f.turn_in_plane(b.dimension);
    } else if (b.tangents_from == tangents::chosen) {
      f.t1 = any_tangent(f.n);
    } else if (b.tangents_from == tangents::given) {
      V unused = 0.0;
      load_vector(f.t1, b.tangent, i, unused);
      framed = is_unit(f.t1) & are_orthogonal(f.n, f.t1);
      c.require(framed, reason_tangent);
    } else {
      V before[6];
      load_numbers(before, b.frame_in, i);
      const axis<V> n{before[0], before[1], before[2]}, t{before[3], before[4], before[5]};
      framed = is_unit(n) & is_unit(t) & are_orthogonal(n, t);
      f.t1 = transported_tangent(n, t, f.n);
    }
    f.t2 = cross(f.n, f.t1);
  }
}

}  // namespace ilaw::kit::detail
