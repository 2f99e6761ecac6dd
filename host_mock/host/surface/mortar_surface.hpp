// mortar_surface.hpp - facets of one body against facets of another: one constraint for each secondary node,
// with weights that are integrated over the overlap of both faces (facet_overlap.hpp).
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "surface/facet_overlap.hpp"
#include "surface/mesh_surface.hpp"

#include <Eigen/Core>

#include <cstdint>
#include <utility>
#include <vector>

namespace ilaw::host {

// In shortest edges of the main surface, as edge rows have it: what lies deeper behind a facet is in front of
// another side of its body.
inline constexpr double most_depth = 0.5;

// The nodes of the interface are the secondary ones. A row acts along the normal of the main surface,
// averaged by the test function: with a normal of the secondary surface, tilted faces would gain energy.
// Weights are kept until the row has slid by a small part of an edge; the gap and the normal always follow
// the bodies. Nodes without a row meet the closest facet, as in MeshSurface.
class MortarSurface : public MeshSurface {
 public:
  // Facets of own have all their nodes in it.
  MortarSurface(const Model& model, const NodeSet& own, const NodeSet& surface);

  void find_contact(int node_index, const Dofs& u, double time, ContactPoint& found) const override;
  double gap_bound(int node_index, const Dofs& u, double time) const override;
  void follow(const Dofs& u) override;
  bool find_near(const Dofs& u, const Approach& approach) override;
  void pass_by(double travelled) override { travelled_ += travelled; }
  double horizon() const override { return horizon_; }
  bool is_held(int node_index) const override;
  bool has_overlap(int node_index) const override {
    return rows_[static_cast<std::size_t>(node_index)].area > 0.0;
  }
  void expect_bonds(bool store_energy, bool at_once) override {
    bonds_ = true;
    stores_energy_ = store_energy;
    if (at_once) hold_all();
  }
  // After find_near: no facet is that close to another in this step.
  bool is_apart(double reach) const override {
    return is_list_made_ && listed_.empty() && travelled_ + reach < horizon_;
  }
  void save(std::ostream& out) const override;
  void load(std::istream& in) override;

 private:
  // What a secondary facet shares with the main surface.
  struct Patch {
    std::array<std::int32_t, 4> corners;  // node indices
    std::size_t corner_count;
    std::vector<std::int32_t> candidates;  // facets of the main surface that it may meet
    FacetOverlap overlap;
    double motion = 0.0;  // of both surfaces relative to each other, when it was integrated
    bool is_stale = false;
  };
  // A constraint; without area: none.
  struct Row {
    double area = 0.0, own_weight = 1.0;
    std::vector<Partner> partners;                         // their sum is own_weight
    std::size_t own_partners = 0;                          // the first ones, of the secondary surface
    std::vector<std::pair<std::int32_t, double>> normals;  // facets of the main surface, integrals of psi
    Eigen::Vector3d start =
        Eigen::Vector3d::Zero();  // between the places of both sides, when the weights were made
    Eigen::Vector3d apart = start, normal = start;
    bool is_stale = false;
  };

  Eigen::Vector3d place(int node) const { return at_.segment<3>(3 * Eigen::Index{node}); }
  FacetShape corners_of(const Patch& patch) const;
  FacetShape corners_of(std::int32_t main_facet) const;
  double motion() const;
  double find_reach_of_rows();
  struct Found {
    std::vector<std::int32_t>::iterator begin, end;  // in found_
  };
  double clearance() const;
  void find_candidates(double farther);
  void find_near_counts(double depth);
  Found near(std::size_t patch, double rise, double depth);
  double rise_of(std::size_t patch, const Found& found) const;
  void list_pairs(double reach);
  void list_nodes();
  void find_normals();
  void refresh();
  bool has_slid(const Row& row) const;
  void integrate(Patch& patch);
  void assemble(std::size_t node_index);
  void locate(std::size_t node_index);

  std::vector<Patch> patches_;
  std::vector<std::vector<std::int32_t>> patches_of_;  // by node index
  std::vector<Row> rows_;                              // by node index
  std::vector<std::int32_t> face_points_;              // four points for each facet, as the search takes them
  std::vector<std::int64_t> first_;                    // of the candidates of each patch, in found_
  std::vector<std::int32_t> found_;
  std::vector<Polygon> pieces_;                                        // of one facet: scratch
  std::vector<std::pair<std::int32_t, double>> own_sums_, main_sums_;  // of one row: scratch

  // The list of patches that have candidates, and of their nodes. It is new once the surfaces may have moved
  // so far that it is not complete.
  std::vector<std::int32_t> listed_, listed_nodes_;
  std::vector<std::uint8_t> is_listed_;      // by node index
  std::vector<std::int32_t> listed_facets_;  // of the main surface
  std::vector<Eigen::Vector3d> normals_;     // of these, by facet
  std::vector<std::ptrdiff_t> near_counts_;  // of the patches, in found_: scratch
  std::vector<double> rises_;                // the same
  bool is_list_made_ = false, bonds_ = false, stores_energy_ = false;
  Dofs at_, at_list_;                    // positions, now and when the list was made
  double horizon_ = 0.0, widest_ = 0.0;  // of the list; the largest gap of a bond when it was made
  double travelled_ = 0.0;               // a bound of motion() since then
  double past_motion_ = 0.0;             // before the list
};

// Nodes of the main surface, at its border and its sharp edges, against facets of the secondary one. Nodes
// deeper behind it than deepest are not in contact: they are on another side of their body.
class EdgeRows : public MeshSurface {
 public:
  EdgeRows(const Model& model, std::vector<int> nodes, const NodeSet& secondary, double deepest,
           const MortarSurface& faces)
      : MeshSurface(model, std::move(nodes), secondary), deepest_(deepest), faces_(faces) {}

  void find_contact(int node_index, const Dofs& u, double time, ContactPoint& found) const override;

 private:
  // Both surfaces were compared in this step, since edge rows come behind their interface.
  bool is_apart(double reach) const override { return faces_.is_apart(reach); }

  double deepest_;
  const MortarSurface& faces_;
};

}  // namespace ilaw::host
