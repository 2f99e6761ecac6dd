// vector.hpp - vectors at a node. Dimensions 1 and 2 are the same equations with zero tangential components.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit/math.hpp>

namespace ilaw::kit::inline ILAW_KIT_LEVEL {

// In the local frame: normal, first and second tangential component.
template <class V>
struct vector {
  using number = V;
  V n = 0.0, t1 = 0.0, t2 = 0.0;

  ILAW_KIT_INLINE friend vector operator+(vector a, vector b) {
    return {a.n + b.n, a.t1 + b.t1, a.t2 + b.t2};
  }
  ILAW_KIT_INLINE friend vector operator-(vector a, vector b) {
    return {a.n - b.n, a.t1 - b.t1, a.t2 - b.t2};
  }
  ILAW_KIT_INLINE friend vector operator-(vector a) { return {-a.n, -a.t1, -a.t2}; }
  ILAW_KIT_INLINE friend vector operator*(V s, vector a) { return {s * a.n, s * a.t1, s * a.t2}; }
  ILAW_KIT_INLINE friend vector select(mask_of<V> m, vector a, vector b) {
    return {select(m, a.n, b.n), select(m, a.t1, b.t1), select(m, a.t2, b.t2)};
  }
  ILAW_KIT_INLINE friend vector zero_unless(mask_of<V> m, vector a) {
    return {zero_unless(m, a.n), zero_unless(m, a.t1), zero_unless(m, a.t2)};
  }
  ILAW_KIT_INLINE friend V normal_product(vector a, vector b) { return a.n * b.n; }
  ILAW_KIT_INLINE friend V tangential_product(vector a, vector b) { return a.t1 * b.t1 + a.t2 * b.t2; }
  ILAW_KIT_INLINE scaled_length<V> scaled_tangential_length() const { return scaled_length_of(t1, t2); }
  ILAW_KIT_INLINE V tangential_length() const { return scaled_tangential_length().length(); }
  // With this normal component, and tangential ones -factor times these. From zero: what is not rubbed gets
  // 0, not -0.
  ILAW_KIT_INLINE vector against(V normal, V factor) const {
    return {normal, 0.0 - factor * t1, 0.0 - factor * t2};
  }
  ILAW_KIT_INLINE vector tangential_part() const { return {0.0, t1, t2}; }
  ILAW_KIT_INLINE friend V sum_of_sizes(vector a) {
    return absolute(a.n) + (absolute(a.t1) + absolute(a.t2));
  }
  ILAW_KIT_INLINE friend V residual(vector a, V found) { return found * a.n * a.t1 * a.t2; }
};

// For laws that are isotropic in the tangent plane: normal part and tangential rest, the latter in the host's
// axes, so that no tangent need be chosen. A step written with the operations that it shares with vector
// works on both.
template <class V>
struct projected {
  using number = V;
  V n = 0.0, x = 0.0, y = 0.0, z = 0.0;

  ILAW_KIT_INLINE friend projected operator+(projected a, projected b) {
    return {a.n + b.n, a.x + b.x, a.y + b.y, a.z + b.z};
  }
  ILAW_KIT_INLINE friend projected operator-(projected a, projected b) {
    return {a.n - b.n, a.x - b.x, a.y - b.y, a.z - b.z};
  }
  ILAW_KIT_INLINE friend projected operator-(projected a) { return {-a.n, -a.x, -a.y, -a.z}; }
  ILAW_KIT_INLINE friend projected operator*(V s, projected a) {
    return {s * a.n, s * a.x, s * a.y, s * a.z};
  }
  ILAW_KIT_INLINE friend projected select(mask_of<V> m, projected a, projected b) {
    return {select(m, a.n, b.n), select(m, a.x, b.x), select(m, a.y, b.y), select(m, a.z, b.z)};
  }
  ILAW_KIT_INLINE friend projected zero_unless(mask_of<V> m, projected a) {
    return {zero_unless(m, a.n), zero_unless(m, a.x), zero_unless(m, a.y), zero_unless(m, a.z)};
  }
  ILAW_KIT_INLINE friend V normal_product(projected a, projected b) { return a.n * b.n; }
  ILAW_KIT_INLINE friend V tangential_product(projected a, projected b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
  }
  ILAW_KIT_INLINE scaled_length<V> scaled_tangential_length() const { return scaled_length_of(x, y, z); }
  ILAW_KIT_INLINE V tangential_length() const { return scaled_tangential_length().length(); }
  ILAW_KIT_INLINE projected against(V normal, V factor) const {
    return {normal, 0.0 - factor * x, 0.0 - factor * y, 0.0 - factor * z};
  }
  ILAW_KIT_INLINE projected tangential_part() const { return {0.0, x, y, z}; }
  ILAW_KIT_INLINE friend V sum_of_sizes(projected a) {
    return (absolute(a.n) + absolute(a.x)) + (absolute(a.y) + absolute(a.z));
  }
  ILAW_KIT_INLINE friend V residual(projected a, V found) { return found * a.n * a.x * a.y * a.z; }
};

// A vector without normal component, to be remembered: a host keeps d-1 doubles of it.
template <class V>
struct tangential_vector {
  V t1 = 0.0, t2 = 0.0;

  ILAW_KIT_INLINE operator vector<V>() const { return {0.0, t1, t2}; }
};

// A vector in the host's axes.
template <class V>
struct axis {
  V x, y, z;

  ILAW_KIT_INLINE friend V dot(axis a, axis b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
  ILAW_KIT_INLINE friend axis cross(axis a, axis b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
  }
  ILAW_KIT_INLINE friend axis select(mask_of<V> m, axis a, axis b) {
    return {select(m, a.x, b.x), select(m, a.y, b.y), select(m, a.z, b.z)};
  }
  ILAW_KIT_INLINE friend V residual(axis a, V found) { return found * a.x * a.y * a.z; }
};

}  // namespace ilaw::kit
