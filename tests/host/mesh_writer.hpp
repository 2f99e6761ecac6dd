// mesh_writer.hpp - meshes for tests: boxes of hexahedra or tetrahedra, bent by a function, as .vtu files.
#pragma once

#include "host_runner.hpp"
#include "model/mesh_data.hpp"

#include <Eigen/Core>

#include <functional>
#include <utility>

namespace ilaw::host::testing {

struct WrittenMesh {
  std::vector<Eigen::Vector3d> nodes;
  std::vector<MeshCell> cells;
  std::map<std::string, std::vector<int>> of_nodes, of_cells;  // arrays of integers

  std::string vtu() const;
};

// Types of VTK.
inline int vtk_type(CellKind kind) {
  constexpr std::array<int, 6> types{1, 3, 5, 9, 10, 12};
  return types[static_cast<std::size_t>(kind)];
}

template <class Values>
std::string text_of_array(const std::string& type, const std::string& name, int components,
                          const Values& values) {
  std::ostringstream text;
  text.precision(17);
  text << "<DataArray type=\"" << type << "\" Name=\"" << name << "\" NumberOfComponents=\"" << components
       << "\" format=\"ascii\">\n";
  for (const auto& value : values) text << value << ' ';
  text << "\n</DataArray>\n";
  return text.str();
}

inline std::string WrittenMesh::vtu() const {
  std::vector<double> points;
  for (const Eigen::Vector3d& node : nodes) points.insert(points.end(), node.begin(), node.end());
  std::vector<int> connectivity, offsets, types;
  for (const MeshCell& cell : cells) {
    connectivity.insert(connectivity.end(), cell.nodes.begin(), cell.nodes.begin() + corners_of(cell.kind));
    offsets.push_back(static_cast<int>(connectivity.size()));
    types.push_back(vtk_type(cell.kind));
  }
  const auto arrays = [](const std::string& part, const std::map<std::string, std::vector<int>>& given) {
    std::string text = "<" + part + ">\n";
    for (const auto& [name, values] : given) text += text_of_array("Int32", name, 1, values);
    return text + "</" + part + ">\n";
  };
  return "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\">\n<UnstructuredGrid>\n"
         "<Piece NumberOfPoints=\"" +
         std::to_string(nodes.size()) + "\" NumberOfCells=\"" + std::to_string(cells.size()) +
         "\">\n<Points>\n" + text_of_array("Float64", "Points", 3, points) + "</Points>\n<Cells>\n" +
         text_of_array("Int64", "connectivity", 1, connectivity) +
         text_of_array("Int64", "offsets", 1, offsets) + text_of_array("UInt8", "types", 1, types) +
         "</Cells>\n" + arrays("PointData", of_nodes) + arrays("CellData", of_cells) +
         "</Piece>\n</UnstructuredGrid>\n</VTKFile>\n";
}

using Shape = std::function<Eigen::Vector3d(const Eigen::Vector3d&)>;

// A box from the origin: node (i, j, k) has the number i + (nx+1)(j + (ny+1) k), as in a block. A tetrahedron
// of a cell has the cell's diagonal (Kuhn's six).
inline WrittenMesh box_mesh(
    const std::array<int, 3>& elements, const Eigen::Vector3d& size, bool tetrahedra,
    const Shape& shape = [](const Eigen::Vector3d& x) { return x; }) {
  WrittenMesh mesh;
  const auto [nx, ny, nz] = elements;
  for (int k = 0; k <= nz; ++k)
    for (int j = 0; j <= ny; ++j)
      for (int i = 0; i <= nx; ++i)
        mesh.nodes.push_back(shape({size[0] * i / nx, size[1] * j / ny, size[2] * k / nz}));
  const auto node = [nx = nx, ny = ny](int i, int j, int k) { return i + (nx + 1) * (j + (ny + 1) * k); };
  constexpr int split[6][4] = {{0, 1, 2, 6}, {0, 2, 3, 6}, {0, 3, 7, 6},
                               {0, 7, 4, 6}, {0, 4, 5, 6}, {0, 5, 1, 6}};
  for (int k = 0; k < nz; ++k)
    for (int j = 0; j < ny; ++j)
      for (int i = 0; i < nx; ++i) {
        const std::array<int, 8> corners{
            node(i, j, k),     node(i + 1, j, k),     node(i + 1, j + 1, k),     node(i, j + 1, k),
            node(i, j, k + 1), node(i + 1, j, k + 1), node(i + 1, j + 1, k + 1), node(i, j + 1, k + 1)};
        if (!tetrahedra) {
          mesh.cells.push_back({CellKind::hexahedron, corners});
          continue;
        }
        for (const auto& four : split) {
          MeshCell cell{CellKind::tetrahedron, {}};
          for (std::size_t a = 0; a < 4; ++a) cell.nodes[a] = corners[static_cast<std::size_t>(four[a])];
          // By turns in another order, of the same sense, so that all faces come to lie on the boundary.
          if (mesh.cells.size() % 2 == 1) {
            std::swap(cell.nodes[0], cell.nodes[1]);
            std::swap(cell.nodes[2], cell.nodes[3]);
          }
          mesh.cells.push_back(cell);
        }
      }
  return mesh;
}

// The file stays as long as this does.
class MeshFile {
 public:
  explicit MeshFile(const std::string& text, const std::string& name = "mesh.vtu") : folder_(fresh_folder()) {
    std::ofstream(folder_ / name, std::ios::binary) << text;
    path_ = folder_ / name;
  }
  explicit MeshFile(const WrittenMesh& mesh) : MeshFile(mesh.vtu()) {}
  ~MeshFile() { fs::remove_all(folder_); }
  MeshFile(const MeshFile&) = delete;
  MeshFile& operator=(const MeshFile&) = delete;

  const fs::path& path() const { return path_; }

 private:
  fs::path folder_, path_;
};

}  // namespace ilaw::host::testing
