// surface.hpp - the facets of a surface: their corners now, and a tree over them in the axes of the surface.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "motion.hpp"
#include "projection.hpp"
#include "tree.hpp"

#include <ilaw/search.h>

#include <array>
#include <cstdint>
#include <vector>

namespace ilaw::search {

// Position of a node.
class Positions {
 public:
  Positions(std::uint32_t dimension, const ilaw_input& position, const ilaw_input& displacement)
      : is_plane_(dimension == 2), position_(position), displacement_(displacement) {}
  Vec operator[](std::int32_t node) const {
    return {at(node, 0), at(node, 1), is_plane_ ? 0.0 : at(node, 2)};
  }

 private:
  static double value(const ilaw_input& input, std::int64_t node, std::int64_t c) {
    const std::int64_t place = node * input.node_stride + c * input.component_stride;
    return input.values ? input.values[place] : static_cast<double>(input.floats[place]);
  }
  double at(std::int64_t node, std::int64_t c) const {
    const double start = value(position_, node, c);
    return displacement_.values || displacement_.floats ? start + value(displacement_, node, c) : start;
  }

  bool is_plane_;
  ilaw_input position_, displacement_;
};

class Surface {
 public:
  Surface(const ilaw_facets_setup& setup, const Positions& start);

  std::size_t facet_count() const { return shapes_.size(); }
  const Axes& axes() const { return axes_; }
  double shortest_edge() const { return shortest_edge_; }
  double mean_edge() const { return mean_edge_; }

  // Takes positions; false: none differs from the last ones.
  bool follow(const Positions& positions);
  // How far nodes went from where they are in the tree, at most; the largest coordinate.
  double strain() const { return strain_; }
  double largest_coordinate() const { return largest_; }
  // Fits the tree to the positions.
  void refit();

  // ---- now ----
  Projection project_on(std::int32_t facet, Vec p) const {
    const Nodes& n = facets_[static_cast<std::size_t>(facet)];
    return project(p, {now_[n[0]], now_[n[1]], now_[n[2]], now_[n[3]]},
                   shapes_[static_cast<std::size_t>(facet)]);
  }
  bool is_at_border(std::int32_t facet, const Projection& projection) const {
    const std::array<bool, 4>& border = border_[static_cast<std::size_t>(facet)];
    for (std::size_t k = 0; k < 4; ++k)
      if (projection.is_at[k] && border[k]) return true;
    return false;
  }

  // ---- as in the tree, in the axes of the surface ----
  const Tree& tree() const { return tree_; }
  const Box& box(std::size_t node) const { return boxes_[node]; }
  const Box& normals(std::size_t node) const { return normals_[node]; }
  // A box along the facet that contains it: center, axes and half sides.
  struct Slab {
    Vec center, u, v, n, half;

    Vec beside(Vec p) const {
      const Vec from = p - center;
      return {std::max(std::fabs(dot(from, u)) - half.x, 0.0),
              std::max(std::fabs(dot(from, v)) - half.y, 0.0),
              std::max(std::fabs(dot(from, n)) - half.z, 0.0)};
    }
  };
  const Slab& slab(std::int32_t facet) const { return slabs_[static_cast<std::size_t>(facet)]; }
  const Box& facet_box(std::int32_t facet) const { return facet_boxes_[static_cast<std::size_t>(facet)]; }

 private:
  using Nodes = std::array<std::uint32_t, 4>;
  void find_border(std::size_t corner_count);
  void measure_edges();
  std::vector<Vec> centers() const;
  Slab slab_of(const Nodes& facet) const;

  bool is_plane_;
  std::vector<std::int32_t> model_nodes_;  // in the arrays of the host
  std::vector<Nodes> facets_;              // nodes, by place in model_nodes_
  std::vector<Shape> shapes_;
  std::vector<std::array<bool, 4>> border_;  // whether an edge, from corner k to k + 1, is of no other facet
  std::vector<Vec> now_, fitted_;
  Axes axes_;
  double shortest_edge_ = infinity, mean_edge_ = 0.0, strain_ = 0.0, largest_ = 0.0;
  Tree tree_;
  std::vector<Box> boxes_, normals_, facet_boxes_;
  std::vector<Slab> slabs_;
};

}  // namespace ilaw::search
