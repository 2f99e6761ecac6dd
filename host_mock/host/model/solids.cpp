// SPDX-License-Identifier: BSD-3-Clause
#include "model/solids.hpp"

#include <algorithm>
#include <limits>

namespace ilaw::host {
namespace {

// The same set where the nodes of its body begin at first.
NodeSet moved(NodeSet set, int first) {
  for (int& node : set.nodes) node += first;
  for (std::array<int, 4>& facet : set.facets)
    for (int& node : facet) node += first;
  return set;
}

void add_mesh(const MeshSetup& setup, int first, Nodes& nodes) {
  for (std::size_t k = 0; k < setup.mesh.nodes.size(); ++k) {
    const Eigen::Index dof = 3 * (Eigen::Index{first} + static_cast<Eigen::Index>(k));
    nodes.position.segment<3>(dof) = setup.mesh.nodes[k] + setup.offset;
    nodes.velocity.segment<3>(dof) = setup.velocity;
  }
  for (const auto& [name, set] : setup.topology.sets)
    nodes.sets[setup.name + (name.empty() ? "" : "." + name)] = moved(set, first);
  const NodeSet& whole = nodes.sets[setup.name];
  NodeSet& all = nodes.sets["all"];
  all.nodes.insert(all.nodes.end(), whole.nodes.begin(), whole.nodes.end());
  all.areas.insert(all.areas.end(), whole.areas.begin(), whole.areas.end());
}

// The masses of the meshes are added by their elements.
Nodes nodes_of(const std::vector<BlockSetup>& blocks, const std::vector<MeshSetup>& meshes) {
  Nodes nodes{3, {}, {}, {}, {}};
  Eigen::Index size = 0;
  if (!blocks.empty()) {
    const Blocks boxes(blocks);
    nodes = {3, boxes.mass(), boxes.position(), boxes.initial_velocity(), boxes.sets()};
    size = boxes.mass().size();
  }
  Eigen::Index all = size;
  for (const MeshSetup& setup : meshes) all += 3 * static_cast<Eigen::Index>(setup.mesh.nodes.size());
  for (Dofs* dofs : {&nodes.mass, &nodes.position, &nodes.velocity}) {
    dofs->conservativeResize(all);
    dofs->tail(all - size).setZero();
  }
  int first = static_cast<int>(size / 3);
  for (const MeshSetup& setup : meshes) {
    add_mesh(setup, first, nodes);
    first += static_cast<int>(setup.mesh.nodes.size());
  }
  return nodes;
}

}  // namespace

Solids::Solids(const std::vector<BlockSetup>& blocks, const std::vector<MeshSetup>& meshes)
    : Model(nodes_of(blocks, meshes)), critical_step_(std::numeric_limits<double>::infinity()) {
  mesh_.nodes_per_cell = 8;
  int first = 0;
  if (!blocks.empty()) {
    blocks_.emplace(blocks);
    mesh_.cells = blocks_->mesh().cells;
    first = blocks_->node_count();
    critical_step_ = blocks_->critical_step();
  }
  for (const MeshSetup& setup : meshes) {
    const MeshBody& body =
        bodies_.emplace_back(setup.topology, nodes_.position, first, setup.material, setup.element);
    body.add_mass(nodes_.mass);
    steps_.push_back(body.critical_step());
    critical_step_ = std::min(critical_step_, steps_.back());
    first += static_cast<int>(setup.mesh.nodes.size());
  }
  add_cells();
}

void Solids::add_cells() {
  for (const MeshBody& body : bodies_) {
    for (const Hexahedron& element : body.hexahedra())
      mesh_.cells.insert(mesh_.cells.end(), element.nodes.begin(), element.nodes.end());
    for (const Tetrahedron& element : body.tetrahedra())
      mesh_.tetrahedra.insert(mesh_.tetrahedra.end(), element.nodes.begin(), element.nodes.end());
  }
}

bool Solids::is_linear() const {
  return (!blocks_ || blocks_->is_linear()) &&
         std::all_of(bodies_.begin(), bodies_.end(), [](const MeshBody& body) { return body.is_linear(); });
}

void Solids::add_internal_forces(const Dofs& u, Dofs& force) const {
  if (blocks_) blocks_->add_internal_forces(u, force);
  for (const MeshBody& body : bodies_) body.add_internal_forces(u, force);
}

double Solids::potential(const Dofs& u) const {
  double sum = blocks_ ? blocks_->potential(u) : 0.0;
  for (const MeshBody& body : bodies_) sum += body.potential(u);
  return sum;
}

std::vector<Eigen::Matrix3d> Solids::stresses(const Dofs& u) const {
  std::vector<Eigen::Matrix3d> stresses = blocks_ ? blocks_->stresses(u) : std::vector<Eigen::Matrix3d>();
  std::vector<Eigen::Matrix3d> of_tetrahedra;
  for (const MeshBody& body : bodies_) body.add_stresses(u, stresses, of_tetrahedra);
  stresses.insert(stresses.end(), of_tetrahedra.begin(), of_tetrahedra.end());
  return stresses;
}

}  // namespace ilaw::host
