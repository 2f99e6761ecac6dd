// facet_overlap.hpp - what a facet of the secondary surface shares with facets of the main surface: integrals
// of its test functions times the shape functions of both, over the overlap in its own plane.
// docs/theory/mortar.md derives them.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "surface/polygon.hpp"

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <array>
#include <cstdint>
#include <limits>
#include <vector>

namespace ilaw::host {

// Facets that stand steeper to each other do not meet as faces.
inline constexpr double least_cosine = 0.2;

// Three or four corners, counterclockwise seen from outside the body.
struct FacetShape {
  std::size_t count;
  std::array<Eigen::Vector3d, 4> at;

  // Out of the body; not a unit vector: twice the area.
  Eigen::Vector3d double_area() const {
    return count == 3 ? (at[1] - at[0]).cross(at[2] - at[0]).eval()
                      : (at[2] - at[0]).cross(at[3] - at[1]).eval();
  }
};

// Row i of each matrix belongs to the test function of corner i.
struct FacetOverlap {
  struct Part {
    std::int32_t facet;       // of the main surface
    Eigen::Matrix4d weights;  // integrals of psi_i N_k of the main facet
  };

  Eigen::Vector4d area = Eigen::Vector4d::Zero();  // integrals of psi_i, which are those of N_i
  Eigen::Matrix4d own = Eigen::Matrix4d::Zero();   // integrals of psi_i N_j of the facet itself
  std::vector<Part> parts;
};

// Collects the overlap of one facet with others. The test functions are dual to the shape functions (own is
// diagonal) if all corners are within the overlap. Dual functions would put the row of a corner that the
// overlap does not reach at that corner, though nothing is there; shape functions as test functions put it at
// their centroid, which is short of the border. In between, a blend of both puts it on the border.
class FacetIntegral {
 public:
  // Writes into overlap; pieces is scratch. Both keep their memory. A facet that lies deeper behind this one
  // is on another side of its body.
  FacetIntegral(const FacetShape& corners, FacetOverlap& overlap, std::vector<Polygon>& pieces,
                double deepest = std::numeric_limits<double>::infinity());
  // Adds the overlap with a facet that faces this one; does nothing where there is none.
  void add(std::int32_t facet, const FacetShape& corners);
  void finish();

 private:
  Eigen::Vector2d flat(const Eigen::Vector3d& point) const;
  Polygon flat(const FacetShape& corners) const;
  double dual_share() const;
  Eigen::Matrix4d test_functions(double dual_share) const;

  std::size_t count_;
  Eigen::Vector3d origin_, normal_, first_, second_;  // of the plane
  Polygon outline_;
  FlatFacet shape_;
  double size_, deepest_;  // square root of the area
  std::vector<Polygon>& pieces_;
  FacetOverlap& overlap_;  // until the end with the shape functions as test functions
};

}  // namespace ilaw::host
