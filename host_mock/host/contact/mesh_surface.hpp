// mesh_surface.hpp - nodes of one body against the facets of another: meshes need not match.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "contact/counterpart.hpp"

namespace ilaw::host {

// A point is projected on the nearest facet, a bilinear patch of four nodes or a triangle: the contact's
// partners are these nodes, with the shape functions there as weights, so that impulses balance. Which facet
// is the nearest is found among all at a refresh, and among that one's neighbours in between:
// validity is what a point may slide meanwhile.
//
// A point beside the border of the surface is not in contact. There the facet goes on a little: rounding
// would else decide whether the nodes at the edge of a stack are held. It goes on for 1e-3 of an edge for a
// point that comes, and for 0.1 of an edge for one that has touched and gone no farther since, so that what
// falls past is not caught.
class MeshSurface : public Counterpart {
 public:
  MeshSurface(const Model& model, std::vector<int> nodes, const NodeSet& surface);

  ContactPoint contact_point(int node_index, const Dofs& u, double time) const override;
  double gap_bound(int node_index, const Dofs& u, double time) const override;
  void refresh(const Dofs& u) override;
  double validity() const override { return 0.5 * shortest_edge_; }
  bool shares_partners() const override { return true; }
  void note_contact(int node_index, bool touches, const ContactPoint& point) override;
  bool is_held(int node_index) const override { return held_[static_cast<std::size_t>(node_index)] != 0; }
  void save(std::ostream& out) const override;
  void load(std::istream& in) override;

 private:
  using Facet = std::array<int, 4>;
  Eigen::Vector3d place_of(int node, const Dofs& u) const;
  Eigen::Vector3d center(const Facet& facet, const Dofs& u) const;
  double radius(const Facet& facet, const Dofs& u) const;
  void find_neighbours();
  void find_border();

  std::vector<Facet> facets_;
  std::vector<std::array<bool, 4>>
      border_;  // whether an edge of a facet, from corner k to k + 1, is of no other
  std::vector<std::vector<std::size_t>>
      neighbours_;                    // of a facet, and itself, in ascending order: which of two
                                      // equally near ones is taken does not depend on the refresh
  std::vector<std::size_t> nearest_;  // facet, by node_index, at the last refresh
  std::vector<double> bound_;         // of the gap, by node_index, at the last refresh
  std::vector<std::uint8_t> held_;    // by node_index: it touched, and has not left since
  double shortest_edge_;
};

}  // namespace ilaw::host
