// mesh_topology.hpp - the elements of a mesh, its boundary, and its sets; refuses meshes that no body can
// have.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "model/mesh_data.hpp"
#include "model/model.hpp"

#include <array>
#include <map>
#include <string>
#include <vector>

namespace ilaw::host {

struct MeshTopology {
  std::vector<std::array<int, 8>> hexahedra;
  std::vector<std::array<int, 4>> tetrahedra;
  // For a box alone: the size of its hexahedra, all alike, and how many of them lie in a layer; two layers
  // share no node unless they are neighbours.
  Eigen::Vector3d element_size = Eigen::Vector3d::Zero();
  std::size_t layer = 0;
  // By name: "" (all nodes), "boundary", the sides of the bounding box ("x_min", ...) where facets lie in
  // them, and the groups of the file. A facet with three nodes has the last one twice.
  std::map<std::string, NodeSet> sets;
  int parts = 0;  // that share no node
  // Scaled Jacobian: the least, over the corners of an element, of the triple product of the unit vectors
  // along its edges; 1 for a box, for a regular tetrahedron by the factor sqrt(2).
  double worst_quality = 0.0;
  int worst_cell = -1;  // number in the file
};

// Throws MeshError.
MeshTopology topology_of(const MeshData& mesh);

}  // namespace ilaw::host
