// shapes.hpp - gaps and normals of points to rigid shapes, their velocities, and H of a point of a rigid
// body, for hosts in C++ that have none of their own. The closest facets of a mesh are in search.h. In
// Python: ilaw.shapes.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

namespace ilaw::shapes {

using vector = std::array<double, 3>;
using symmetric = std::array<double, 6>;  // 00 11 22 01 02 12, as ILAW_DELASSUS_FULL

constexpr double dot(const vector& a, const vector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
constexpr vector cross(const vector& a, const vector& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
constexpr vector plus(const vector& a, const vector& b, double factor = 1.0) {
  return {a[0] + factor * b[0], a[1] + factor * b[1], a[2] + factor * b[2]};
}
constexpr vector times(const symmetric& m, const vector& a) {
  return {dot({m[0], m[3], m[4]}, a), dot({m[3], m[1], m[5]}, a), dot({m[4], m[5], m[2]}, a)};
}

struct surface {
  double gap;     // signed distance, positive outside
  vector normal;  // unit, from the shape to the point
};

// `from` leads from a point of the plane; its unit normal points to the body.
constexpr surface plane(const vector& from, const vector& normal) { return {dot(from, normal), normal}; }

// `from` leads from the centre, where there is no normal.
inline surface sphere(const vector& from, double radius) {
  const double length = std::sqrt(dot(from, from));
  return {length - radius, {from[0] / length, from[1] / length, from[2] / length}};
}

// An infinite one; `from` leads from a point of its unit axis.
inline surface cylinder(const vector& from, const vector& axis, double radius) {
  return sphere(plus(from, axis, -dot(from, axis)), radius);
}

// For a body inside of the shape.
constexpr surface inside(const surface& s) { return {-s.gap, {-s.normal[0], -s.normal[1], -s.normal[2]}}; }

// Velocity of the point of a rigid body at `arm` from the one whose velocity is given.
constexpr vector velocity(const vector& velocity, const vector& spin, const vector& arm) {
  return plus(velocity, cross(spin, arm));
}

// H of the point of a rigid body at `arm` from its center of mass: its velocity per impulse there. Of two
// bodies that touch, the sum.
constexpr symmetric delassus(double inverse_mass, const symmetric& inverse_inertia, const vector& arm) {
  std::array<vector, 3> column{};
  for (std::size_t c = 0; c < 3; ++c) {
    vector impulse{};
    impulse[c] = 1.0;
    column[c] = plus(cross(times(inverse_inertia, cross(arm, impulse)), arm), impulse, inverse_mass);
  }
  return {column[0][0], column[1][1], column[2][2], column[1][0], column[2][0], column[2][1]};
}

}  // namespace ilaw::shapes
