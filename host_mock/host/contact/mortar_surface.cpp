// SPDX-License-Identifier: BSD-3-Clause
#include "contact/mortar_surface.hpp"

#include "base/bytes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace ilaw::host {
namespace {

// In shortest edges of the main surface: how far a row slides before its weights are integrated again, or a
// facet that is covered in part, into which another one may slide, and how far beyond the reach facets are
// listed.
constexpr double most_slip = 0.02, most_slip_aside = 0.1, listed_beyond = 0.1;
constexpr double most_depth = 0.5;       // in the same, as edge rows have it: facets behind a facet
constexpr double cosine_of_tilt = 0.55;  // beyond it another face of the body is closer
constexpr double whole_facet = 0.999;    // part of a facet that counts as covered
constexpr double least_weight = 1e-15;   // smaller ones are rounding

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

Eigen::AlignedBox3d bounds_of(const FacetShape& corners) {
  Eigen::AlignedBox3d box;
  for (std::size_t k = 0; k < corners.count; ++k) box.extend(corners.at[k]);
  return box;
}

// A bound of the distance from a point of the box to the facet: boxes in other axes are that much farther
// apart.
double box_slack(const FacetShape& corners) {
  const Eigen::AlignedBox3d box = bounds_of(corners);
  double most = 0.0;
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Vector3d at = box.corner(static_cast<Eigen::AlignedBox3d::CornerType>(corner));
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < corners.count; ++k)
      least = std::min(least, (at - corners.at[k]).squaredNorm());
    most = std::max(most, least);
  }
  return std::sqrt(most);
}

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

// ---- which facets are near ------------------------------------------------------------------------------

// Of both surfaces relative to each other, at most, since the list was made; moving together is none.
double MortarSurface::motion() const {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  const auto moved = [&](int node) {
    return (at_.segment<3>(3 * Eigen::Index{node}) - at_list_.segment<3>(3 * Eigen::Index{node})).eval();
  };
  for (const int node : partners()) mean += moved(node);
  mean /= static_cast<double>(partners().size());
  double own = 0.0, main = 0.0;
  for (const int node : nodes_) own = std::max(own, (moved(node) - mean).squaredNorm());
  for (const int node : partners()) main = std::max(main, (moved(node) - mean).squaredNorm());
  return std::sqrt(own) + std::sqrt(main);
}

// Lists and weights follow from the steps alone, not from the outputs between them.
bool MortarSurface::find_near(const Dofs& u, const Approach& approach) {
  travelled_ += approach.travelled;
  const bool is_far = is_list_made_ && listed_.empty() && travelled_ + approach.reach < horizon_;
  if (is_far && approach.is_idle && !approach.is_forced) return false;
  MeshSurface::follow(u);
  at_ = model_.position() + u;
  if (is_far) return approach.is_forced;
  travelled_ = motion();
  const bool is_due = !is_list_made_ || !(travelled_ + std::max(approach.reach, widest_) < horizon_);
  if (is_due) list_pairs(approach.reach);
  if (is_due) travelled_ = 0.0;
  refresh();
  return is_due || approach.is_forced;
}

void MortarSurface::follow(const Dofs& u) {
  MeshSurface::follow(u);
  at_ = model_.position() + u;
  if (!is_list_made_) list_pairs(0.0);
  refresh();
}

// With boxes of its own axes the search finds all pairs whose boxes are within the horizon in these axes.
void MortarSurface::find_candidates(double farther) {
  double own = 0.0, main = 0.0;
  for (const Patch& patch : patches_) own = std::max(own, box_slack(corners_of(patch)));
  for (std::size_t k = 0; k < facets().size(); ++k)
    main = std::max(main, box_slack(corners_of(static_cast<std::int32_t>(k))));
  ilaw_facets_overlaps_of asked{};
  asked.struct_size = sizeof asked;
  asked.corner_count = 4;
  asked.count = static_cast<std::int64_t>(patches_.size());
  asked.points = face_points_.data();
  asked.distance = horizon_ + own + main + farther;
  asked.first = first_.data();
  do {
    found_.resize(std::max(found_.size(), static_cast<std::size_t>(first_.back())));
    asked.capacity = static_cast<std::int64_t>(found_.size());
    asked.facets = found_.data();
    check_search(ilaw_facets_overlaps(search(), &asked));
  } while (first_.back() > asked.capacity);
}

// Leaves the facets whose boxes are within the horizon of that of the patch, which is swept outward by a
// rise.
MortarSurface::Found MortarSurface::near(std::size_t patch, double rise) {
  const FacetShape corners = corners_of(patches_[patch]);
  Eigen::AlignedBox3d face = bounds_of(corners);
  const Eigen::Vector3d way = rise * corners.double_area().normalized();
  for (std::size_t k = 0; k < corners.count; ++k) face.extend(corners.at[k] + way);
  const auto first = found_.begin() + first_[patch];
  return {first, std::remove_if(first, found_.begin() + first_[patch + 1], [&](std::int32_t facet) {
            return face.squaredExteriorDistance(bounds_of(corners_of(facet))) > horizon_ * horizon_;
          })};
}

// A patch that is tilted to what it is near overlaps with facets below its raised end, which are farther: how
// far, where that is beyond the horizon.
double MortarSurface::rise_of(std::size_t patch, const Found& found) const {
  const FacetShape corners = corners_of(patches_[patch]);
  const Eigen::Vector3d normal = corners.double_area().normalized();
  double size = 0.0, steepest = 0.0;
  for (std::size_t k = 0; k < corners.count; ++k)
    size = std::max(size, (corners.at[k] - corners.at[0]).norm());
  size = std::max(size, (corners.at[1] - corners.at[corners.count - 1]).norm());
  for (auto facet = found.begin; facet != found.end; ++facet) {
    const Eigen::Vector3d other = corners_of(*facet).double_area().normalized();
    const double cosine = -normal.dot(other);
    if (cosine > cosine_of_tilt) steepest = std::max(steepest, normal.cross(other).norm() / cosine);
  }
  return size * steepest > horizon_ ? size * steepest : 0.0;
}

// The largest gap of rows that act on springs, which reach farther than contact.
double MortarSurface::widest_opening() {
  double widest = 0.0;
  if (!stores_energy_) return widest;
  find_normals();
  for (const std::int32_t k : listed_nodes_) {
    if (!MeshSurface::is_held(k)) continue;
    locate(static_cast<std::size_t>(k));
    const Row& row = rows_[static_cast<std::size_t>(k)];
    if (row.area > 0.0) widest = std::max(widest, row.apart.dot(row.normal));
  }
  return widest;
}

// Boxes of the search are those of an earlier step, with a margin: the list must not depend on which.
void MortarSurface::list_pairs(double reach) {
  if (is_list_made_) past_motion_ += motion();
  is_list_made_ = true;
  at_list_ = at_;
  widest_ = widest_opening();
  horizon_ = std::max(reach, widest_) + listed_beyond * shortest_edge();
  find_candidates(0.0);
  near_counts_.resize(patches_.size());
  rises_.resize(patches_.size());
  double highest = 0.0;
  for (std::size_t p = 0; p < patches_.size(); ++p) {
    const Found found = near(p, 0.0);
    near_counts_[p] = found.end - found.begin;
    rises_[p] = rise_of(p, found);
    highest = std::max(highest, rises_[p]);
  }
  if (highest > 0.0) {
    find_candidates(highest);
    for (std::size_t p = 0; p < patches_.size(); ++p) {
      if (near_counts_[p] == 0) continue;
      const Found found = near(p, rises_[p]);
      near_counts_[p] = found.end - found.begin;
    }
  }
  listed_.clear();
  for (std::size_t p = 0; p < patches_.size(); ++p) {
    Patch& patch = patches_[p];
    const auto first = found_.begin() + first_[p], end = first + near_counts_[p];
    if (!std::equal(first, end, patch.candidates.begin(), patch.candidates.end())) {
      patch.candidates.assign(first, end);
      patch.is_stale = true;
    }
    if (first != end || patch.is_stale) listed_.push_back(static_cast<std::int32_t>(p));
  }
  list_nodes();
}

void MortarSurface::list_nodes() {
  listed_nodes_.clear();
  listed_facets_.clear();
  for (const std::int32_t p : listed_) {
    const Patch& patch = patches_[static_cast<std::size_t>(p)];
    listed_facets_.insert(listed_facets_.end(), patch.candidates.begin(), patch.candidates.end());
    // of its rows, until it is integrated again
    for (const FacetOverlap::Part& part : patch.overlap.parts) listed_facets_.push_back(part.facet);
  }
  std::sort(listed_facets_.begin(), listed_facets_.end());
  listed_facets_.erase(std::unique(listed_facets_.begin(), listed_facets_.end()), listed_facets_.end());
  std::fill(is_listed_.begin(), is_listed_.end(), std::uint8_t{0});
  for (const std::int32_t p : listed_) {
    const Patch& patch = patches_[static_cast<std::size_t>(p)];
    for (std::size_t k = 0; k < patch.corner_count; ++k) {
      std::uint8_t& is_listed = is_listed_[static_cast<std::size_t>(patch.corners[k])];
      if (is_listed == 0) listed_nodes_.push_back(patch.corners[k]);
      is_listed = 1;
    }
  }
}

double MortarSurface::gap_bound(int node_index, const Dofs& /*u*/, double /*time*/) const {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  return is_listed_[static_cast<std::size_t>(node_index)] != 0 ? -infinity
                                                               : std::nextafter(horizon_, infinity);
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
