// SPDX-License-Identifier: BSD-3-Clause
#include "model/solids.hpp"

#include <algorithm>

namespace ilaw::host {
namespace {

// The same set where the nodes of its body begin at first.
NodeSet moved(NodeSet set, int first) {
  for (int& node : set.nodes) node += first;
  for (std::array<int, 4>& facet : set.facets)
    for (int& node : facet) node += first;
  return set;
}

void add_nodes(const MeshSetup& setup, int first, Nodes& nodes) {
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

// The masses are added by the elements.
Nodes nodes_of(const std::vector<MeshSetup>& setups) {
  Eigen::Index size = 0;
  for (const MeshSetup& setup : setups) size += 3 * static_cast<Eigen::Index>(setup.mesh.nodes.size());
  Nodes nodes{3, Dofs::Zero(size), Dofs(size), Dofs(size), {}};
  int first = 0;
  for (const MeshSetup& setup : setups) {
    add_nodes(setup, first, nodes);
    first += static_cast<int>(setup.mesh.nodes.size());
  }
  return nodes;
}

}  // namespace

Solids::Solids(const std::vector<MeshSetup>& bodies) : Model(nodes_of(bodies)) {
  mesh_.nodes_per_cell = 8;
  int first = 0;
  for (const MeshSetup& setup : bodies) {
    const MeshBody& body =
        bodies_.emplace_back(setup.topology, nodes_.position, first, setup.material, setup.element);
    body.add_mass(nodes_.mass);
    steps_.push_back(body.critical_step());
    for (const std::array<int, 8>& nodes : body.hexahedra())
      mesh_.cells.insert(mesh_.cells.end(), nodes.begin(), nodes.end());
    for (const Tetrahedron& element : body.tetrahedra())
      mesh_.tetrahedra.insert(mesh_.tetrahedra.end(), element.nodes.begin(), element.nodes.end());
    first += static_cast<int>(setup.mesh.nodes.size());
  }
}

bool Solids::is_linear() const {
  return std::all_of(bodies_.begin(), bodies_.end(), [](const MeshBody& body) { return body.is_linear(); });
}

void Solids::add_internal_forces(const Dofs& u, Dofs& force) const {
  for (const MeshBody& body : bodies_) body.add_internal_forces(u, force);
}

double Solids::potential(const Dofs& u) const {
  double sum = 0.0;
  for (const MeshBody& body : bodies_) body.add_potential(u, sum);
  return sum;
}

std::vector<Eigen::Matrix3d> Solids::stresses(const Dofs& u) const {
  std::vector<Eigen::Matrix3d> stresses, of_tetrahedra;
  for (const MeshBody& body : bodies_) body.add_stresses(u, stresses, of_tetrahedra);
  stresses.insert(stresses.end(), of_tetrahedra.begin(), of_tetrahedra.end());
  return stresses;
}

std::vector<VolumeElement> Solids::volume_elements() const {
  std::vector<VolumeElement> elements;
  for (const MeshBody& body : bodies_) body.add_volume_elements(elements);
  return elements;
}

}  // namespace ilaw::host
