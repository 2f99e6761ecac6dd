// SPDX-License-Identifier: BSD-3-Clause
#include "surface.hpp"

#include <algorithm>
#include <map>
#include <utility>

namespace ilaw::search {
namespace {

// Facets of a leaf: the box of so few costs less than they do.
constexpr std::size_t leaf_size = 4;

std::vector<std::int32_t> nodes_of(const ilaw_facets_setup& setup) {
  std::vector<std::int32_t> nodes(setup.facets, setup.facets + setup.facet_count * setup.corner_count);
  for (std::int32_t& node : nodes) node -= setup.index_base;
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  return nodes;
}

std::vector<Vec> places_of(const std::vector<std::int32_t>& nodes, const Positions& positions) {
  std::vector<Vec> places;
  for (const std::int32_t node : nodes) places.push_back(positions[node]);
  return places;
}

}  // namespace

Surface::Surface(const ilaw_facets_setup& setup, const Positions& start)
    : is_plane_(setup.dimension == 2),
      model_nodes_(nodes_of(setup)),
      facets_([&] {
        std::vector<Nodes> facets;
        for (std::int64_t f = 0; f < setup.facet_count; ++f) {
          Nodes& facet = facets.emplace_back();
          for (std::size_t k = 0; k < 4; ++k) {
            const std::size_t corner = std::min<std::size_t>(k, setup.corner_count - 1);
            const std::int32_t node =
                setup.facets[f * setup.corner_count + static_cast<std::int64_t>(corner)];
            facet[k] = static_cast<std::uint32_t>(
                std::lower_bound(model_nodes_.begin(), model_nodes_.end(), node - setup.index_base) -
                model_nodes_.begin());
          }
        }
        return facets;
      }()),
      now_(places_of(model_nodes_, start)),
      fitted_(now_.size()),
      axes_(now_, is_plane_),
      tree_(centers(), leaf_size),
      facet_boxes_(facets_.size()),
      slabs_(facets_.size()) {
  for (const Nodes& facet : facets_) {
    const bool is_triangle = facet[2] == facet[3];
    shapes_.push_back(is_plane_ ? Shape::segment : is_triangle ? Shape::triangle : Shape::quadrilateral);
  }
  find_border(setup.corner_count);
  measure_edges();
  refit();
}

// In the plane the borders of a facet are its corners.
void Surface::find_border(std::size_t corner_count) {
  const auto edge_of = [&](const Nodes& facet, std::size_t k) {
    const std::uint32_t a = facet[k], b = is_plane_ ? a : facet[(k + 1) % 4];
    return std::pair(std::min(a, b), std::max(a, b));
  };
  const std::size_t edges = is_plane_ ? corner_count : 4;
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> facets_along;
  for (const Nodes& facet : facets_)
    for (std::size_t k = 0; k < edges; ++k) ++facets_along[edge_of(facet, k)];
  for (const Nodes& facet : facets_) {
    std::array<bool, 4>& border = border_.emplace_back();
    for (std::size_t k = 0; k < edges; ++k) border[k] = facets_along[edge_of(facet, k)] == 1;
  }
}

void Surface::measure_edges() {
  double sum = 0.0;
  std::size_t count = 0;
  for (const Nodes& facet : facets_)
    for (std::size_t k = 0; k < 4; ++k) {
      const std::uint32_t a = facet[k], b = facet[(k + 1) % 4];
      if (a == b) continue;
      const double length = norm(now_[a] - now_[b]);
      shortest_edge_ = std::min(shortest_edge_, length);
      sum += length;
      ++count;
    }
  mean_edge_ = sum / static_cast<double>(count);
}

std::vector<Vec> Surface::centers() const {
  std::vector<Vec> centers;
  for (const Nodes& n : facets_)
    centers.push_back(axes_.seen(0.25 * (now_[n[0]] + now_[n[1]] + now_[n[2]] + now_[n[3]])));
  return centers;
}

bool Surface::follow(const Positions& positions) {
  bool moved = false;
  Vec most{0.0, 0.0, 0.0};
  for (std::size_t k = 0; k < now_.size(); ++k) {
    const Vec p = positions[model_nodes_[k]];
    Vec& now = now_[k];
    moved = moved || !(p.x == now.x && p.y == now.y && p.z == now.z);
    most = {std::max(most.x, std::fabs(p.x)), std::max(most.y, std::fabs(p.y)),
            std::max(most.z, std::fabs(p.z))};
    now = p;
  }
  if (!moved) return false;
  axes_.follow(now_);
  double strain = 0.0;
  for (std::size_t k = 0; k < now_.size(); ++k) {
    const double square_of = square(axes_.seen(now_[k]) - fitted_[k]);
    strain = square_of <= strain ? strain : square_of;  // not a number stays
  }
  strain_ = std::sqrt(strain);
  largest_ = largest(most);
  return true;
}

void Surface::refit() {
  for (std::size_t k = 0; k < now_.size(); ++k) {
    fitted_[k] = axes_.seen(now_[k]);
    largest_ = std::max(largest_, largest(now_[k]));
  }
  strain_ = 0.0;
  for (std::size_t f = 0; f < facets_.size(); ++f) {
    slabs_[f] = slab_of(facets_[f]);
    Box& box = facet_boxes_[f] = {};
    for (const std::uint32_t node : facets_[f]) box.add(fitted_[node]);
  }
  tree_.fit(boxes_, [&](std::int32_t f) { return facet_boxes_[static_cast<std::size_t>(f)]; });
  tree_.fit(normals_, [&](std::int32_t f) {
    const Vec n = slabs_[static_cast<std::size_t>(f)].n;
    return Box{n, n};
  });
}

// The mean plane of the corners; a bilinear patch is inside the hull of its corners.
Surface::Slab Surface::slab_of(const Nodes& facet) const {
  const std::array<Vec, 4> x{fitted_[facet[0]], fitted_[facet[1]], fitted_[facet[2]], fitted_[facet[3]]};
  Slab slab;
  slab.center = 0.25 * (x[0] + x[1] + x[2] + x[3]);
  if (is_plane_) {
    slab.center = 0.5 * (x[0] + x[1]);
    slab.u = unit(x[1] - x[0]);
    slab.n = {slab.u.y, -slab.u.x, 0.0};
    slab.v = {0.0, 0.0, 1.0};
  } else {
    slab.n = unit(cross(x[2] - x[0], x[3] - x[1]));
    slab.u = unit(x[1] + x[2] - x[0] - x[3]);
    slab.u = unit(slab.u - dot(slab.u, slab.n) * slab.n);
    slab.v = cross(slab.n, slab.u);
  }
  slab.half = {0.0, 0.0, 0.0};
  for (const Vec corner : x) {
    const Vec from = corner - slab.center;
    slab.half = {std::max(slab.half.x, std::fabs(dot(from, slab.u))),
                 std::max(slab.half.y, std::fabs(dot(from, slab.v))),
                 std::max(slab.half.z, std::fabs(dot(from, slab.n)))};
  }
  return slab;
}

}  // namespace ilaw::search
