// vector.hpp - vectors and boxes in space; in the plane the third component is 0.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

namespace ilaw::search {

inline constexpr double infinity = std::numeric_limits<double>::infinity();

struct Vec {
  double x, y, z;
};

inline Vec operator+(Vec a, Vec b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline Vec operator-(Vec a, Vec b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline Vec operator*(double s, Vec a) { return {s * a.x, s * a.y, s * a.z}; }
inline Vec operator/(Vec a, double s) { return {a.x / s, a.y / s, a.z / s}; }
inline double dot(Vec a, Vec b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Vec cross(Vec a, Vec b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline double square(double a) { return a * a; }
inline double square(Vec a) { return dot(a, a); }
inline double norm(Vec a) { return std::sqrt(square(a)); }
inline Vec unit(Vec a) {
  const double s = square(a);
  return s > 0.0 ? a / std::sqrt(s) : a;
}
inline double largest(Vec a) { return std::max({std::fabs(a.x), std::fabs(a.y), std::fabs(a.z)}); }

struct Box {
  Vec low{infinity, infinity, infinity}, high{-infinity, -infinity, -infinity};

  void add(Vec p) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  void add(const Box& box) {
    add(box.low);
    add(box.high);
  }
};

// Least distance of two boxes along an axis, and the largest one of points in them.
inline double apart(double low_a, double high_a, double low_b, double high_b) {
  return std::max({low_b - high_a, low_a - high_b, 0.0});
}
inline double across(double low_a, double high_a, double low_b, double high_b) {
  return std::max(high_b - low_a, high_a - low_b);
}
inline double least_square(const Box& a, const Box& b) {
  return square({apart(a.low.x, a.high.x, b.low.x, b.high.x), apart(a.low.y, a.high.y, b.low.y, b.high.y),
                 apart(a.low.z, a.high.z, b.low.z, b.high.z)});
}
inline double most_square(const Box& a, const Box& b) {
  return square({across(a.low.x, a.high.x, b.low.x, b.high.x), across(a.low.y, a.high.y, b.low.y, b.high.y),
                 across(a.low.z, a.high.z, b.low.z, b.high.z)});
}

}  // namespace ilaw::search
