// vector.hpp - three components, and symmetric matrices as FULL in ilaw.h has them: xx yy zz xy xz yz.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

namespace ilaw::coupled {

using Vector = std::array<double, 3>;
using Symmetric = std::array<double, 6>;
using Wrench = std::array<double, 6>;  // impulse and moment, or velocity and spin

// Reads `width` numbers at distances of stride.
template <std::size_t width>
std::array<double, width> columns_at(const double* first, std::size_t stride) {
  std::array<double, width> read;
  for (std::size_t c = 0; c < width; ++c) read[c] = first[c * stride];
  return read;
}

inline Vector operator+(const Vector& a, const Vector& b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }
inline Vector operator-(const Vector& a, const Vector& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
inline Vector operator*(double s, const Vector& a) { return {s * a[0], s * a[1], s * a[2]}; }
inline double dot(const Vector& a, const Vector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
inline Vector cross(const Vector& a, const Vector& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
inline Vector scaled(const Vector& a, const Vector& b) { return {a[0] * b[0], a[1] * b[1], a[2] * b[2]}; }
inline bool is_zero(const Vector& a) { return a[0] == 0.0 && a[1] == 0.0 && a[2] == 0.0; }
inline bool is_finite(const Vector& a) { return 0.0 * a[0] + 0.0 * a[1] + 0.0 * a[2] == 0.0; }
inline double largest(const Vector& a) {
  return std::fmax(std::fabs(a[0]), std::fmax(std::fabs(a[1]), std::fabs(a[2])));
}

inline Vector operator*(const Symmetric& m, const Vector& a) {
  return {m[0] * a[0] + m[3] * a[1] + m[4] * a[2], m[3] * a[0] + m[1] * a[1] + m[5] * a[2],
          m[4] * a[0] + m[5] * a[1] + m[2] * a[2]};
}
inline Symmetric operator+(const Symmetric& a, const Symmetric& b) {
  Symmetric sum;
  for (std::size_t i = 0; i < sum.size(); ++i) sum[i] = a[i] + b[i];
  return sum;
}
inline Symmetric operator*(double s, const Symmetric& a) {
  Symmetric product;
  for (std::size_t i = 0; i < product.size(); ++i) product[i] = s * a[i];
  return product;
}

}  // namespace ilaw::coupled
