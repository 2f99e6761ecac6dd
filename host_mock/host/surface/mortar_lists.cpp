// Which facets of both surfaces are near each other.
// SPDX-License-Identifier: BSD-3-Clause
#include "surface/mortar_surface.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>

namespace ilaw::host {
namespace {

constexpr double listed_beyond = 0.1;    // the reach, in shortest edges of the main surface
constexpr double cosine_of_tilt = 0.55;  // beyond it another face of the body is closer

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

// Between the boxes of both surfaces.
double MortarSurface::clearance() const {
  Eigen::AlignedBox3d own, main;
  for (const int node : nodes_) own.extend(place(node));
  for (const int node : partners()) main.extend(place(node));
  return own.exteriorDistance(main);
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

// Leaves the facets whose boxes are within the horizon of that of the patch, which is swept outward by a rise
// and inward by a depth.
MortarSurface::Found MortarSurface::near(std::size_t patch, double rise, double depth) {
  const FacetShape corners = corners_of(patches_[patch]);
  Eigen::AlignedBox3d face = bounds_of(corners);
  const Eigen::Vector3d normal = corners.double_area().normalized();
  for (std::size_t k = 0; k < corners.count; ++k)
    for (const double way : {rise, -depth}) face.extend(corners.at[k] + way * normal);
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

// Finds the largest gap of rows that act on springs, which reach farther than contact; returns the largest
// overlap of rows.
double MortarSurface::find_reach_of_rows() {
  widest_ = 0.0;
  double deepest = is_list_made_ ? 0.0 : most_depth * shortest_edge();  // bodies may overlap at the start
  find_normals();
  for (const std::int32_t k : listed_nodes_) {
    locate(static_cast<std::size_t>(k));
    const Row& row = rows_[static_cast<std::size_t>(k)];
    if (row.area == 0.0) continue;
    const double gap = row.apart.dot(row.normal);
    deepest = std::max(deepest, -gap);
    if (stores_energy_ && MeshSurface::is_held(k)) widest_ = std::max(widest_, gap);
  }
  return std::min(deepest, most_depth * shortest_edge());
}

// Boxes of the search are those of an earlier step, with a margin: the list must not depend on which.
void MortarSurface::list_pairs(double reach) {
  if (is_list_made_) past_motion_ += motion();
  const double depth = find_reach_of_rows();
  is_list_made_ = true;
  at_list_ = at_;
  horizon_ = std::max(reach, widest_) + listed_beyond * shortest_edge();
  near_counts_.assign(patches_.size(), 0);
  const double apart = clearance();
  if (apart > horizon_ + depth)
    horizon_ = apart;
  else
    find_near_counts(depth);
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

void MortarSurface::find_near_counts(double depth) {
  find_candidates(depth);
  rises_.resize(patches_.size());
  double highest = 0.0;
  for (std::size_t p = 0; p < patches_.size(); ++p) {
    const Found found = near(p, 0.0, depth);
    near_counts_[p] = found.end - found.begin;
    rises_[p] = rise_of(p, found);
    highest = std::max(highest, rises_[p]);
  }
  if (highest > 0.0) {
    find_candidates(std::max(highest, depth));
    for (std::size_t p = 0; p < patches_.size(); ++p) {
      if (near_counts_[p] == 0) continue;
      const Found found = near(p, rises_[p], depth);
      near_counts_[p] = found.end - found.begin;
    }
  }
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

}  // namespace ilaw::host
