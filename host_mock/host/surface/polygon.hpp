// polygon.hpp - convex polygons in a plane: their intersection, and shape functions over a flat facet.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include <array>
#include <cstddef>

namespace ilaw::host {

// A few corners, which follow each other.
class Polygon {
 public:
  // Four edges cut at most four corners more off a quadrilateral; rounding may add some.
  static constexpr std::size_t most_corners = 12;

  std::size_t size() const { return size_; }
  const Eigen::Vector2d& operator[](std::size_t k) const { return corners_[k]; }
  const Eigen::Vector2d& next(std::size_t k) const { return corners_[k + 1 < size_ ? k + 1 : 0]; }
  void add(const Eigen::Vector2d& corner) {
    if (size_ < most_corners) corners_[size_++] = corner;
  }
  // Positive if the corners follow each other counterclockwise.
  double area() const;
  Polygon reversed() const;

 private:
  std::size_t size_ = 0;
  std::array<Eigen::Vector2d, most_corners> corners_;
};

// The part of a polygon in a convex window whose corners follow each other counterclockwise (Sutherland and
// Hodgman 1974).
Polygon clipped(const Polygon& polygon, const Polygon& window);

// The largest t in [0, 1] for which from + t (to - from) is in a convex polygon, or no farther than margin
// from its edges; -1: none.
double last_inside(const Polygon& polygon, const Eigen::Vector2d& from, const Eigen::Vector2d& to,
                   double margin);

// Shape functions of a flat triangle or quadrilateral, in the order of its corners; the fourth one of a
// triangle is 0.
class FlatFacet {
 public:
  explicit FlatFacet(const Polygon& corners);
  Eigen::Vector4d at(const Eigen::Vector2d& point) const;

 private:
  Eigen::Vector2d inverse(const Eigen::Vector2d& point) const;

  bool is_triangle_, is_parallelogram_;
  // x = origin + along_[0] s + along_[1] t + twist s t
  Eigen::Vector2d origin_, twist_;
  std::array<Eigen::Vector2d, 2> along_;
};

}  // namespace ilaw::host
