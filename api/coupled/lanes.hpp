// lanes.hpp - four numbers of a column at a time, in the vector types of GCC and clang.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

namespace ilaw::coupled {

inline constexpr std::size_t lane_count = 4;
using Lanes [[gnu::vector_size(8 * lane_count), gnu::may_alias, gnu::aligned(8)]] = double;

inline Lanes& lanes(double* at) { return *reinterpret_cast<Lanes*>(at); }
inline const Lanes& lanes(const double* at) { return *reinterpret_cast<const Lanes*>(at); }

struct LanesVector {
  Lanes x, y, z;
};
inline LanesVector lanes(const double* first, std::size_t stride) {
  return {lanes(first), lanes(first + stride), lanes(first + 2 * stride)};
}
inline void put(const LanesVector& v, double* first, std::size_t stride) {
  lanes(first) = v.x;
  lanes(first + stride) = v.y;
  lanes(first + 2 * stride) = v.z;
}
inline LanesVector operator-(const LanesVector& a, const LanesVector& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
inline Lanes dot(const LanesVector& a, const LanesVector& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

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
    const Lanes s = lanes(h + q);
    return {s * x.x, s * x.y, s * x.z};
  }
};
struct TransverseForm {
  const double *h, *normal;
  std::size_t stride;
  LanesVector operator()(std::size_t q, const LanesVector& x) const {
    const LanesVector n = lanes(normal + q, stride);
    const Lanes t = lanes(h + stride + q), d = (lanes(h + q) - t) * dot(n, x);
    return {t * x.x + d * n.x, t * x.y + d * n.y, t * x.z + d * n.z};
  }
};
struct PlaneForm {
  const double* h;
  std::size_t stride;
  LanesVector operator()(std::size_t q, const LanesVector& x) const {
    const Lanes xy = lanes(h + 2 * stride + q);
    return {lanes(h + q) * x.x + xy * x.y, xy * x.x + lanes(h + stride + q) * x.y, x.z - x.z};
  }
};
struct FullForm {
  const double* h;
  std::size_t stride;
  LanesVector operator()(std::size_t q, const LanesVector& x) const {
    const Lanes xy = lanes(h + 3 * stride + q), xz = lanes(h + 4 * stride + q),
                yz = lanes(h + 5 * stride + q);
    return {lanes(h + q) * x.x + xy * x.y + xz * x.z, xy * x.x + lanes(h + stride + q) * x.y + yz * x.z,
            xz * x.x + yz * x.y + lanes(h + 2 * stride + q) * x.z};
  }
};

}  // namespace ilaw::coupled
