// finder.hpp - the closest facets of points, and which points are near.
//
// All bounds are distances in the axes of the surface, between the points and the facets as the tree has
// them. A facet is now no farther from there than the strain of the surface, so that bounds are off by at
// most that, beside the motion of the point since they were taken.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "surface.hpp"

#include <ilaw/search.h>

#include <atomic>
#include <cstdint>
#include <vector>

namespace ilaw::search {

// The closest facet of a point.
struct Pair {
  std::int32_t facet = -1;
  bool is_at_border = false;
  double along = 0.0, beside = 0.0;  // of the way from the facet: along the normal, and the rest
  Projection at{{}, {}, {}, infinity, {}};
};

class Finder {
 public:
  explicit Finder(const ilaw_facets_setup& setup);

  void update(const Positions& positions);
  void find_near(ilaw_facets_nearby& nearby);
  // Adds to looked_at the facets that were looked at.
  const Pair& pair_of(std::size_t point, std::int64_t& looked_at);
  // Facets that come close to the face with these corners, and their number; up to `capacity` are written.
  std::int64_t find_overlaps(const std::int32_t* points, std::uint32_t corner_count, double distance,
                             std::int32_t* facets, std::int64_t capacity) const;
  // How far the rounding of coordinates may put a point beside the facet that it is over.
  double rounding_rim() const;

  std::size_t point_count() const { return nodes_.size(); }
  void add_counts(std::int64_t pairs, std::int64_t facets) {
    pairs_.fetch_add(pairs, std::memory_order_relaxed);
    facets_.fetch_add(facets, std::memory_order_relaxed);
  }
  void read_counts(ilaw_facets_counts& counts) const;

 private:
  // Facets of which one is the closest, in the order of their least distances from a place; all others are
  // farther than `outside` from there.
  struct Known {
    static constexpr std::size_t most = 12;
    Vec at;
    double outside;
    std::int64_t fit = -1;  // of the tree
    std::size_t count;
    std::array<std::int32_t, most> facet;
    std::array<double, most> lower;
  };
  class Gathering;
  // Points that are apart: their least distance, and the least motion of nodes that could turn a facet's back
  // to one of them.
  struct Apart {
    double distance = infinity, turn = infinity;
  };

  double doubt() const;
  void look_around(Known& known, Vec place, std::int64_t& looked_at) const;
  bool try_known(const Known& known, std::size_t point, Pair& best, std::int64_t& looked_at) const;
  void try_all(std::size_t point, Pair& best, std::int64_t& looked_at) const;
  void try_facet(std::int32_t facet, Vec p, Pair& best, std::int64_t& looked_at) const;
  void place_point(Vec p, Pair& pair) const;
  void choose_facing(const Known& known, Vec p, Pair& pair, std::int64_t& looked_at) const;
  // Whether all points of a box are farther than horizon from the surface and in front of it. Lowers least to
  // a bound of their distance.
  bool is_apart(const Box& points, double horizon, Apart& least) const;
  void make_list(double reach);
  void list_near(double horizon, Apart& least);

  Surface surface_;
  std::vector<std::int32_t> nodes_;  // of the points
  std::vector<Vec> now_, seen_;      // their places, in the axes of the surface, too
  Tree groups_;
  std::vector<Box> group_boxes_;
  std::int64_t stamp_ = 0, fit_ = 0;  // of the positions, of the tree

  std::vector<Known> known_;
  std::vector<Pair> pairs_found_;
  std::vector<std::int64_t> stamps_;  // of the positions that they are of

  // The list of near points, and where they were then.
  std::vector<std::int32_t> near_, longer_;
  std::vector<Vec> listed_;
  bool is_listed_ = false;
  double horizon_ = 0.0, turn_ = 0.0, strain_listed_ = 0.0, motion_ = 0.0;

  std::int64_t updates_ = 0, refreshes_ = 0, refits_ = 0;
  std::atomic<std::int64_t> pairs_{0}, facets_{0};
};

}  // namespace ilaw::search
