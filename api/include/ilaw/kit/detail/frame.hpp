// frame.hpp - what all laws have at a node, from the arrays of a view: the local frame, made of the normals
// (and tangents) that a host gives in its axes, and H of any form; and which nodes are bad.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit/detail/view.hpp>
#include <ilaw/kit/vector.hpp>

namespace ilaw::kit::inline ILAW_KIT_LEVEL::detail {

template <class V>
ILAW_KIT_INLINE mask_of<V> is_unit(axis<V> a) {
  return absolute(dot(a, a) - 1.0) <= unit_tolerance;
}
template <class V>
ILAW_KIT_INLINE mask_of<V> are_orthogonal(axis<V> a, axis<V> b) {
  return absolute(dot(a, b)) <= unit_tolerance;
}

// A tangent of a unit normal without branch or square root (Duff et al. 2017, Building an orthonormal basis).
template <class V>
ILAW_KIT_INLINE axis<V> any_tangent(axis<V> n) {
  using bits = bits_of<V>;
  constexpr std::uint64_t sign_bit = 0x8000000000000000;
  const V sign = bits::number((bits::in(n.z) & bits::of(sign_bit)) | bits::in(V(1.0)));
  const V a = -1.0 / (sign + n.z);
  return {1.0 + sign * n.x * n.x * a, sign * (n.x * n.y * a), -sign * n.x};
}

// Carries a tangent from one normal to the next by the shortest rotation, which turns nothing about the
// normal. For t orthogonal to n it is the reflection at the plane orthogonal to m = n + n', R t = t - 2
// (t.m)/(m.m) m (from Rodrigues' formula), accurate for every angle. Where the normal has turned to its
// opposite all rotations are as short: it is then the half turn about the tangent, which stays.
template <class V>
ILAW_KIT_INLINE axis<V> transported_tangent(axis<V> before, axis<V> tangent, axis<V> n) {
  const axis<V> m{before.x + n.x, before.y + n.y, before.z + n.z};
  const V square = dot(m, m);
  const V s = zero_unless(square > unit_tolerance * unit_tolerance, 2.0 * dot(tangent, m) / square);
  const axis<V> moved{tangent.x - s * m.x, tangent.y - s * m.y, tangent.z - s * m.z};
  const V residue = dot(moved, n);  // rounding must not accumulate over millions of steps
  const axis<V> flat{moved.x - residue * n.x, moved.y - residue * n.y, moved.z - residue * n.z};
  const V inverse = 1.0 / square_root(dot(flat, flat));
  return {inverse * flat.x, inverse * flat.y, inverse * flat.z};
}

// The batch is in the local frame.
template <class V>
struct local_frame {
  using vector_type = vector<V>;
  static constexpr bool turns = false, has_normal = false, has_axes = false;

  ILAW_KIT_INLINE vector<V> to_local(axis<V> a) const { return {a.x, a.y, a.z}; }
  ILAW_KIT_INLINE axis<V> to_global(vector<V> a) const { return {a.n, a.t1, a.t2}; }
  template <class Delassus>
  ILAW_KIT_INLINE Delassus to_local(Delassus h, int /*dimension*/) const {
    return h;
  }
};

// The normal alone: enough for laws that are isotropic in the tangent plane.
template <class V>
struct normal_frame {
  using vector_type = projected<V>;
  static constexpr bool turns = true, has_normal = true, has_axes = false;
  axis<V> n;

  static constexpr bool turns_now() { return true; }
  ILAW_KIT_INLINE projected<V> to_local(axis<V> a) const {
    const V normal = dot(n, a);
    return {normal, a.x - normal * n.x, a.y - normal * n.y, a.z - normal * n.z};
  }
  ILAW_KIT_INLINE axis<V> to_global(projected<V> a) const {
    return {a.x + a.n * n.x, a.y + a.n * n.y, a.z + a.n * n.z};
  }
  template <class Delassus>
  ILAW_KIT_INLINE Delassus to_local(Delassus h, int /*dimension*/) const {
    return h;
  }
};

// All axes, the rows of a rotation.
template <class V>
struct axes_frame {
  using vector_type = vector<V>;
  static constexpr bool turns = true, has_normal = true, has_axes = true;
  axis<V> n, t1, t2;

  static constexpr bool turns_now() { return true; }
  ILAW_KIT_INLINE vector<V> to_local(axis<V> a) const { return {dot(n, a), dot(t1, a), dot(t2, a)}; }
  ILAW_KIT_INLINE axis<V> to_global(vector<V> a) const {
    return {a.n * n.x + a.t1 * t1.x + a.t2 * t2.x, a.n * n.y + a.t1 * t1.y + a.t2 * t2.y,
            a.n * n.z + a.t1 * t1.z + a.t2 * t2.z};
  }
  ILAW_KIT_INLINE transverse<V> to_local(transverse<V> h, int /*dimension*/) const { return h; }
  ILAW_KIT_INLINE transverse_spin<V> to_local(transverse_spin<V> h, int /*dimension*/) const { return h; }
  // B H B^T. In the plane the second tangent is given the entry of the first, lest H pass for anisotropic.
  ILAW_KIT_INLINE full<V> to_local(full<V> h, int dimension) const {
    if (dimension == 2) h.t22 = t1.x * t1.x * h.nn + t1.y * t1.y * h.t11 + 2.0 * t1.x * t1.y * h.n1;
    const vector<V> a = to_local(h.row_times(n)), b = to_local(h.row_times(t1)),
                    c = to_local(h.row_times(t2));
    return {a.n, b.t1, c.t2, a.t1, a.t2, b.t2};
  }

  // In the plane the tangent is the normal turned by a right angle; on the line it is never used.
  ILAW_KIT_INLINE void turn_in_plane(int dimension) {
    t1 = {0.0, 1.0, 0.0};
    if (dimension == 2) t1 = {-n.y, n.x, 0.0};
  }
};

// One of the two, as the batch says: for the careful loop, which is compiled once for both.
template <class V>
struct either_frame : axes_frame<V> {
  using base = axes_frame<V>;
  bool is_local = false;

  ILAW_KIT_INLINE bool turns_now() const { return !is_local; }
  ILAW_KIT_INLINE vector<V> to_local(axis<V> a) const {
    return is_local ? vector<V>{a.x, a.y, a.z} : base::to_local(a);
  }
  ILAW_KIT_INLINE axis<V> to_global(vector<V> a) const {
    return is_local ? axis<V>{a.n, a.t1, a.t2} : base::to_global(a);
  }
  template <class Delassus>
  ILAW_KIT_INLINE Delassus to_local(Delassus h, int dimension) const {
    return is_local ? h : base::to_local(h, dimension);
  }
};

// Spins and moments as nodes have them: the normal component of w, and w x n; and back, by n x (w x n) = w_T.
template <class Frame, class V>
ILAW_KIT_INLINE vector<V> spin_to_local(const Frame& frame, axis<V> w) {
  const vector<V> a = frame.to_local(w);
  return {a.n, a.t2, 0.0 - a.t1};
}
template <class V>
ILAW_KIT_INLINE projected<V> spin_to_local(const normal_frame<V>& frame, axis<V> w) {
  const axis<V> u = cross(w, frame.n);
  return {dot(frame.n, w), u.x, u.y, u.z};
}
template <class Frame, class V>
ILAW_KIT_INLINE axis<V> spin_to_global(const Frame& frame, vector<V> u) {
  return frame.to_global({u.n, 0.0 - u.t2, u.t1});
}
template <class V>
ILAW_KIT_INLINE axis<V> spin_to_global(const normal_frame<V>& frame, projected<V> u) {
  const axis<V> w = cross(frame.n, axis<V>{u.x, u.y, u.z});
  return frame.to_global({u.n, w.x, w.y, w.z});
}

// ---- bad nodes

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
// Diagonal or full. In fewer dimensions than three it is filled up, so that it stays positive definite and
// does not pass for anisotropic.
template <class V, class View>
ILAW_KIT_INLINE void load_delassus(full<V>& h, const View& b, std::int64_t i) {
  const auto& a = b.delassus;
  if (a.count == 6) {
    V c[6];
    load_numbers(c, a, i);
    h.nn = c[0], h.t11 = c[1], h.t22 = c[2], h.n1 = c[3], h.n2 = c[4], h.t12 = c[5];
    return;
  }
  axis<V> d;
  V unused = 0.0;
  load_vector(d, a, i, unused);
  h.nn = d.x, h.t11 = d.y, h.t22 = d.z;
  h.n1 = 0.0, h.n2 = 0.0, h.t12 = 0.0;
  if (b.dimension == 3) return;
  if (b.dimension == 1) h.t11 = h.nn;
  h.t22 = h.t11;
  if (a.count == 3) h.n1 = d.z;
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
