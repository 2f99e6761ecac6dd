// frame.hpp - local frames of a block of nodes, from the normals (and tangents) that a host gives in its
// axes. SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit/gather.hpp>
#include <ilaw/kit/math.hpp>

#include <limits>

namespace ilaw::kit::inline ILAW_KIT_LEVEL {

// Largest | |n|^2 - 1 | accepted: normals that went through single precision pass.
inline constexpr double unit_tolerance = 1e-6;

struct axis {
  double x, y, z;
};
constexpr double dot(axis a, axis b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
constexpr axis cross(axis a, axis b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
constexpr bool unit(axis a) { return __builtin_fabs(dot(a, a) - 1.0) <= unit_tolerance; }

// A tangent of a unit normal without branch or square root (Duff et al. 2017, Building an orthonormal basis).
inline axis any_tangent(axis n) {
  const double sign = __builtin_copysign(1.0, n.z);
  const double a = -1.0 / (sign + n.z);
  return {1.0 + sign * n.x * n.x * a, sign * (n.x * n.y * a), -sign * n.x};
}

// Carries a tangent from one normal to the next by the shortest rotation, which turns nothing about the
// normal: R t = t - (n.t)/(1 + n.n') (n + n'), for t orthogonal to n' (Rodrigues); any tangent if the normal
// flipped.
inline axis transported_tangent(axis before, axis tangent, axis n) {
  const double cosine = dot(before, n);
  const double s = dot(n, tangent) / (1.0 + cosine);
  const axis moved{tangent.x - s * (n.x + before.x), tangent.y - s * (n.y + before.y),
                   tangent.z - s * (n.z + before.z)};
  const double residue = dot(moved, n);  // rounding must not accumulate over millions of steps
  const axis flat{moved.x - residue * n.x, moved.y - residue * n.y, moved.z - residue * n.z};
  const double inverse = 1.0 / square_root(dot(flat, flat));
  const axis fresh = any_tangent(n);
  const bool usable = cosine > -0.5 && finite(inverse);
  return {usable ? inverse * flat.x : fresh.x, usable ? inverse * flat.y : fresh.y,
          usable ? inverse * flat.z : fresh.z};
}

// Rows n, t1, t2 of the rotation from the host's axes to the local frame, a column per entry.
struct frame_block {
  const double *nx, *ny, *nz;
  column t1[3], t2[3];

  axis normal(int i) const { return {nx[i], ny[i], nz[i]}; }
  axis first(int i) const { return {t1[0].values[i], t1[1].values[i], t1[2].values[i]}; }
  axis second(int i) const { return {t2[0].values[i], t2[1].values[i], t2[2].values[i]}; }
  void set(int i, axis first_tangent) {
    const axis second_tangent = cross(normal(i), first_tangent);
    t1[0].values[i] = first_tangent.x;
    t1[1].values[i] = first_tangent.y;
    t1[2].values[i] = first_tangent.z;
    t2[0].values[i] = second_tangent.x;
    t2[1].values[i] = second_tangent.y;
    t2[2].values[i] = second_tangent.z;
  }
};

// In the plane the tangent is the normal turned by a right angle; on the line it is never used.
inline axis plane_tangent(int dimension, axis n) {
  return dimension == 2 ? axis{-n.y, n.x, 0.0} : axis{0.0, 1.0, 0.0};
}

// Turns vectors to the local frame. A normal that is no unit vector poisons its node, which is then refused.
inline void to_local(const frame_block& frame, int count, const double** v, column* room) {
  const double *vx = v[0], *vy = v[1], *vz = v[2];
#pragma omp simd
  for (int i = 0; i < count; ++i) {
    const axis a{vx[i], vy[i], vz[i]};
    const double valid = unit(frame.normal(i)) ? 1.0 : std::numeric_limits<double>::quiet_NaN();
    const double n = valid * dot(frame.normal(i), a);
    const double first = dot(frame.first(i), a), second = dot(frame.second(i), a);
    room[0].values[i] = n;
    room[1].values[i] = first;
    room[2].values[i] = second;
  }
  for (int k = 0; k < 3; ++k) v[k] = room[k].values;
}

// Turns vectors, in place, back to the host's axes.
inline void to_global(const frame_block& frame, int count, double* const* v) {
  double *vx = v[0], *vy = v[1], *vz = v[2];
#pragma omp simd
  for (int i = 0; i < count; ++i) {
    const axis n = frame.normal(i), t1 = frame.first(i), t2 = frame.second(i);
    const double a = vx[i], b = vy[i], c = vz[i];
    vx[i] = a * n.x + b * t1.x + c * t2.x;
    vy[i] = a * n.y + b * t1.y + c * t2.y;
    vz[i] = a * n.z + b * t1.z + c * t2.z;
  }
}

// Turns a full symmetric H to the local frame, H' = B H B^T; order of the entries as in ilaw.h.
inline void delassus_to_local(const frame_block& frame, int count, const double** h, column* room) {
  for (int i = 0; i < count; ++i) {
    const axis rows[3] = {
        {h[0][i], h[3][i], h[4][i]}, {h[3][i], h[1][i], h[5][i]}, {h[4][i], h[5][i], h[2][i]}};
    const axis basis[3] = {frame.normal(i), frame.first(i), frame.second(i)};
    axis image[3];  // H times each basis vector
    for (int k = 0; k < 3; ++k)
      image[k] = {dot(rows[0], basis[k]), dot(rows[1], basis[k]), dot(rows[2], basis[k])};
    constexpr int entries[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}};
    for (int e = 0; e < 6; ++e) room[e].values[i] = dot(basis[entries[e][0]], image[entries[e][1]]);
  }
  for (int e = 0; e < 6; ++e) h[e] = room[e].values;
}

}  // namespace ilaw::kit::inline ILAW_KIT_LEVEL
