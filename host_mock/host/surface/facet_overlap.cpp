// SPDX-License-Identifier: BSD-3-Clause
#include "surface/facet_overlap.hpp"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>

namespace ilaw::host {
namespace {

// Parts of a facet's area: an overlap that is rounding; an overlap whose test functions are its shape
// functions, because dual ones would divide by fourth powers of its width, and where they begin to be a
// blend.
constexpr double least_part = 1e-12, thin = 0.02, wide = 0.1;
// Of a facet's size: rounding of the places of corners.
constexpr double corner_rounding = 1e-9;

struct QuadraturePoint {
  double a, b, weight;
};
// Degree 4 (Dunavant 1985).
constexpr double a_1 = 0.445948490915965, w_1 = 0.223381589678011, a_2 = 0.091576213509771,
                 w_2 = 0.109951743655322;
constexpr std::array<QuadraturePoint, 6> quadrature{{{a_1, a_1, w_1},
                                                     {a_1, 1.0 - 2.0 * a_1, w_1},
                                                     {1.0 - 2.0 * a_1, a_1, w_1},
                                                     {a_2, a_2, w_2},
                                                     {1.0 - 2.0 * a_2, a_2, w_2},
                                                     {a_2, 1.0 - 2.0 * a_2, w_2}}};

// Calls visit(point, weight) for the quadrature points of a convex polygon.
template <class Visit>
void for_each_point(const Polygon& polygon, Visit visit) {
  for (std::size_t k = 1; k + 1 < polygon.size(); ++k) {
    const Eigen::Vector2d u = polygon[k] - polygon[0], v = polygon[k + 1] - polygon[0];
    const double area = 0.5 * (u[0] * v[1] - u[1] * v[0]);
    for (const QuadraturePoint& q : quadrature) visit(polygon[0] + q.a * u + q.b * v, area * q.weight);
  }
}

}  // namespace

FacetIntegral::FacetIntegral(const FacetShape& corners, FacetOverlap& overlap, std::vector<Polygon>& pieces,
                             double deepest)
    : count_(corners.count),
      origin_(corners.at[0]),
      normal_(corners.double_area().normalized()),
      first_((corners.at[1] - origin_ - normal_.dot(corners.at[1] - origin_) * normal_).normalized()),
      second_(normal_.cross(first_)),
      outline_(flat(corners)),
      shape_(outline_),
      size_(std::sqrt(outline_.area())),
      deepest_(deepest),
      pieces_(pieces),
      overlap_(overlap) {
  pieces_.clear();
  overlap_.area.setZero();
  overlap_.own.setZero();
  overlap_.parts.clear();
}

Eigen::Vector2d FacetIntegral::flat(const Eigen::Vector3d& point) const {
  const Eigen::Vector3d from = point - origin_;
  return {first_.dot(from), second_.dot(from)};
}

Polygon FacetIntegral::flat(const FacetShape& corners) const {
  Polygon polygon;
  for (std::size_t k = 0; k < corners.count; ++k) polygon.add(flat(corners.at[k]));
  return polygon;
}

void FacetIntegral::add(std::int32_t facet, const FacetShape& corners) {
  const Eigen::Vector3d outward = corners.double_area();
  if (!(normal_.dot(outward) < -least_cosine * outward.norm())) return;
  const Polygon other = flat(corners);
  const Polygon piece = clipped(other.reversed(), outline_);
  if (piece.size() < 3 || !(piece.area() > least_part * size_ * size_)) return;
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();
  for (std::size_t k = 0; k < piece.size(); ++k) middle += piece[k] / static_cast<double>(piece.size());
  const Eigen::Vector3d below = corners.at[0] - (origin_ + middle[0] * first_ + middle[1] * second_);
  if (below.dot(outward) > -deepest_ * normal_.dot(outward)) return;
  pieces_.push_back(piece);
  overlap_.parts.push_back({facet, Eigen::Matrix4d::Zero()});
  Eigen::Matrix4d& weights = overlap_.parts.back().weights;
  const FlatFacet other_shape(other);
  for_each_point(piece, [&](const Eigen::Vector2d& point, double weight) {
    const Eigen::Vector4d own = shape_.at(point);
    overlap_.area += weight * own;
    overlap_.own += weight * own * own.transpose();
    weights += weight * own * other_shape.at(point).transpose();
  });
}

// The largest share with which no row lies outside the overlap. The row of corner i lies between the centroid
// of N_i and the corner.
double FacetIntegral::dual_share() const {
  double share = 1.0;
  const auto n = static_cast<Eigen::Index>(count_);
  const double covered = overlap_.area.sum() / (size_ * size_);
  if (covered > 1.0 - corner_rounding) return 1.0;
  for (Eigen::Index i = 0; i < n; ++i) {
    if (!(overlap_.area[i] > least_part * size_ * size_)) continue;
    Eigen::Vector2d centroid = Eigen::Vector2d::Zero();
    for (Eigen::Index j = 0; j < n; ++j)
      centroid += overlap_.own(i, j) / overlap_.area[i] * outline_[static_cast<std::size_t>(j)];
    double reached = 0.0;
    for (const Polygon& piece : pieces_)
      reached = std::max(reached, last_inside(piece, centroid, outline_[static_cast<std::size_t>(i)],
                                              corner_rounding * size_));
    share = std::min(share, reached);
  }
  return share * std::clamp((covered - thin) / (wide - thin), 0.0, 1.0);
}

// psi = T N.
Eigen::Matrix4d FacetIntegral::test_functions(double dual_share) const {
  Eigen::Matrix4d t = (1.0 - dual_share) * Eigen::Matrix4d::Identity();
  if (dual_share == 0.0) return t;
  const auto n = static_cast<Eigen::Index>(count_);
  if (n == 3)
    t.topLeftCorner<3, 3>() +=
        dual_share * overlap_.area.head<3>().asDiagonal() * overlap_.own.topLeftCorner<3, 3>().inverse();
  else
    t += dual_share * overlap_.area.asDiagonal() * overlap_.own.inverse();
  return t;
}

void FacetIntegral::finish() {
  if (overlap_.parts.empty()) return;
  const double share = dual_share();
  const Eigen::Matrix4d t = test_functions(share);
  const Eigen::Matrix4d diagonal = overlap_.area.asDiagonal();
  overlap_.own = (1.0 - share) * overlap_.own + share * diagonal;
  for (FacetOverlap::Part& part : overlap_.parts) part.weights = t * part.weights;
}

}  // namespace ilaw::host
