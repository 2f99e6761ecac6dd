// SPDX-License-Identifier: BSD-3-Clause
#include "model/mesh_topology.hpp"

#include "base/words.hpp"
#include "model/elements.hpp"
#include "model/pressure.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <limits>
#include <numeric>
#include <set>
#include <span>

namespace ilaw::host {
namespace {

// A flat element has less, by rounding.
constexpr double min_quality = 1e-6;

bool is_flat(CellKind kind) { return kind == CellKind::triangle || kind == CellKind::quadrangle; }
bool is_element(CellKind kind) { return kind == CellKind::tetrahedron || kind == CellKind::hexahedron; }

// FaceList in VTK's order of corners, counter-clockwise seen from outside. A triangle has its last corner
// twice.
using LocalFace = std::array<std::size_t, 4>;
constexpr std::array<LocalFace, 6> hexahedron_faces{
    {{0, 4, 7, 3}, {1, 2, 6, 5}, {0, 1, 5, 4}, {3, 7, 6, 2}, {0, 3, 2, 1}, {4, 5, 6, 7}}};
constexpr std::array<LocalFace, 4> tetrahedron_faces{
    {{0, 1, 3, 3}, {1, 2, 3, 3}, {2, 0, 3, 3}, {0, 2, 1, 1}}};

using Facet = std::array<int, 4>;

// The same for a face and a cell with these nodes, in whatever order.
Facet key_of(Facet nodes) {
  std::sort(nodes.begin(), nodes.end());
  if (const auto last = std::unique(nodes.begin(), nodes.end()); last != nodes.end())
    std::fill(last, nodes.end(), -1);
  return nodes;
}

struct ElementFace {
  Facet key, nodes;
  std::size_t cell;
};

void add_faces(const MeshCell& cell, std::size_t number, std::vector<ElementFace>& all_faces) {
  const bool is_box = cell.kind == CellKind::hexahedron;
  for (const LocalFace& corners : is_box ? std::span<const LocalFace>(hexahedron_faces) : tetrahedron_faces) {
    Facet nodes;
    for (std::size_t k = 0; k < 4; ++k) nodes[k] = cell.nodes[corners[k]];
    all_faces.push_back({key_of(nodes), nodes, number});
  }
}

// All all_faces of all elements, those with the same nodes side by side.
class FaceList {
 public:
  explicit FaceList(const MeshData& mesh) {
    for (std::size_t cell = 0; cell < mesh.cells.size(); ++cell)
      if (is_element(mesh.cells[cell].kind)) add_faces(mesh.cells[cell], cell, faces_);
    std::ranges::stable_sort(faces_, {}, &ElementFace::key);
    for (std::size_t k = 0; k < faces_.size();) {
      const std::size_t first = k;
      while (k < faces_.size() && faces_[k].key == faces_[first].key) ++k;
      if (k - first == 1) boundary_.push_back(faces_[first]);
      if (k - first > 2)
        throw MeshError("cells " + std::to_string(faces_[first].cell) + ", " +
                        std::to_string(faces_[first + 1].cell) + " and " +
                        std::to_string(faces_[first + 2].cell) +
                        ": found one face in all of them, expected a face in at most two elements");
    }
    std::ranges::stable_sort(boundary_, {}, &ElementFace::cell);
  }
  // In the order of the elements.
  const std::vector<ElementFace>& boundary() const { return boundary_; }
  bool has(const Facet& key) const { return std::ranges::binary_search(faces_, key, {}, &ElementFace::key); }

 private:
  std::vector<ElementFace> faces_, boundary_;
};

Facet facet_of(const MeshCell& cell) {
  Facet nodes{cell.nodes[0], cell.nodes[1], cell.nodes[2], cell.nodes[3]};
  if (cell.kind == CellKind::triangle) nodes[3] = nodes[2];
  return nodes;
}

// By node: the area that its facets have, and the length of their area vectors together.
struct BoundaryAreas {
  std::vector<double> areas;
  std::vector<Eigen::Vector3d> vectors;

  BoundaryAreas(const MeshData& mesh, const std::vector<Facet>& facets)
      : areas(mesh.nodes.size(), 0.0), vectors(mesh.nodes.size(), Eigen::Vector3d::Zero()) {
    for (const Facet& facet : facets) {
      FacetCorners x;
      for (std::size_t k = 0; k < 4; ++k)
        x.col(static_cast<Eigen::Index>(k)) = mesh.nodes[static_cast<std::size_t>(facet[k])];
      const FacetCorners parts = facet_area_vectors(x);
      for (std::size_t k = 0; k < 4; ++k) {
        const auto node = static_cast<std::size_t>(facet[k]);
        areas[node] += parts.col(static_cast<Eigen::Index>(k)).norm();
        vectors[node] += parts.col(static_cast<Eigen::Index>(k));
      }
    }
  }
};

NodeSet named_set(const std::set<int>& nodes, std::vector<Facet> facets, const MeshData& mesh) {
  NodeSet set;
  const BoundaryAreas areas(mesh, facets);
  set.facets = std::move(facets);
  for (const int node : nodes) {
    set.nodes.push_back(node);
    set.areas.push_back(areas.areas[static_cast<std::size_t>(node)]);
  }
  return set;
}

NodeSet surface_of(std::vector<Facet> facets, const MeshData& mesh) {
  std::set<int> nodes;
  for (const Facet& facet : facets) nodes.insert(facet.begin(), facet.end());
  return named_set(nodes, std::move(facets), mesh);
}

// A point of the group brings itself, a triangle or quadrangle its facet, an element its facets on the
// boundary. Facets whose nodes are all in the group come with them where the group has no cells.
NodeSet named_set(const MeshGroup& group, const MeshData& mesh, const FaceList& all_faces) {
  std::set<int> nodes(group.nodes.begin(), group.nodes.end());
  std::set<std::size_t> elements;
  std::set<Facet> keys;  // of flat cells
  for (const int number : group.cells) {
    const MeshCell& cell = mesh.cells[static_cast<std::size_t>(number)];
    nodes.insert(cell.nodes.begin(), cell.nodes.begin() + corners_of(cell.kind));
    if (is_element(cell.kind)) elements.insert(static_cast<std::size_t>(number));
    if (is_flat(cell.kind)) keys.insert(key_of(facet_of(cell)));
  }
  const auto has_all_nodes = [&](const ElementFace& face) {
    return std::all_of(face.nodes.begin(), face.nodes.end(), [&](int node) { return nodes.contains(node); });
  };
  std::vector<Facet> facets;
  for (const ElementFace& face : all_faces.boundary())
    if (elements.contains(face.cell) || keys.contains(face.key) ||
        (group.cells.empty() && has_all_nodes(face)))
      facets.push_back(face.nodes);
  return named_set(nodes, std::move(facets), mesh);
}

// The facets that lie in a side of the bounding box.
void add_sides(const MeshData& mesh, const std::vector<Facet>& facets, std::map<std::string, NodeSet>& sets) {
  const Eigen::Map<const Eigen::Matrix3Xd> x(mesh.nodes[0].data(), 3,
                                             static_cast<Eigen::Index>(mesh.nodes.size()));
  const Eigen::Vector3d low = x.rowwise().minCoeff(), high = x.rowwise().maxCoeff();
  const double tolerance = 1e-9 * (high - low).norm();
  for (int axis = 0; axis < 3; ++axis)
    for (const bool is_max : {false, true}) {
      const double at = is_max ? high[axis] : low[axis];
      std::vector<Facet> side;
      std::copy_if(facets.begin(), facets.end(), std::back_inserter(side), [&](const Facet& facet) {
        return std::all_of(facet.begin(), facet.end(),
                           [&](int node) { return std::abs(x(axis, node) - at) <= tolerance; });
      });
      const std::string name = std::string(1, "xyz"[axis]) + (is_max ? "_max" : "_min");
      if (!side.empty()) sets[name] = surface_of(std::move(side), mesh);
    }
}

void add_sets(const MeshData& mesh, const FaceList& all_faces, MeshTopology& topology) {
  std::vector<Facet> facets;
  for (const ElementFace& face : all_faces.boundary()) facets.push_back(face.nodes);
  NodeSet& whole = topology.sets[""];
  for (const Eigen::Vector3d& vector : BoundaryAreas(mesh, facets).vectors) {
    whole.nodes.push_back(static_cast<int>(whole.nodes.size()));
    whole.areas.push_back(vector.norm());
  }
  add_sides(mesh, facets, topology.sets);
  topology.sets["boundary"] = surface_of(std::move(facets), mesh);
  for (const auto& [name, group] : mesh.groups)
    if (!topology.sets.emplace(name, named_set(group, mesh, all_faces)).second)
      throw MeshError("array '" + name + "': found the name of a set that every mesh has, expected another");
}

void check_nodes_used(const MeshData& mesh) {
  std::vector<bool> used(mesh.nodes.size());
  for (const MeshCell& cell : mesh.cells)
    for (int k = 0; is_element(cell.kind) && k < corners_of(cell.kind); ++k)
      used[static_cast<std::size_t>(cell.nodes[static_cast<std::size_t>(k)])] = true;
  const auto unused = std::find(used.begin(), used.end(), false);
  if (unused != used.end())
    throw MeshError("node " + std::to_string(unused - used.begin()) +
                    ": found in no element, expected every node in one (meshio's remove_orphaned_nodes() "
                    "drops the others)");
}

void check_flat_cells(const MeshData& mesh, const FaceList& all_faces) {
  for (std::size_t k = 0; k < mesh.cells.size(); ++k) {
    const MeshCell& cell = mesh.cells[k];
    if (!is_flat(cell.kind)) continue;
    if (!all_faces.has(key_of(facet_of(cell))))
      throw MeshError("cell " + std::to_string(k) + ": found a " +
                      (cell.kind == CellKind::triangle ? "triangle" : "quadrangle") +
                      " that is a face of no element, expected one");
  }
}

// Elements, and how good they are.
void add_elements(const MeshData& mesh, MeshTopology& topology) {
  topology.worst_quality = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < mesh.cells.size(); ++k) {
    const MeshCell& cell = mesh.cells[k];
    if (!is_element(cell.kind)) continue;
    std::array<Eigen::Vector3d, 8> x;
    for (std::size_t c = 0; c < 8; ++c) x[c] = mesh.nodes[static_cast<std::size_t>(cell.nodes[c])];
    const CornerQuality worst = worst_corner(x.data(), corners_of(cell.kind));
    if (!(worst.scaled_jacobian > min_quality))
      throw MeshError("cell " + std::to_string(k) + ": found the scaled Jacobian " +
                      in_digits(worst.scaled_jacobian, 4) + " at its corner " + std::to_string(worst.corner) +
                      ", expected above " + in_digits(min_quality, 4) +
                      ": the element is inverted, flat, or has its nodes in another order than VTK");
    if (worst.scaled_jacobian < topology.worst_quality) {
      topology.worst_quality = worst.scaled_jacobian;
      topology.worst_cell = static_cast<int>(k);
    }
    if (cell.kind == CellKind::hexahedron)
      topology.hexahedra.push_back(cell.nodes);
    else
      topology.tetrahedra.push_back({cell.nodes[0], cell.nodes[1], cell.nodes[2], cell.nodes[3]});
  }
  if (topology.worst_cell < 0) throw MeshError("found no elements, expected tetrahedra or hexahedra");
}

// By merging the nodes of each element.
int count_parts(const MeshData& mesh) {
  std::vector<int> root(mesh.nodes.size());
  std::iota(root.begin(), root.end(), 0);
  const auto find = [&](int node) {
    while (root[static_cast<std::size_t>(node)] != node) {
      int& up = root[static_cast<std::size_t>(node)];
      up = root[static_cast<std::size_t>(up)];
      node = up;
    }
    return node;
  };
  int parts = static_cast<int>(mesh.nodes.size());
  for (const MeshCell& cell : mesh.cells)
    for (int k = 1; is_element(cell.kind) && k < corners_of(cell.kind); ++k) {
      const int a = find(cell.nodes[0]), b = find(cell.nodes[static_cast<std::size_t>(k)]);
      if (a == b) continue;
      root[static_cast<std::size_t>(a)] = b;
      --parts;
    }
  return parts;
}

}  // namespace

MeshTopology topology_of(const MeshData& mesh) {
  MeshTopology topology;
  add_elements(mesh, topology);
  check_nodes_used(mesh);
  const FaceList all_faces(mesh);
  check_flat_cells(mesh, all_faces);
  add_sets(mesh, all_faces, topology);
  topology.parts = count_parts(mesh);
  return topology;
}

}  // namespace ilaw::host
