// SPDX-License-Identifier: BSD-3-Clause
#include "contact/mesh_surface.hpp"

#include "base/bytes.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

namespace ilaw::host {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using Corners = std::array<Vector3d, 4>;

// A point on a patch: xi and eta in [-1, 1], with what the contact needs there.
struct Projection {
  std::array<double, 4> weights;
  Vector3d point, normal;
  double distance;
  std::array<bool, 4> is_at;  // edges of the patch, from corner k to k + 1
};

// How far a facet goes on beyond the border, in parts of the shortest edge.
constexpr double entering_rim = 1e-3, leaving_rim = 0.1;
// The same everywhere, for rounding.
constexpr double rounding_rim = 1e-6;

std::array<double, 4> shape_functions(const Vector2d& at) {
  const double a = 0.5 * (1.0 - at[0]), b = 0.5 * (1.0 + at[0]), c = 0.5 * (1.0 - at[1]),
               d = 0.5 * (1.0 + at[1]);
  return {a * c, b * c, b * d, a * d};
}

Vector3d along_xi(const Corners& x, const Vector2d& at) {
  return 0.25 * ((1.0 - at[1]) * (x[1] - x[0]) + (1.0 + at[1]) * (x[2] - x[3]));
}
Vector3d along_eta(const Corners& x, const Vector2d& at) {
  return 0.25 * ((1.0 - at[0]) * (x[3] - x[0]) + (1.0 + at[0]) * (x[2] - x[1]));
}
Vector3d point_of(const Corners& x, const Vector2d& at) {
  const std::array<double, 4> n = shape_functions(at);
  return n[0] * x[0] + n[1] * x[1] + n[2] * x[2] + n[3] * x[3];
}

bool is_triangle(const std::array<int, 4>& facet) { return facet[2] == facet[3]; }

// The nearest point of an edge from a to b, in parts of it from a on.
double along_edge(const Vector3d& p, const Vector3d& a, const Vector3d& b) {
  return std::clamp((p - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0);
}

// The nearest point of a triangle: inside, or that of the nearest edge. Its third edge is that from corner 3,
// which is corner 2 once more, to corner 0.
Projection project_on_triangle(const Vector3d& p, const Corners& x) {
  const Vector3d area = (x[1] - x[0]).cross(x[2] - x[0]);
  const auto part = [&](const Vector3d& a, const Vector3d& b) {
    return (a - p).cross(b - p).dot(area) / area.squaredNorm();
  };
  std::array<double, 4> weights{part(x[1], x[2]), part(x[2], x[0]), part(x[0], x[1]), 0.0};
  std::array<bool, 4> is_at{};
  if (*std::min_element(weights.begin(), weights.begin() + 3) <= 0.0) {
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t next = (k + 1) % 3;
      const double t = along_edge(p, x[k], x[next]);
      const double square = (p - (1.0 - t) * x[k] - t * x[next]).squaredNorm();
      if (!(square < least)) continue;
      least = square;
      weights = {};
      weights[k] = 1.0 - t;
      weights[next] = t;
    }
    is_at = {weights[2] == 0.0, weights[0] == 0.0, false, weights[1] == 0.0};
  }
  const Vector3d point = weights[0] * x[0] + weights[1] * x[1] + weights[2] * x[2];
  return {weights, point, area.normalized(), (p - point).norm(), is_at};
}

// Gauss-Newton for the nearest point, which takes one step on a parallelogram; a coordinate that
// leaves the patch is held at its edge.
Projection project(const Vector3d& p, const Corners& x) {
  Vector2d at = Vector2d::Zero();
  for (int iteration = 0; iteration < 12; ++iteration) {
    const Vector3d t1 = along_xi(x, at), t2 = along_eta(x, at), rest = p - point_of(x, at);
    Eigen::Matrix2d metric;
    metric << t1.dot(t1), t1.dot(t2), t1.dot(t2), t2.dot(t2);
    Vector2d step = metric.inverse() * Vector2d(t1.dot(rest), t2.dot(rest));
    const Vector2d free = at + step;
    if (std::abs(free[0]) > 1.0) {
      const double edge = std::copysign(1.0, free[0]);
      step = {edge - at[0], (t2.dot(rest) - t1.dot(t2) * (edge - at[0])) / t2.dot(t2)};
    } else if (std::abs(free[1]) > 1.0) {
      const double edge = std::copysign(1.0, free[1]);
      step = {(t1.dot(rest) - t1.dot(t2) * (edge - at[1])) / t1.dot(t1), edge - at[1]};
    }
    const Vector2d next = (at + step).cwiseMax(-1.0).cwiseMin(1.0);
    const double moved = (next - at).cwiseAbs().maxCoeff();
    at = next;
    if (!(moved > 1e-14)) break;
  }
  const Vector3d point = point_of(x, at);
  return {shape_functions(at),
          point,
          along_xi(x, at).cross(along_eta(x, at)).normalized(),
          (p - point).norm(),
          {at[1] == -1.0, at[0] == 1.0, at[1] == 1.0, at[0] == -1.0}};
}

}  // namespace

MeshSurface::MeshSurface(const Model& model, std::vector<int> nodes, const NodeSet& surface)
    : Counterpart(model, std::move(nodes), surface.nodes),
      facets_(surface.facets),
      nearest_(nodes_.size()),
      bound_(nodes_.size()),
      held_(nodes_.size()),
      shortest_edge_(std::numeric_limits<double>::infinity()) {
  find_neighbours();
  find_border();
  const Dofs undeformed = Dofs::Zero(model.mass().size());
  for (const Facet& facet : facets_)
    for (std::size_t k = 0; k < 4; ++k)
      if (const int a = facet[k], b = facet[(k + 1) % 4]; a != b)
        shortest_edge_ = std::min(shortest_edge_, (place_of(a, undeformed) - place_of(b, undeformed)).norm());
  MeshSurface::refresh(undeformed);
}

void MeshSurface::find_neighbours() {
  std::map<int, std::vector<std::size_t>> facets_at;
  for (std::size_t f = 0; f < facets_.size(); ++f)
    for (const int node : facets_[f]) facets_at[node].push_back(f);
  for (std::size_t f = 0; f < facets_.size(); ++f) {
    std::set<std::size_t> around;
    for (const int node : facets_[f]) around.insert(facets_at[node].begin(), facets_at[node].end());
    neighbours_.emplace_back(around.begin(), around.end());
  }
}

void MeshSurface::find_border() {
  const auto edge_of = [](const Facet& facet, std::size_t k) {
    const int a = facet[k], b = facet[(k + 1) % 4];
    return std::pair(std::min(a, b), std::max(a, b));
  };
  std::map<std::pair<int, int>, int> facets_along;
  for (const Facet& facet : facets_)
    for (std::size_t k = 0; k < 4; ++k) ++facets_along[edge_of(facet, k)];
  for (const Facet& facet : facets_) {
    std::array<bool, 4>& border = border_.emplace_back();
    for (std::size_t k = 0; k < 4; ++k) border[k] = facets_along[edge_of(facet, k)] == 1;
  }
}

// A node that vibrates is free in some steps without leaving.
void MeshSurface::note_contact(int node_index, bool touches, const ContactPoint& point) {
  std::uint8_t& held = held_[static_cast<std::size_t>(node_index)];
  if (touches)
    held = 1;
  else if (point.is_beyond_border || point.gap > leaving_rim * shortest_edge_)
    held = 0;
}

void MeshSurface::save(std::ostream& out) const { write_sized(out, held_); }

void MeshSurface::load(std::istream& in) {
  held_ = read_sized<std::uint8_t>(in, nodes_.size());
  if (held_.size() != nodes_.size()) refuse_damaged();
}

Vector3d MeshSurface::place_of(int node, const Dofs& u) const {
  return model_.position().segment<3>(3 * Eigen::Index{node}) + u.segment<3>(3 * Eigen::Index{node});
}

Vector3d MeshSurface::center(const Facet& facet, const Dofs& u) const {
  return 0.25 *
         (place_of(facet[0], u) + place_of(facet[1], u) + place_of(facet[2], u) + place_of(facet[3], u));
}

double MeshSurface::radius(const Facet& facet, const Dofs& u) const {
  const Vector3d middle = center(facet, u);
  double largest = 0.0;
  for (const int node : facet) largest = std::max(largest, (place_of(node, u) - middle).norm());
  return largest;
}

// The nearest centre tells the facet, or a neighbour of it; its distance less the largest radius
// bounds the gap, unless the point lies behind the surface.
void MeshSurface::refresh(const Dofs& u) {
  std::vector<Vector3d> centers;
  double largest_radius = 0.0;
  for (const Facet& facet : facets_) {
    centers.push_back(center(facet, u));
    largest_radius = std::max(largest_radius, radius(facet, u));
  }
#pragma omp parallel for schedule(static) if (nodes_.size() * facets_.size() > 100000)
  for (std::size_t k = 0; k < nodes_.size(); ++k) {
    const Vector3d p = place_of(nodes_[k], u);
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t f = 0; f < centers.size(); ++f)
      if (const double square = (p - centers[f]).squaredNorm(); square < least) {
        least = square;
        nearest_[k] = f;
      }
    const Facet& facet = facets_[nearest_[k]];
    const Vector3d normal =
        (place_of(facet[2], u) - place_of(facet[0], u)).cross(place_of(facet[3], u) - place_of(facet[1], u));
    const bool in_front = normal.dot(p - centers[nearest_[k]]) > 0.0;
    bound_[k] = in_front ? std::sqrt(least) - largest_radius : -std::numeric_limits<double>::infinity();
  }
}

double MeshSurface::gap_bound(int node_index, const Dofs& /*u*/, double /*time*/) const {
  return bound_[static_cast<std::size_t>(node_index)];
}

ContactPoint MeshSurface::contact_point(int node_index, const Dofs& u, double /*time*/) const {
  const auto k = static_cast<std::size_t>(node_index);
  const Vector3d p = place_of(nodes_[k], u);
  Projection best{};
  std::size_t facet = nearest_[k];
  best.distance = std::numeric_limits<double>::infinity();
  for (const std::size_t f : neighbours_[nearest_[k]]) {
    const Corners corners{place_of(facets_[f][0], u), place_of(facets_[f][1], u), place_of(facets_[f][2], u),
                          place_of(facets_[f][3], u)};
    const Projection projection =
        is_triangle(facets_[f]) ? project_on_triangle(p, corners) : project(p, corners);
    if (projection.distance < best.distance) {
      best = projection;
      facet = f;
    }
  }
  const double normal_distance = best.normal.dot(p - best.point);
  const double beside = (p - best.point - normal_distance * best.normal).norm();
  bool is_at_border = false;
  for (std::size_t e = 0; e < 4; ++e) is_at_border = is_at_border || (best.is_at[e] && border_[facet][e]);
  const double rim = (is_held(node_index) ? leaving_rim : entering_rim) * shortest_edge_;
  const bool is_on_rim = is_at_border && beside <= rim && normal_distance >= -rim;
  // A point that is nearest to an edge without facing the patch lies beside the surface: it is not in
  // contact.
  const bool is_over_patch = beside <= rounding_rim * shortest_edge_ || is_on_rim;
  return {is_over_patch ? normal_distance : best.distance,
          best.normal,
          ContactPoint::most_partners,
          facets_[facet],
          best.weights,
          is_at_border && !is_over_patch};
}

}  // namespace ilaw::host
