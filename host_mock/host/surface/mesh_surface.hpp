// mesh_surface.hpp - nodes of one body against the facets of another: meshes need not match.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "surface/counterpart.hpp"

#include <ilaw/search.h>

#include <memory>
#include <vector>

namespace ilaw::host {

// Throws where a call of ilaw/search.h was refused.
void check_search(ilaw_result code);

// A point is projected on the closest facet (ilaw/search.h), a bilinear patch of four nodes or a triangle:
// the contact's partners are these nodes, with the shape functions there as weights, so that impulses
// balance.
//
// A point beside the border of the surface is not in contact. There the facet goes on a little: rounding
// would else decide whether the nodes at the edge of a stack are held. It goes on for 1e-3 of an edge for a
// point that comes, and for 0.1 of an edge for one that has touched and gone no farther since, so that what
// falls past is not caught.
class MeshSurface : public Counterpart {
 public:
  MeshSurface(const Model& model, std::vector<int> nodes, const NodeSet& surface);

  void find_contact(int node_index, const Dofs& u, double time, ContactPoint& found) const override;
  double gap_bound(int node_index, const Dofs& u, double time) const override;
  void follow(const Dofs& u) override;
  bool finds_near() const override { return true; }
  bool find_near(const Dofs& u, const Approach& approach) override;
  double horizon() const override { return nearby_.horizon; }
  bool shares_partners() const override { return true; }
  void note_contact(int node_index, bool touches, const ContactPoint& point) override;
  bool is_held(int node_index) const override { return held_[static_cast<std::size_t>(node_index)] != 0; }
  void save(std::ostream& out) const override;
  void load(std::istream& in) override;

 protected:
  using Facet = std::array<int, 4>;
  const std::vector<Facet>& facets() const { return facets_; }
  ilaw_facets* search() const { return search_.get(); }
  double shortest_edge() const { return shortest_edge_; }
  void hold_all() { held_.assign(held_.size(), std::uint8_t{1}); }

 private:
  // Whether no node can be in reach in this step, as others know.
  virtual bool is_apart(double /*reach*/) const { return false; }

  struct Destroy {
    void operator()(ilaw_facets* search) const { ilaw_facets_destroy(search); }
  };
  void find_pair(int node_index, ilaw_facets_pairs_of asked) const;

  std::vector<Facet> facets_;
  std::unique_ptr<ilaw_facets, Destroy> search_;
  ilaw_facets_nearby nearby_{};
  double travelled_ = 0.0;               // since the search took displacements
  std::vector<std::uint8_t> is_listed_;  // by node_index: in the last list of near points
  std::vector<std::uint8_t> held_;       // by node_index: it touched, and has not left since
  double shortest_edge_ = 0.0;
};

}  // namespace ilaw::host
