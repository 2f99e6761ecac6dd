// SPDX-License-Identifier: BSD-3-Clause
#include "surface/mesh_surface.hpp"

#include "base/bytes.hpp"

#include <ilaw/arrays.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <new>
#include <stdexcept>
#include <string>
#include <utility>

namespace ilaw::host {
namespace {

// How far a facet goes on beyond the border, in parts of the shortest edge.
constexpr double entering_rim = 1e-3, leaving_rim = 0.1;
constexpr std::size_t corner_count = 4;

}  // namespace

void check_search(ilaw_result code) {
  if (code == ILAW_OUT_OF_MEMORY) throw std::bad_alloc();
  if (code != ILAW_OK) throw std::logic_error("ilaw/search.h refuses a call: code " + std::to_string(code));
}

MeshSurface::MeshSurface(const Model& model, std::vector<int> nodes, const NodeSet& surface)
    : Counterpart(model, std::move(nodes), surface.nodes),
      facets_(surface.facets),
      is_listed_(nodes_.size(), std::uint8_t{1}),  // until a list is made
      held_(nodes_.size()) {
  ilaw_facets_setup setup{};
  setup.struct_size = sizeof setup;
  setup.dimension = 3;
  setup.corner_count = corner_count;
  setup.node_count = model.node_count();
  setup.facet_count = static_cast<std::int64_t>(facets_.size());
  setup.facets = facets_.front().data();
  setup.point_count = static_cast<std::int64_t>(nodes_.size());
  setup.points = nodes_.data();
  setup.position = ilaw::input(model.position().data(), 3, 1);
  ilaw_facets* search = nullptr;
  check_search(ilaw_facets_create(&setup, &search));
  search_.reset(search);
  ilaw_facets_counts counts{};
  counts.struct_size = sizeof counts;
  check_search(ilaw_facets_count(search, &counts));
  shortest_edge_ = counts.shortest_edge;
  nearby_.struct_size = sizeof nearby_;
  MeshSurface::follow(Dofs::Zero(model.mass().size()));
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

void MeshSurface::follow(const Dofs& u) {
  const ilaw_facets_positions positions{sizeof positions, 0, ilaw::input(model_.position().data(), 3, 1),
                                        ilaw::input(u.data(), 3, 1)};
  check_search(ilaw_facets_update(search_.get(), &positions));
}

// As long as nobody can have come into reach, positions are not looked at.
bool MeshSurface::find_near(const Dofs& u, const Approach& approach) {
  travelled_ += approach.travelled;
  const bool is_far = is_apart(approach.reach) || travelled_ + approach.reach < nearby_.slack;
  if (!approach.is_forced && approach.is_idle && is_far) return false;
  follow(u);
  travelled_ = 0.0;
  nearby_.forced = approach.is_forced ? 1 : 0;
  nearby_.reach = approach.reach;
  check_search(ilaw_facets_near(search_.get(), &nearby_));
  if (nearby_.is_new == 0) return false;
  std::fill(is_listed_.begin(), is_listed_.end(), std::uint8_t{0});
  for (std::int64_t i = 0; i < nearby_.count; ++i)
    is_listed_[static_cast<std::size_t>(nearby_.points[i])] = 1;
  return true;
}

// Fills the outputs that are asked for, of this node alone.
void MeshSurface::find_pair(int node_index, ilaw_facets_pairs_of asked) const {
  const double rim = (is_held(node_index) ? leaving_rim : entering_rim) * shortest_edge_;
  asked.struct_size = sizeof asked;
  asked.count = 1;
  asked.points = &node_index;
  asked.rim = ilaw::input(&rim, 0, 0);
  check_search(ilaw_facets_pairs(search_.get(), &asked));
}

double MeshSurface::gap_bound(int node_index, const Dofs& /*u*/, double /*time*/) const {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  if (!is_listed_[static_cast<std::size_t>(node_index)]) return std::nextafter(nearby_.horizon, infinity);
  double approach = 0.0;
  ilaw_facets_pairs_of asked{};
  asked.approach = ilaw::output(&approach, 0, 0);
  find_pair(node_index, asked);
  return approach > 0.0 ? approach : -infinity;  // behind the surface by any distance
}

void MeshSurface::find_contact(int node_index, const Dofs& u, double /*time*/, ContactPoint& found) const {
  std::int32_t facet = 0, place = 0;
  found.clear();
  std::array<double, corner_count> weights{};
  found.normal.resize(3);
  ilaw_facets_pairs_of asked{};
  asked.facet = &facet;
  asked.place = &place;
  asked.gap = ilaw::output(&found.gap, 0, 0);
  asked.normal = ilaw::output(found.normal.data(), 0, 1);
  asked.weights = ilaw::output(weights.data(), 0, 1);
  find_pair(node_index, asked);
  const Facet& corners = facets_[static_cast<std::size_t>(std::max(facet, 0))];
  for (std::size_t k = 0; k < corner_count; ++k) found.partners.add({corners[k], weights[k]});
  found.is_beyond_border = place == ILAW_PLACE_BEYOND;
  // The way to a border is no gap along a normal: out of reach, as no node goes that far in a step.
  if (found.is_beyond_border) found.gap = std::max(found.gap, shortest_edge_);
  // In front of an edge between two facets, contact is along the line to it.
  if (place != ILAW_PLACE_BESIDE || !(found.gap > entering_rim * shortest_edge_)) return;
  Eigen::Vector3d apart = position(node_index, u);
  for (const Partner& partner : found.partners) apart -= partner.weight * model_.position(partner.node, u);
  found.normal = apart.normalized();
}

}  // namespace ilaw::host
