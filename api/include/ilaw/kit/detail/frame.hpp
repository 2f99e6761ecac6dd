// frame.hpp - local frames of nodes, from the normals (and tangents) that a host gives in its
// axes.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit/node.hpp>

namespace ilaw::kit::inline ILAW_KIT_LEVEL::detail {

// Largest | |n|^2 - 1 | accepted: normals that went through single precision pass.
inline constexpr double unit_tolerance = 1e-6;

struct axis {
  double x, y, z;
};
using kit::defect;  // beside which this one stands
constexpr double defect(axis a) { return defect(a.x) * a.y * a.z; }
constexpr double dot(axis a, axis b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
constexpr axis cross(axis a, axis b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
constexpr bool unit(axis a) { return __builtin_fabs(dot(a, a) - 1.0) <= unit_tolerance; }

// By its bits: of a choice GCC makes two sets of stores, each beneath a mask. Old processors have no masks,
// and choose faster.
inline axis kept_if(bool condition, axis a) {
  if constexpr (is_for_old_processors)
    return {condition ? a.x : 0.0, condition ? a.y : 0.0, condition ? a.z : 0.0};
  else
    return {kit::kept_if(condition, a.x), kit::kept_if(condition, a.y), kit::kept_if(condition, a.z)};
}

// A tangent of a unit normal without branch or square root (Duff et al. 2017, Building an orthonormal basis).
inline axis any_tangent(axis n) {
  const double sign = __builtin_copysign(1.0, n.z);
  const double a = -1.0 / (sign + n.z);
  return {1.0 + sign * n.x * n.x * a, sign * (n.x * n.y * a), -sign * n.x};
}

constexpr bool orthogonal(axis a, axis b) { return __builtin_fabs(dot(a, b)) <= unit_tolerance; }

// Carries a tangent from one normal to the next by the shortest rotation, which turns nothing about the
// normal. For t orthogonal to n it is the reflection at the plane orthogonal to m = n + n',
// R t = t - 2 (t.m)/(m.m) m (from Rodrigues' formula), accurate for every angle. Where the normal has turned
// to its opposite all rotations are as short: it is then the half turn about the tangent, which stays.
inline axis transported_tangent(axis before, axis tangent, axis n) {
  const axis m{before.x + n.x, before.y + n.y, before.z + n.z};
  const double square = dot(m, m);
  const double s = square > unit_tolerance * unit_tolerance ? 2.0 * dot(tangent, m) / square : 0.0;
  const axis moved{tangent.x - s * m.x, tangent.y - s * m.y, tangent.z - s * m.z};
  const double residue = dot(moved, n);  // rounding must not accumulate over millions of steps
  const axis flat{moved.x - residue * n.x, moved.y - residue * n.y, moved.z - residue * n.z};
  const double inverse = 1.0 / square_root(dot(flat, flat));
  return {inverse * flat.x, inverse * flat.y, inverse * flat.z};
}

// In the plane the tangent is the normal turned by a right angle; on the line it is never used.
inline axis plane_tangent(int dimension, axis n) {
  return dimension == 2 ? axis{-n.y, n.x, 0.0} : axis{0.0, 1.0, 0.0};
}

// A local frame at a node, as the rows of a rotation.
struct basis {
  axis n, t1, t2;

  double unit_defect() const { return defect_unless(unit(n)); }
  vector to_local(axis a) const { return {dot(n, a), dot(t1, a), dot(t2, a)}; }
  axis to_global(vector a) const {
    return {a.n * n.x + a.t1 * t1.x + a.t2 * t2.x, a.n * n.y + a.t1 * t1.y + a.t2 * t2.y,
            a.n * n.z + a.t1 * t1.z + a.t2 * t2.z};
  }
  transverse_delassus to_local(transverse_delassus h) const { return h; }
  full_delassus to_local(const full_delassus& h) const {  // B H B^T
    const vector a = to_local(h.row_times(n)), b = to_local(h.row_times(t1)), c = to_local(h.row_times(t2));
    return {a.n, b.t1, c.t2, a.t1, a.t2, b.t2};
  }
};

// The numbers that a loop reads and writes in a block: doubles, or floats that stay in the host's arrays.
// Those are doubles once they are read, and rounded once as they are written.
template <class Number>
struct numbers_of {
  using number = Number;
  static const Number* in(const double* values) { return reinterpret_cast<const Number*>(values); }
  static Number* in(double* values) { return reinterpret_cast<Number*>(values); }
  static double at(const double* values, int i) { return in(values)[i]; }
};

// Where the three components of vector i stand: in three columns, or interleaved as in a (3,n) array, from
// one pointer so that the compiler sees that they are neighbours. has: whether vectors of the host stand so.
template <class Number>
struct columns_of : numbers_of<Number> {
  static axis get(const double* const* c, int i) {
    return {columns_of::at(c[0], i), columns_of::at(c[1], i), columns_of::at(c[2], i)};
  }
  static void put(double* const* c, int i, axis a) {
    columns_of::in(c[0])[i] = static_cast<Number>(a.x);
    columns_of::in(c[1])[i] = static_cast<Number>(a.y);
    columns_of::in(c[2])[i] = static_cast<Number>(a.z);
  }
  template <class Array>
  static bool has(const Array& a) {
    return a.node_stride == 1;
  }
};
template <class Number>
struct interleaved_of : numbers_of<Number> {
  static axis get(const double* const* c, int i) {
    const Number* const rows = interleaved_of::in(c[0]);
    return {rows[3 * i], rows[3 * i + 1], rows[3 * i + 2]};
  }
  static void put(double* const* c, int i, axis a) {
    Number* const rows = interleaved_of::in(c[0]);
    rows[3 * i] = static_cast<Number>(a.x);
    rows[3 * i + 1] = static_cast<Number>(a.y);
    rows[3 * i + 2] = static_cast<Number>(a.z);
  }
  template <class Array>
  static bool has(const Array& a) {
    return a.node_stride == 3 && a.component_stride == 1;
  }
};
struct columns : columns_of<double> {};
struct interleaved : interleaved_of<double> {};
struct interleaved_with_state : interleaved {};  // whose state is a row, too
struct columns_of_float : columns_of<float> {};
struct rows_of_float : interleaved_of<float> {};

template <class Layout>
inline constexpr bool is_of_floats = std::is_same_v<typename Layout::number, float>;
// Whether vectors are read and written in the host's arrays, and never copied.
template <class Layout>
inline constexpr bool is_in_place = is_of_floats<Layout> || std::is_base_of_v<interleaved, Layout>;
template <class Layout>
inline constexpr bool has_state_rows = std::is_same_v<Layout, interleaved_with_state>;

// The three ways in which a kernel gets its frames: none needed, from the normals alone, or stored. axes:
// three columns of the normal, then three each of the tangents where they are stored.
struct no_turn {
  double unit_defect() const { return 0.0; }
  vector to_local(axis a) const { return {a.x, a.y, a.z}; }
  axis to_global(vector a) const { return {a.n, a.t1, a.t2}; }
  template <class Delassus>
  Delassus to_local(Delassus h) const {
    return h;
  }
};
struct local_frame {
  using vector_type = vector;
  template <class Layout>
  static no_turn at(const double* const* /*axes*/, int /*i*/) {
    return {};
  }
};

// The normal alone: enough for laws that are isotropic in the tangent plane.
struct projection {
  axis n;

  double unit_defect() const { return defect_unless(unit(n)); }
  projected_vector to_local(axis a) const {
    const double normal = dot(n, a);
    return {normal, a.x - normal * n.x, a.y - normal * n.y, a.z - normal * n.z};
  }
  axis to_global(projected_vector a) const { return {a.x + a.n * n.x, a.y + a.n * n.y, a.z + a.n * n.z}; }
  transverse_delassus to_local(transverse_delassus h) const { return h; }
};
struct normal_frame {
  using vector_type = projected_vector;
  template <class Layout>
  static projection at(const double* const* axes, int i) {
    return {Layout::get(axes, i)};
  }
};
struct stored_frame {
  using vector_type = vector;
  template <class Layout>
  static basis at(const double* const* axes, int i) {
    return {columns::get(axes, i), columns::get(axes + 3, i), columns::get(axes + 6, i)};
  }
};

}  // namespace ilaw::kit::detail
