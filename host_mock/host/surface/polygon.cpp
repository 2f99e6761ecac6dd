// SPDX-License-Identifier: BSD-3-Clause
#include "surface/polygon.hpp"

#include <algorithm>
#include <cmath>

namespace ilaw::host {
namespace {

double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) { return a[0] * b[1] - a[1] * b[0]; }

// The part to the left of the line through two points.
Polygon left_of(const Polygon& polygon, const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
  Polygon left;
  const Eigen::Vector2d line = to - from;
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const Eigen::Vector2d &a = polygon[k], &b = polygon.next(k);
    const double side_a = cross(line, a - from), side_b = cross(line, b - from);
    if (side_a >= 0.0) left.add(a);
    if ((side_a > 0.0 && side_b < 0.0) || (side_a < 0.0 && side_b > 0.0))
      left.add(a + side_a / (side_a - side_b) * (b - a));
  }
  return left;
}

}  // namespace

double Polygon::area() const {
  double twice = 0.0;
  for (std::size_t k = 0; k < size_; ++k) twice += cross(corners_[k] - corners_[0], next(k) - corners_[0]);
  return 0.5 * twice;
}

Polygon Polygon::reversed() const {
  Polygon other;
  for (std::size_t k = size_; k-- > 0;) other.add(corners_[k]);
  return other;
}

Polygon clipped(const Polygon& polygon, const Polygon& window) {
  Polygon left = polygon;
  for (std::size_t k = 0; k < window.size() && left.size() > 0; ++k)
    left = left_of(left, window[k], window.next(k));
  return left;
}

double last_inside(const Polygon& polygon, const Eigen::Vector2d& from, const Eigen::Vector2d& to,
                   double margin) {
  double first = 0.0, last = 1.0;
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const Eigen::Vector2d line = polygon.next(k) - polygon[k];
    const double length = line.norm();
    if (length <= margin) continue;
    const double a = cross(line, from - polygon[k]) / length + margin,
                 b = cross(line, to - polygon[k]) / length + margin;
    if (a < 0.0 && b < 0.0) return -1.0;
    if (a < 0.0) first = std::max(first, a / (a - b));
    if (b < 0.0) last = std::min(last, a / (a - b));
  }
  return first <= last ? last : -1.0;
}

FlatFacet::FlatFacet(const Polygon& corners) : is_triangle_(corners.size() == 3), origin_(corners[0]) {
  constexpr double rounding = 1e-15;
  const Eigen::Vector2d& last = corners[corners.size() - 1];
  along_ = {corners[1] - origin_, last - origin_};
  twist_ = is_triangle_ ? Eigen::Vector2d::Zero().eval() : corners[2] - corners[1] - along_[1];
  is_parallelogram_ = twist_.squaredNorm() <= rounding * rounding * along_[0].squaredNorm();
}

// Newton's method, whose error is squared by a step; in a parallelogram its first step is exact.
Eigen::Vector2d FlatFacet::inverse(const Eigen::Vector2d& point) const {
  constexpr int most_steps = 20;
  constexpr double enough = 1e-8;
  Eigen::Vector2d at(0.5, 0.5);
  for (int step = 0; step < most_steps; ++step) {
    const Eigen::Vector2d along_s = along_[0] + at[1] * twist_, along_t = along_[1] + at[0] * twist_;
    const Eigen::Vector2d missing =
        point - origin_ - at[0] * along_[0] - at[1] * along_[1] - at[0] * at[1] * twist_;
    const double determinant = cross(along_s, along_t);
    const Eigen::Vector2d change(cross(missing, along_t) / determinant,
                                 cross(along_s, missing) / determinant);
    at += change;
    if (is_parallelogram_ || change.cwiseAbs().maxCoeff() < enough) break;
  }
  return at;
}

Eigen::Vector4d FlatFacet::at(const Eigen::Vector2d& point) const {
  const Eigen::Vector2d p = inverse(point);
  if (is_triangle_) return {1.0 - p[0] - p[1], p[0], p[1], 0.0};
  return {(1.0 - p[0]) * (1.0 - p[1]), p[0] * (1.0 - p[1]), p[0] * p[1], (1.0 - p[0]) * p[1]};
}

}  // namespace ilaw::host
