// SPDX-License-Identifier: BSD-3-Clause
#include "model/box.hpp"

#include <algorithm>
#include <numeric>

namespace ilaw::host {
namespace {

// Corners of the unit cube in VTK's order.
constexpr std::array<std::array<int, 3>, 8> corner_of{
    {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}}};

// A structured grid of nodes, x fastest.
struct Grid {
  std::array<int, 3> elements;

  int node(int x, int y, int z) const { return x + (elements[0] + 1) * (y + (elements[1] + 1) * z); }
  int node_count() const { return (elements[0] + 1) * (elements[1] + 1) * (elements[2] + 1); }
};

// A face: its axis, its side, and the two axes in it such that first x second points out of the
// block.
struct Face {
  const char* name;
  int axis, side, first, second;
};
constexpr std::array<Face, 6> box_faces{{{"x_min", 0, 0, 2, 1},
                                         {"x_max", 0, 1, 1, 2},
                                         {"y_min", 1, 0, 0, 2},
                                         {"y_max", 1, 1, 2, 0},
                                         {"z_min", 2, 0, 1, 0},
                                         {"z_max", 2, 1, 0, 1}}};

// Part of an element's extent that belongs to a node of a line of elements: half at the ends.
double share(int position, int elements) { return position == 0 || position == elements ? 0.5 : 1.0; }

NodeSet face_of(const Grid& grid, const Eigen::Vector3d& element_size, const Face& face) {
  NodeSet set;
  std::array<int, 3> at{};
  at[static_cast<std::size_t>(face.axis)] = face.side * grid.elements[static_cast<std::size_t>(face.axis)];
  const auto a = static_cast<std::size_t>(face.first), b = static_cast<std::size_t>(face.second);
  const auto node = [&](int i, int j) {
    at[a] = i;
    at[b] = j;
    return grid.node(at[0], at[1], at[2]);
  };
  const double facet_area = element_size[face.first] * element_size[face.second];
  for (int j = 0; j <= grid.elements[b]; ++j)
    for (int i = 0; i <= grid.elements[a]; ++i) {
      set.nodes.push_back(node(i, j));
      set.areas.push_back(facet_area * share(i, grid.elements[a]) * share(j, grid.elements[b]));
      if (i < grid.elements[a] && j < grid.elements[b])
        set.facets.push_back({node(i, j), node(i + 1, j), node(i + 1, j + 1), node(i, j + 1)});
    }
  return set;
}

// Length of the area vectors of all faces together: what a node offers to whatever it touches where
// no face is named.
std::vector<double> boundary_areas(const Grid& grid, const std::map<std::string, NodeSet>& sets) {
  std::vector<Eigen::Vector3d> vectors(static_cast<std::size_t>(grid.node_count()), Eigen::Vector3d::Zero());
  for (const Face& face : box_faces) {
    const NodeSet& set = sets.at(face.name);
    for (std::size_t k = 0; k < set.nodes.size(); ++k)
      vectors[static_cast<std::size_t>(set.nodes[k])][face.axis] += set.areas[k];
  }
  std::vector<double> areas;
  areas.reserve(vectors.size());
  for (const Eigen::Vector3d& vector : vectors) areas.push_back(vector.norm());
  return areas;
}

// Layer by layer along the longest axis.
void add_elements(const Grid& grid, MeshTopology& topology) {
  const auto axis = static_cast<std::size_t>(std::max_element(grid.elements.begin(), grid.elements.end()) -
                                             grid.elements.begin());
  for (int layer = 0; layer < grid.elements[axis]; ++layer) {
    std::array<int, 3> from{0, 0, 0}, to = grid.elements;
    from[axis] = layer;
    to[axis] = layer + 1;
    for (int z = from[2]; z < to[2]; ++z)
      for (int y = from[1]; y < to[1]; ++y)
        for (int x = from[0]; x < to[0]; ++x) {
          std::array<int, 8>& nodes = topology.hexahedra.emplace_back();
          for (std::size_t a = 0; a < 8; ++a)
            nodes[a] = grid.node(x + corner_of[a][0], y + corner_of[a][1], z + corner_of[a][2]);
        }
  }
  topology.layer = topology.hexahedra.size() / static_cast<std::size_t>(grid.elements[axis]);
}

}  // namespace

MeshSetup box_of(const BoxSetup& setup) {
  MeshSetup box{setup.name, {}, {}, Eigen::Vector3d::Zero(), setup.velocity, setup.material, setup.element};
  const Grid grid{setup.elements};
  const Eigen::Vector3d element_size =
      setup.size.array() / Eigen::Map<const Eigen::Array3i>(setup.elements.data()).cast<double>();
  for (int z = 0; z <= grid.elements[2]; ++z)
    for (int y = 0; y <= grid.elements[1]; ++y)
      for (int x = 0; x <= grid.elements[0]; ++x)
        box.mesh.nodes.emplace_back(setup.corner + Eigen::Vector3d(x, y, z).cwiseProduct(element_size));
  add_elements(grid, box.topology);
  box.topology.element_size = element_size;
  std::map<std::string, NodeSet>& sets = box.topology.sets;
  for (const Face& face : box_faces) sets[face.name] = face_of(grid, element_size, face);
  NodeSet& whole = sets[""];
  whole.areas = boundary_areas(grid, sets);
  whole.nodes.resize(whole.areas.size());
  std::iota(whole.nodes.begin(), whole.nodes.end(), 0);
  return box;
}

}  // namespace ilaw::host
