// model.hpp - what the integrator knows of a body: lumped mass, geometry, internal forces.
// Matrix-free.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/vector.hpp"

#include <array>
#include <limits>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace ilaw::host {

// One value per degree of freedom: dimension consecutive values per node, as a (d,n) array.
using Dofs = Eigen::VectorXd;

// Nodes with a name, which scenes use instead of numbers. Areas are tributary, on the set's own
// surface.
struct NodeSet {
  std::vector<int> nodes;
  std::vector<double> areas;
  std::vector<std::array<int, 4>> facets;  // of a surface in 3D, counter-clockwise seen from outside; the
                                           // last node twice in a triangle
};

// Data that all models have in common, filled by their constructors.
struct Nodes {
  int dimension = 0;
  Dofs mass, position, velocity;  // mass lumped, per degree of freedom, > 0; position of the undeformed body
  std::map<std::string, NodeSet> sets;
  Dofs displacement = Dofs();  // at the start; empty: none
};

// Cells of a model with a mesh, for pictures.
struct Mesh {
  int nodes_per_cell = 0;  // 2: line, 8: hexahedron in VTK's order
  std::vector<int> cells;
  std::vector<int> tetrahedra;  // four nodes each; their numbers follow those of the cells
};

// An element as a bulk viscosity sees it.
struct VolumeElement {
  std::vector<int> nodes;
  Eigen::Matrix3Xd gradients;  // of the shape functions, their mean in the undeformed element; rows beyond
                               // the dimension are 0
  double mass, length, wave_speed;
  double response;  // mass sum_a |gradient_a|^2/m_a, with the masses of its nodes in it alone
};

class ThermalModel;

class Model {
 public:
  explicit Model(Nodes nodes) : nodes_(std::move(nodes)) {
    if (nodes_.displacement.size() == 0) nodes_.displacement = Dofs::Zero(nodes_.mass.size());
  }
  virtual ~Model() = default;
  Model(const Model&) = delete;
  Model& operator=(const Model&) = delete;

  int dimension() const { return nodes_.dimension; }
  int node_count() const { return static_cast<int>(nodes_.mass.size()) / nodes_.dimension; }
  const Dofs& mass() const { return nodes_.mass; }
  const Dofs& position() const { return nodes_.position; }
  // The position of a node, undeformed and displaced.
  Vector position(int node) const { return of_node(position(), node); }
  Vector position(int node, const Dofs& u) const { return of_node(position(), node) + of_node(u, node); }
  const Dofs& initial_velocity() const { return nodes_.velocity; }
  const Dofs& initial_displacement() const { return nodes_.displacement; }
  // Named sets; "all" is always there.
  const std::map<std::string, NodeSet>& sets() const { return nodes_.sets; }
  const Mesh& mesh() const { return mesh_; }
  // Null where no body has a temperature.
  const ThermalModel* thermal() const { return thermal_.get(); }

  // Before anything refers to the model: another set, other displacements at the start, temperatures.
  void add_set(const std::string& name, NodeSet set) { nodes_.sets[name] = std::move(set); }
  void displace(Dofs displacement) { nodes_.displacement = std::move(displacement); }
  void heat(std::shared_ptr<const ThermalModel> thermal) { thermal_ = std::move(thermal); }

  virtual bool has_internal_forces() const { return false; }
  // Adds -f_int(u) to force.
  virtual void add_internal_forces(const Dofs& /*u*/, Dofs& /*force*/) const {}
  // Whether f_int = K u, so that central difference's own energy has the potential part 1/2 u_n^T K
  // u_{n+1}.
  virtual bool is_linear() const { return true; }
  // Energy stored in the deformed body.
  virtual double potential(const Dofs& /*u*/) const { return 0.0; }
  // Cauchy's stress of each cell of the mesh, its mean over the deformed cell; empty without a mesh.
  virtual std::vector<Eigen::Matrix3d> stresses(const Dofs& /*u*/) const { return {}; }
  virtual std::vector<VolumeElement> volume_elements() const { return {}; }
  // A bound from below on the largest stable step of central difference (about the undeformed body
  // where the model is not linear); infinite without internal forces.
  virtual double critical_step() const { return std::numeric_limits<double>::infinity(); }
  // Whether no larger step is stable.
  virtual bool critical_step_is_exact() const { return true; }

 protected:
  Nodes nodes_;
  Mesh mesh_;

 private:
  Vector of_node(const Dofs& dofs, int node) const {
    return dofs.segment(Eigen::Index{node} * dimension(), dimension());
  }

  std::shared_ptr<const ThermalModel> thermal_;
};

}  // namespace ilaw::host
