// SPDX-License-Identifier: BSD-3-Clause
#include "surface/mortar_surface.hpp"

#include "base/bytes.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace ilaw::host {
namespace {

// In shortest edges of the main surface: how far a row slides before its weights are integrated again, or a
// facet that is covered in part, into which another one may slide.
constexpr double most_slip = 0.02, most_slip_aside = 0.1;
constexpr double whole_facet = 0.999;   // part of a facet that counts as covered
constexpr double least_weight = 1e-15;  // smaller ones are rounding

template <class Number>
void add_to(std::vector<std::pair<std::int32_t, double>>& sums, std::int32_t key, Number value) {
  for (auto& [known, sum] : sums)
    if (known == key) {
      sum += value;
      return;
    }
  sums.emplace_back(key, value);
}

void check_indices(const std::vector<std::int32_t>& indices, std::size_t count) {
  for (const std::int32_t index : indices)
    if (index < 0 || static_cast<std::size_t>(index) >= count) refuse_damaged();
}

// A triangle names its last corner twice.
std::size_t corner_count_of(const std::array<int, 4>& facet) { return facet[3] == facet[2] ? 3 : 4; }

}  // namespace

MortarSurface::MortarSurface(const Model& model, const NodeSet& own, const NodeSet& surface)
    : MeshSurface(model, own.nodes, surface),
      patches_of_(own.nodes.size()),
      rows_(own.nodes.size()),
      is_listed_(own.nodes.size(), std::uint8_t{1}),  // until a list is made
      at_(model.position()),
      at_list_(at_) {
  std::vector<std::int32_t> index(static_cast<std::size_t>(model.node_count()), -1);
  for (std::size_t k = 0; k < own.nodes.size(); ++k)
    index[static_cast<std::size_t>(own.nodes[k])] = static_cast<std::int32_t>(k);
  for (const auto& facet : own.facets) {
    Patch patch{{}, corner_count_of(facet), {}, {}};
    for (std::size_t k = 0; k < 4; ++k) {
      patch.corners[k] = index[static_cast<std::size_t>(facet[k])];
      face_points_.push_back(patch.corners[k]);
      if (k < patch.corner_count)
        patches_of_[static_cast<std::size_t>(patch.corners[k])].push_back(
            static_cast<std::int32_t>(patches_.size()));
    }
    patches_.push_back(patch);
  }
  first_.resize(patches_.size() + 1);
}

FacetShape MortarSurface::corners_of(const Patch& patch) const {
  FacetShape corners{patch.corner_count, {}};
  for (std::size_t k = 0; k < corners.count; ++k)
    corners.at[k] = place(nodes_[static_cast<std::size_t>(patch.corners[k])]);
  return corners;
}

FacetShape MortarSurface::corners_of(std::int32_t main_facet) const {
  const Facet& facet = facets()[static_cast<std::size_t>(main_facet)];
  FacetShape corners{corner_count_of(facet), {}};
  for (std::size_t k = 0; k < corners.count; ++k) corners.at[k] = place(facet[k]);
  return corners;
}

// ---- weights --------------------------------------------------------------------------------------------

bool MortarSurface::has_slid(const Row& row) const {
  const Eigen::Vector3d change = row.apart - row.start;
  const double along = change.dot(row.normal);
  return change.squaredNorm() - along * along > std::pow(most_slip * shortest_edge(), 2);
}

void MortarSurface::find_normals() {
  normals_.resize(facets().size());
  for (const std::int32_t facet : listed_facets_)
    normals_[static_cast<std::size_t>(facet)] = corners_of(facet).double_area().normalized();
}

// Facets without a row to tell it are looked at as often as rows would be.
void MortarSurface::refresh() {
  find_normals();
  for (const std::int32_t k : listed_nodes_) {
    locate(static_cast<std::size_t>(k));
    if (const Row& row = rows_[static_cast<std::size_t>(k)]; row.area > 0.0 && has_slid(row))
      for (const std::int32_t p : patches_of_[static_cast<std::size_t>(k)])
        patches_[static_cast<std::size_t>(p)].is_stale = true;
  }
  const double now = listed_.empty() ? 0.0 : past_motion_ + motion();
  for (const std::int32_t p : listed_) {
    Patch& patch = patches_[static_cast<std::size_t>(p)];
    const double slip = (now - patch.motion) / shortest_edge();
    const auto is_covered_in_part = [&] {
      return patch.candidates.size() > patch.overlap.parts.size() &&
             patch.overlap.area.sum() < whole_facet * 0.5 * corners_of(patch).double_area().norm();
    };
    const bool may_meet =
        patch.overlap.parts.empty() ? slip > most_slip : slip > most_slip_aside && is_covered_in_part();
    if (!patch.is_stale && !may_meet) continue;
    integrate(patch);
    patch.motion = now;
    patch.is_stale = false;
    for (std::size_t k = 0; k < patch.corner_count; ++k)
      rows_[static_cast<std::size_t>(patch.corners[k])].is_stale = true;
  }
  for (const std::int32_t k : listed_nodes_)
    if (rows_[static_cast<std::size_t>(k)].is_stale) assemble(static_cast<std::size_t>(k));
}

void MortarSurface::integrate(Patch& patch) {
  FacetIntegral integral(corners_of(patch), patch.overlap, pieces_, most_depth * shortest_edge());
  for (const std::int32_t facet : patch.candidates) integral.add(facet, corners_of(facet));
  integral.finish();
}

void MortarSurface::assemble(std::size_t node_index) {
  Row& row = rows_[node_index];
  row = {.partners = std::move(row.partners), .normals = std::move(row.normals)};
  row.partners.clear();
  row.normals.clear();
  own_sums_.clear();
  main_sums_.clear();
  const int node = nodes_[node_index];
  for (const std::int32_t p : patches_of_[node_index]) {
    const Patch& patch = patches_[static_cast<std::size_t>(p)];
    if (patch.overlap.parts.empty()) continue;
    const auto corner =
        std::find(patch.corners.begin(), patch.corners.end(), static_cast<std::int32_t>(node_index)) -
        patch.corners.begin();
    row.area += patch.overlap.area[corner];
    for (std::size_t j = 0; j < patch.corner_count; ++j)
      add_to(own_sums_, nodes_[static_cast<std::size_t>(patch.corners[j])],
             patch.overlap.own(corner, static_cast<Eigen::Index>(j)));
    for (const FacetOverlap::Part& part : patch.overlap.parts) {
      const Facet& facet = facets()[static_cast<std::size_t>(part.facet)];
      add_to(row.normals, part.facet, part.weights.row(corner).sum());
      for (std::size_t k = 0; k < 4; ++k)
        add_to(main_sums_, facet[k], part.weights(corner, static_cast<Eigen::Index>(k)));
    }
  }
  for (auto& [other, weight] : own_sums_) {
    weight /= row.area;
    if (other == node)
      row.own_weight = weight;
    else if (std::fabs(weight) > least_weight)
      row.partners.push_back({other, -weight});
  }
  row.own_partners = row.partners.size();
  for (const auto& [other, weight] : main_sums_)
    if (std::fabs(weight) > least_weight * row.area) row.partners.push_back({other, weight / row.area});
  locate(node_index);
  row.start = row.apart;
}

// ---- a step ---------------------------------------------------------------------------------------------

void MortarSurface::locate(std::size_t node_index) {
  Row& row = rows_[node_index];
  if (row.area == 0.0) return;
  row.apart = row.own_weight * place(nodes_[node_index]);
  for (const Partner& partner : row.partners) row.apart -= partner.weight * place(partner.node);
  row.normal.setZero();
  for (const auto& [facet, weight] : row.normals)
    row.normal += weight * normals_[static_cast<std::size_t>(facet)];
  row.normal.normalize();
}

void MortarSurface::find_contact(int node_index, const Dofs& u, double time, ContactPoint& found) const {
  const Row& row = rows_[static_cast<std::size_t>(node_index)];
  if (row.area == 0.0) {
    MeshSurface::find_contact(node_index, u, time, found);
    const bool is_listed = is_listed_[static_cast<std::size_t>(node_index)] != 0;
    const double deepest = is_listed ? most_depth * shortest_edge() : 0.0;
    if (is_held(node_index) || !(found.gap < -deepest)) return;
    found.behind = -std::exchange(found.gap, horizon_);
    found.is_beyond_border = true;
    return;
  }
  found.clear();
  found.gap = row.apart.dot(row.normal);
  found.normal = row.normal;
  found.own_weight = row.own_weight;
  found.area = stores_energy_ ? 0.0 : row.area;
  found.own_partners = row.own_partners;
  for (const Partner& partner : row.partners) found.partners.add(partner);
}

// A row carries to the border and not beyond: contact needs no memory of who was there.
bool MortarSurface::is_held(int node_index) const {
  return bonds_ && rows_[static_cast<std::size_t>(node_index)].area == 0.0 &&
         MeshSurface::is_held(node_index);
}

void EdgeRows::find_contact(int node_index, const Dofs& u, double time, ContactPoint& found) const {
  MeshSurface::find_contact(node_index, u, time, found);
  if (!(found.gap < -deepest_)) return;
  found.gap = deepest_;
  found.is_beyond_border = true;
}

// ---- checkpoints ----------------------------------------------------------------------------------------

// Weights were integrated in earlier steps. A row follows from its patches, but for its start.
void MortarSurface::save(std::ostream& out) const {
  MeshSurface::save(out);
  write_value(out, std::uint8_t{is_list_made_});
  write_array(out, at_list_.data(), static_cast<std::size_t>(at_list_.size()));
  for (const double value : {horizon_, widest_, travelled_, past_motion_}) write_value(out, value);
  write_sized(out, listed_);
  for (const Patch& patch : patches_) {
    write_value(out, patch.motion);
    write_sized(out, patch.candidates);
    write_value(out, std::uint64_t{patch.overlap.parts.size()});
    write_array(out, patch.overlap.area.data(), 4);
    write_array(out, patch.overlap.own.data(), 16);
    for (const FacetOverlap::Part& part : patch.overlap.parts) {
      write_value(out, part.facet);
      write_array(out, part.weights.data(), 16);
    }
  }
  for (const Row& row : rows_) write_array(out, row.start.data(), 3);
}

void MortarSurface::load(std::istream& in) {
  MeshSurface::load(in);
  std::uint8_t is_list_made = 0;
  read_value(in, is_list_made);
  is_list_made_ = is_list_made != 0;
  read_array(in, at_list_.data(), static_cast<std::size_t>(at_list_.size()));
  for (double* const value : {&horizon_, &widest_, &travelled_, &past_motion_}) read_value(in, *value);
  listed_ = read_sized<std::int32_t>(in, patches_.size());
  check_indices(listed_, patches_.size());
  for (Patch& patch : patches_) {
    read_value(in, patch.motion);
    patch.candidates = read_sized<std::int32_t>(in, facets().size());
    check_indices(patch.candidates, facets().size());
    std::uint64_t parts = 0;
    read_value(in, parts);
    if (parts > facets().size()) refuse_damaged();
    patch.overlap.parts.resize(parts);
    read_array(in, patch.overlap.area.data(), 4);
    read_array(in, patch.overlap.own.data(), 16);
    for (FacetOverlap::Part& part : patch.overlap.parts) {
      read_value(in, part.facet);
      check_indices({part.facet}, facets().size());
      read_array(in, part.weights.data(), 16);
    }
  }
  list_nodes();
  find_normals();
  for (std::size_t k = 0; k < rows_.size(); ++k) {
    assemble(k);
    read_array(in, rows_[k].start.data(), 3);
  }
}

}  // namespace ilaw::host
