// SPDX-License-Identifier: BSD-3-Clause
#include "model/pressure.hpp"

#include <Eigen/Geometry>

#include <utility>

namespace ilaw::host {
namespace {

// Two points along each direction integrate the products of shape functions and tangents exactly:
// they are of degree two in each.
constexpr double gauss = 0.57735026918962576451;
constexpr std::array<std::array<double, 2>, 4> corner_at = {{{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}};

using Shape = Eigen::Vector4d;

// The area vector at a point, and the shape functions there.
Eigen::Vector3d area_vector(const FacetCorners& x, double xi, double eta, Shape& shape) {
  Shape along_xi, along_eta;
  for (std::size_t a = 0; a < 4; ++a) {
    const auto [s, t] = corner_at[a];
    const auto k = static_cast<Eigen::Index>(a);
    shape[k] = 0.25 * (1.0 + s * xi) * (1.0 + t * eta);
    along_xi[k] = 0.25 * s * (1.0 + t * eta);
    along_eta[k] = 0.25 * t * (1.0 + s * xi);
  }
  const Eigen::Vector3d u = x * along_xi, v = x * along_eta;
  return u.cross(v);
}

}  // namespace

FacetCorners facet_area_vectors(const FacetCorners& x) {
  FacetCorners parts = FacetCorners::Zero();
  for (const auto& [s, t] : corner_at) {
    Shape shape;
    const Eigen::Vector3d area = area_vector(x, gauss * s, gauss * t, shape);
    parts += area * shape.transpose();
  }
  return parts;
}

Pressure::Pressure(const Model& model, std::vector<Facet> facets, Table history)
    : model_(model), facets_(std::move(facets)), history_(std::move(history)) {}

void Pressure::add_force(double time, const Dofs& u, Dofs& force) const {
  const double pressure = history_.at(time)[0];
  if (pressure == 0.0) return;
  for (const Facet& facet : facets_) {
    FacetCorners x;
    for (std::size_t a = 0; a < 4; ++a) {
      const Eigen::Index dof = Eigen::Index{3} * facet[a];
      x.col(static_cast<Eigen::Index>(a)) = model_.position().segment<3>(dof) + u.segment<3>(dof);
    }
    for (const auto& [s, t] : corner_at) {
      Shape shape;
      const Eigen::Vector3d area = area_vector(x, gauss * s, gauss * t, shape);
      for (std::size_t a = 0; a < 4; ++a)
        force.segment<3>(Eigen::Index{3} * facet[a]) -= pressure * shape[static_cast<Eigen::Index>(a)] * area;
    }
  }
}

}  // namespace ilaw::host
