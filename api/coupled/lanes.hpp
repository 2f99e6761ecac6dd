// lanes.hpp - four numbers of a column at a time, in the vector types of GCC and clang.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

namespace ilaw::coupled {

inline constexpr std::size_t lane_count = 4;
using Lanes [[gnu::vector_size(8 * lane_count), gnu::may_alias, gnu::aligned(8)]] = double;

// Pointers, because clang takes a reference that a function returns to be aligned as usual, to 32 bytes.
inline Lanes* lanes(double* at) { return reinterpret_cast<Lanes*>(at); }
inline const Lanes* lanes(const double* at) { return reinterpret_cast<const Lanes*>(at); }

struct LanesVector {
  Lanes x, y, z;
};
inline LanesVector lanes(const double* first, std::size_t stride) {
  return {*lanes(first), *lanes(first + stride), *lanes(first + 2 * stride)};
}
inline void put(const LanesVector& v, double* first, std::size_t stride) {
  *lanes(first) = v.x;
  *lanes(first + stride) = v.y;
  *lanes(first + 2 * stride) = v.z;
}
inline LanesVector operator+(const LanesVector& a, const LanesVector& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
inline LanesVector operator-(const LanesVector& a, const LanesVector& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
inline Lanes dot(const LanesVector& a, const LanesVector& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

inline LanesVector cross(const LanesVector& a, const LanesVector& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
// a + s b
inline LanesVector added(const LanesVector& a, const Lanes& s, const LanesVector& b) {
  return {a.x + s * b.x, a.y + s * b.y, a.z + s * b.z};
}

// Four rows, of which the first three numbers count, to columns; and back, the fourth being zero.
inline LanesVector columns_of(const Lanes (&row)[4]) {
  const Lanes xz01 = __builtin_shufflevector(row[0], row[1], 0, 4, 2, 6),
              xz23 = __builtin_shufflevector(row[2], row[3], 0, 4, 2, 6),
              y01 = __builtin_shufflevector(row[0], row[1], 1, 5, 3, 7),
              y23 = __builtin_shufflevector(row[2], row[3], 1, 5, 3, 7);
  return {__builtin_shufflevector(xz01, xz23, 0, 1, 4, 5), __builtin_shufflevector(y01, y23, 0, 1, 4, 5),
          __builtin_shufflevector(xz01, xz23, 2, 3, 6, 7)};
}
inline void to_rows(const LanesVector& v, Lanes (&row)[4]) {
  const Lanes xy02 = __builtin_shufflevector(v.x, v.y, 0, 4, 2, 6),
              xy13 = __builtin_shufflevector(v.x, v.y, 1, 5, 3, 7),
              z02 = __builtin_shufflevector(v.z, Lanes{}, 0, 4, 2, 6),
              z13 = __builtin_shufflevector(v.z, Lanes{}, 1, 5, 3, 7);
  row[0] = __builtin_shufflevector(xy02, z02, 0, 1, 4, 5);
  row[1] = __builtin_shufflevector(xy13, z13, 0, 1, 4, 5);
  row[2] = __builtin_shufflevector(xy02, z02, 2, 3, 6, 7);
  row[3] = __builtin_shufflevector(xy13, z13, 2, 3, 6, 7);
}

// Impulse and moment, or velocity and spin.
struct LanesWrench {
  LanesVector linear, angular;
};
// Columns of `width` components: a vector, or a wrench.
template <std::size_t width>
auto lanes_at(const double* first, std::size_t stride) {
  if constexpr (width == 3)
    return lanes(first, stride);
  else
    return LanesWrench{lanes(first, stride), lanes(first + 3 * stride, stride)};
}
inline void put(const LanesWrench& v, double* first, std::size_t stride) {
  put(v.linear, first, stride);
  put(v.angular, first + 3 * stride, stride);
}
inline LanesWrench operator-(const LanesWrench& a, const LanesWrench& b) {
  return {a.linear - b.linear, a.angular - b.angular};
}
inline Lanes dot(const LanesWrench& a, const LanesWrench& b) {
  return dot(a.linear, b.linear) + dot(a.angular, b.angular);
}

// The second where one of them is not a number.
inline Lanes larger(const Lanes& a, const Lanes& b) { return a > b ? a : b; }
inline Lanes magnitude(const Lanes& a) { return larger(a, -a); }
inline Lanes largest(const LanesVector& a) {
  return larger(larger(magnitude(a.x), magnitude(a.y)), magnitude(a.z));
}
inline double largest(const Lanes& a) { return std::max(std::max(a[0], a[1]), std::max(a[2], a[3])); }
inline double sum(const Lanes& a) { return (a[0] + a[1]) + (a[2] + a[3]); }

// y = H x of the forms of H: columns h at distances of stride.
struct ScalarForm {
  const double* h;
  LanesVector operator()(std::size_t q, const LanesVector& x) const {
    const Lanes s = *lanes(h + q);
    return {s * x.x, s * x.y, s * x.z};
  }
};
struct TransverseForm {
  const double *h, *normal;
  std::size_t stride;
  LanesVector operator()(std::size_t q, const LanesVector& x) const {
    const LanesVector n = lanes(normal + q, stride);
    const Lanes t = *lanes(h + stride + q), d = (*lanes(h + q) - t) * dot(n, x);
    return {t * x.x + d * n.x, t * x.y + d * n.y, t * x.z + d * n.z};
  }
};
struct PlaneForm {
  const double* h;
  std::size_t stride;
  LanesVector operator()(std::size_t q, const LanesVector& x) const {
    const Lanes xy = *lanes(h + 2 * stride + q);
    return {*lanes(h + q) * x.x + xy * x.y, xy * x.x + *lanes(h + stride + q) * x.y, x.z - x.z};
  }
};
struct FullForm {
  const double* h;
  std::size_t stride;
  LanesVector operator()(std::size_t q, const LanesVector& x) const {
    const Lanes xy = *lanes(h + 3 * stride + q), xz = *lanes(h + 4 * stride + q),
                yz = *lanes(h + 5 * stride + q);
    return {*lanes(h + q) * x.x + xy * x.y + xz * x.z, xy * x.x + *lanes(h + stride + q) * x.y + yz * x.z,
            xz * x.x + yz * x.y + *lanes(h + 2 * stride + q) * x.z};
  }
};
// The form with spins of ilaw.h; length as that of Layout.
struct SpinForm {
  const double *h, *normal, *length;
  std::size_t stride;
  LanesWrench operator()(std::size_t q, const LanesWrench& x) const {
    const TransverseForm by_impulse{h, normal, stride}, by_moment{h + 3 * stride, normal, stride};
    const LanesVector n = lanes(normal + q, stride);
    const Lanes k = *lanes(h + 2 * stride + q);
    return {added(by_impulse(q, x.linear), k, cross(n, x.angular)),
            added(by_moment(q, x.angular), -k, cross(n, x.linear))};
  }
};

// Columns as a form takes them, and their largest component as a velocity.
template <class Form>
LanesVector read(const Form&, const double* first, std::size_t stride) {
  return lanes(first, stride);
}
template <class Form>
Lanes size(const Form&, std::size_t, const LanesVector& x) {
  return largest(x);
}
inline LanesWrench read(const SpinForm&, const double* first, std::size_t stride) {
  return lanes_at<6>(first, stride);
}
inline Lanes size(const SpinForm& form, std::size_t q, const LanesWrench& x) {
  return larger(largest(x.linear), *lanes(form.length + q) * largest(x.angular));
}

}  // namespace ilaw::coupled
