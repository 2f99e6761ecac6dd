// mesh_data.hpp - a mesh as a file has it, and the mistakes that such a file can have.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include <array>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

namespace ilaw::host {

// A mistake in a mesh: where, the value found, and what is allowed.
class MeshError : public std::runtime_error {
 public:
  explicit MeshError(const std::string& what) : std::runtime_error(what) {}
};

// Elements are tetrahedra and hexahedra; the other cells only name sets of nodes and of facets.
enum class CellKind { vertex, line, triangle, quadrangle, tetrahedron, hexahedron };

constexpr int corners_of(CellKind kind) {
  constexpr std::array<int, 6> corners{1, 2, 3, 4, 4, 8};
  return corners[static_cast<std::size_t>(kind)];
}

struct MeshCell {
  CellKind kind;
  std::array<int, 8> nodes;  // in VTK's order
};

// Nodes and cells of one value of an array.
struct MeshGroup {
  std::vector<int> nodes, cells;
};

struct MeshData {
  std::vector<Eigen::Vector3d> nodes;
  std::vector<MeshCell> cells;
  std::map<std::string, MeshGroup> groups;
};

}  // namespace ilaw::host
