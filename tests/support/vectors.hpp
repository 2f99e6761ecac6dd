// vectors.hpp - vectors and matrices of three components.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

namespace ilaw::testing {

using Vector = std::array<double, 3>;
using Matrix = std::array<Vector, 3>;  // rows

inline Vector operator+(const Vector& a, const Vector& b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }
inline Vector operator-(const Vector& a, const Vector& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
inline Vector operator-(const Vector& a) { return {-a[0], -a[1], -a[2]}; }
inline Vector operator*(double s, const Vector& a) { return {s * a[0], s * a[1], s * a[2]}; }
inline double dot(const Vector& a, const Vector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
inline double length(const Vector& a) { return std::sqrt(dot(a, a)); }
inline Vector cross(const Vector& a, const Vector& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
// Across the unit vector n.
inline Vector tangential(const Vector& a, const Vector& n) { return a - dot(a, n) * n; }
// Of a vector in the local frame.
inline double tangential_length(const Vector& a) { return std::hypot(a[1], a[2]); }

inline Vector times(const Matrix& m, const Vector& a) { return {dot(m[0], a), dot(m[1], a), dot(m[2], a)}; }
inline Matrix transposed(const Matrix& m) {
  return {Vector{m[0][0], m[1][0], m[2][0]}, {m[0][1], m[1][1], m[2][1]}, {m[0][2], m[1][2], m[2][2]}};
}
inline Matrix product(const Matrix& p, const Matrix& q) {
  const Matrix columns = transposed(q);
  return {times(columns, p[0]), times(columns, p[1]), times(columns, p[2])};
}

}  // namespace ilaw::testing
