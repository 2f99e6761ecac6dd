// Integrals over overlaps of facets against closed forms: areas, sums, linear fields, dual functions, and the
// places of rows at borders.
#include "surface/facet_overlap.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

namespace {

using namespace ilaw::host;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double exact = 1e-13;
constexpr double margin = 2e-9;  // corners count as inside up to 1e-9 of a facet

// A face in a plane that is turned in space and sheared.
struct Plane {
  Eigen::Matrix3d turn = (Eigen::AngleAxisd(0.4, Vector3d(1.0, 2.0, 3.0).normalized())).toRotationMatrix();
  double shear = 0.3;

  Vector3d at(double x, double y) const { return turn * Vector3d(x + shear * y, y, 0.0); }
};

struct Face {
  std::vector<Vector3d> nodes;
  std::vector<std::vector<int>> facets;

  FacetShape corners(std::size_t f) const {
    FacetShape corners{facets[f].size(), {}};
    for (std::size_t k = 0; k < corners.count; ++k)
      corners.at[k] = nodes[static_cast<std::size_t>(facets[f][k])];
    return corners;
  }
};

// n x n cells on a square of a size about (0.5, 0.5), turned by an angle in the plane. faces_down: seen from
// the other side.
Face face_of(const Plane& plane, int n, double size, double angle, bool triangles, bool faces_down) {
  Face face;
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i) {
      const double x = size * (i / double(n) - 0.5), y = size * (j / double(n) - 0.5);
      face.nodes.push_back(plane.at(0.5 + std::cos(angle) * x - std::sin(angle) * y,
                                    0.5 + std::sin(angle) * x + std::cos(angle) * y));
    }
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const int a = j * (n + 1) + i, b = a + 1, c = b + n + 1, d = c - 1;
      std::vector<std::vector<int>> cell{{a, b, c, d}};
      if (triangles) cell = {{a, b, c}, {a, c, d}};
      for (std::vector<int>& one : cell) {
        if (faces_down) std::reverse(one.begin(), one.end());
        face.facets.push_back(one);
      }
    }
  return face;
}

FacetOverlap overlap_of(const FacetShape& facet, const Face& main) {
  FacetOverlap overlap;
  std::vector<Polygon> pieces;
  FacetIntegral integral(facet, overlap, pieces);
  for (std::size_t m = 0; m < main.facets.size(); ++m)
    integral.add(static_cast<std::int32_t>(m), main.corners(m));
  integral.finish();
  return overlap;
}

// Rows of all nodes: area, first moment by the weights of their own side and of the main side, and what main
// nodes get.
struct Rows {
  std::vector<double> area, main_area;
  std::vector<Vector3d> own, main;
  double largest_weight = 0.0;
};

Rows rows_of(const Face& secondary, const Face& main) {
  Rows rows{std::vector<double>(secondary.nodes.size(), 0.0), std::vector<double>(main.nodes.size(), 0.0),
            std::vector<Vector3d>(secondary.nodes.size(), Vector3d::Zero()),
            std::vector<Vector3d>(secondary.nodes.size(), Vector3d::Zero())};
  for (std::size_t f = 0; f < secondary.facets.size(); ++f) {
    const FacetOverlap overlap = overlap_of(secondary.corners(f), main);
    for (std::size_t i = 0; i < secondary.facets[f].size(); ++i) {
      const auto node = static_cast<std::size_t>(secondary.facets[f][i]);
      const auto row = static_cast<Eigen::Index>(i);
      rows.area[node] += overlap.area[row];
      for (std::size_t j = 0; j < secondary.facets[f].size(); ++j)
        rows.own[node] += overlap.own(row, static_cast<Eigen::Index>(j)) * secondary.corners(f).at[j];
      for (const FacetOverlap::Part& part : overlap.parts) {
        const auto m = static_cast<std::size_t>(part.facet);
        for (std::size_t k = 0; k < main.facets[m].size(); ++k) {
          const double weight = part.weights(row, static_cast<Eigen::Index>(k));
          rows.main[node] += weight * main.corners(m).at[k];
          rows.main_area[static_cast<std::size_t>(main.facets[m][k])] += weight;
        }
      }
    }
  }
  return rows;
}

// Tributary areas, exact for parallelograms and triangles.
std::vector<double> areas_of(const Face& face) {
  std::vector<double> areas(face.nodes.size(), 0.0);
  for (std::size_t f = 0; f < face.facets.size(); ++f)
    for (const int node : face.facets[f])
      areas[static_cast<std::size_t>(node)] +=
          0.5 * face.corners(f).double_area().norm() / static_cast<double>(face.facets[f].size());
  return areas;
}

Polygon square(double half, double angle) {
  Polygon polygon;
  for (int k = 0; k < 4; ++k) {
    const double a = angle + (0.25 + 0.5 * k) * std::numbers::pi;
    polygon.add(std::sqrt(2.0) * half * Vector2d(std::cos(a), std::sin(a)));
  }
  return polygon;
}

TEST(Polygons, TurnedSquaresShareAnOctagon) {
  const Polygon octagon = clipped(square(0.5, 0.25 * std::numbers::pi), square(0.5, 0.0));
  EXPECT_EQ(octagon.size(), 8U);
  EXPECT_NEAR(octagon.area(), 2.0 * (std::sqrt(2.0) - 1.0), 1e-15);
  EXPECT_NEAR(clipped(square(0.1, 0.3), square(0.5, 0.0)).area(), 0.04, 1e-16);
  EXPECT_NEAR(clipped(square(0.5, 0.0), square(0.1, 0.3)).area(), 0.04, 1e-16);
}

TEST(Polygons, KnowTheLastPlaceInside) {
  const Polygon window = square(0.5, 0.0);
  EXPECT_NEAR(last_inside(window, {0.0, 0.0}, {2.0, 1.0}, 0.0), 0.25, 1e-15);
  EXPECT_NEAR(last_inside(window, {-1.0, 0.0}, {0.5, 0.0}, 0.0), 1.0, 1e-15);
  EXPECT_EQ(last_inside(window, {-1.0, 0.6}, {1.0, 0.6}, 0.0), -1.0);
}

TEST(ShapeFunctions, InvertAnyQuadrilateral) {
  Polygon corners;
  for (const auto& [x, y] : {std::pair(0.0, 0.1), {1.2, 0.0}, {0.9, 1.3}, {-0.2, 0.8}}) corners.add({x, y});
  const FlatFacet facet(corners);
  for (const double s : {0.0, 0.2, 0.7, 1.0})
    for (const double t : {0.0, 0.5, 0.9}) {
      const Eigen::Vector4d n{(1.0 - s) * (1.0 - t), s * (1.0 - t), s * t, (1.0 - s) * t};
      Vector2d x = Vector2d::Zero();
      for (std::size_t k = 0; k < 4; ++k) x += n[static_cast<Eigen::Index>(k)] * corners[k];
      EXPECT_LT((facet.at(x) - n).cwiseAbs().maxCoeff(), 1e-14);
    }
}

// psi_i = 4 N_i - 1 in a triangle: its integrals with the shape functions of the same triangle are A/3 on the
// diagonal, and 0 beside it.
TEST(FacetOverlap, IsDualOnATriangle) {
  const Face own = face_of({}, 1, 1.0, 0.0, true, true), main = face_of({}, 1, 1.0, 0.0, true, false);
  const FacetOverlap overlap = overlap_of(own.corners(0), main);
  const double third = own.corners(0).double_area().norm() / 6.0;
  ASSERT_EQ(overlap.parts.size(), 1U);
  for (Eigen::Index i = 0; i < 3; ++i) {
    EXPECT_NEAR(overlap.area[i], third, exact);
    for (Eigen::Index j = 0; j < 3; ++j) EXPECT_NEAR(overlap.own(i, j), i == j ? third : 0.0, exact);
  }
  EXPECT_NEAR(overlap.parts.front().weights.sum(), 3.0 * third, exact);
}

// The patch test: a uniform pressure gives each node of both faces its tributary area. Linear fields are the
// same by the weights of either side, and at a covered node they are those of the node.
TEST(FacetOverlap, PassesThePatchTest) {
  for (const bool triangles : {false, true})
    for (const auto& [n, m] : {std::pair(3, 5), {5, 3}, {4, 4}, {7, 2}})
      for (const double angle : {0.0, 0.3, 0.7}) {
        const Face own = face_of({}, n, 1.0, 0.0, triangles, true),
                   main = face_of({}, m, 1.5, angle, !triangles, false);
        const Rows rows = rows_of(own, main);
        const std::vector<double> areas = areas_of(own);
        for (std::size_t i = 0; i < own.nodes.size(); ++i) {
          EXPECT_NEAR(rows.area[i], areas[i], exact);
          EXPECT_LT((rows.own[i] / rows.area[i] - own.nodes[i]).norm(), exact);
          EXPECT_LT((rows.main[i] / rows.area[i] - own.nodes[i]).norm(), exact) << n << m << angle;
        }
      }
}

TEST(FacetOverlap, GivesMainNodesTheirAreas) {
  for (const double angle : {0.0, 0.3}) {
    const Face own = face_of({}, 5, 1.5, angle, false, true), main = face_of({}, 3, 1.0, 0.0, false, false);
    const Rows rows = rows_of(own, main);
    const std::vector<double> areas = areas_of(main);
    for (std::size_t k = 0; k < areas.size(); ++k) EXPECT_NEAR(rows.main_area[k], areas[k], exact);
    for (std::size_t i = 0; i < own.nodes.size(); ++i)
      if (rows.area[i] > 0.0) {
        EXPECT_LT((rows.main[i] - rows.own[i]).norm() / rows.area[i], 1e-11);
      }
  }
}

// A face that covers a part s of one facet. The share of dual functions is s/(3 - 2 s): it takes the centroid
// of N, 2 s/3, to s.
TEST(FacetOverlap, PutsRowsOnTheBorder) {
  const Plane plane{Eigen::Matrix3d::Identity(), 0.0};
  const Face own = face_of(plane, 1, 1.0, 0.0, false, true);
  for (const double s : {0.1, 0.25, 0.5, 0.9, 0.999, 1.0}) {
    Face main = face_of(plane, 1, 1.0, 0.0, false, false);
    for (Vector3d& node : main.nodes) node.x() *= s;
    const FacetOverlap overlap = overlap_of(own.corners(0), main);
    const FacetShape corners = own.corners(0);
    const double share = s / (3.0 - 2.0 * s);
    for (Eigen::Index i = 0; i < 4; ++i) {
      const bool is_outside = corners.at[static_cast<std::size_t>(i)].x() > 0.5;
      const double area = 0.5 * (is_outside ? 0.5 * s * s : s - 0.5 * s * s);
      double place = 0.0;
      for (std::size_t j = 0; j < 4; ++j)
        place += overlap.own(i, static_cast<Eigen::Index>(j)) * corners.at[j].x();
      EXPECT_NEAR(overlap.area[i], area, exact);
      const double centroid =
          is_outside ? 2.0 / 3.0 * s : (0.5 * s * s - s * s * s / 3.0) / (s - 0.5 * s * s);
      EXPECT_NEAR(place / area, (1.0 - share) * centroid + (is_outside ? share : 0.0), margin) << s;
      if (is_outside) {
        EXPECT_NEAR(place / area, s, margin) << s;
      }
    }
  }
}

}  // namespace
