// SPDX-License-Identifier: BSD-3-Clause
#include "scene/read_meshes.hpp"

#include "base/bytes.hpp"
#include "base/child_process.hpp"
#include "base/words.hpp"

#include <vtkCallbackCommand.h>
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkCellType.h>
#include <vtkDataArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkSmartPointer.h>
#include <vtkUnsignedCharArray.h>
#include <vtkUnstructuredGrid.h>
#include <vtkXMLUnstructuredGridReader.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <exception>
#include <fstream>
#include <map>
#include <new>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

namespace ilaw::host {
namespace {

// An array with more values numbers nodes or cells; it names no sets.
constexpr std::size_t max_sets_per_array = 1000;

// The first error that VTK reports while it reads.
struct ReaderError {
  std::string first;

  static void note(vtkObject* /*caller*/, unsigned long /*event*/, void* self, void* text) {
    std::string& first = static_cast<ReaderError*>(self)->first;
    if (!first.empty() || !text) return;
    first = static_cast<const char*>(text);
    if (const auto colon = first.find("): "); colon != std::string::npos) first.erase(0, colon + 3);
    first.erase(std::find(first.begin(), first.end(), '\n'), first.end());
  }
};

void check_file(const std::filesystem::path& file) {
  std::error_code ignored;
  const auto type = std::filesystem::status(file, ignored).type();
  if (type == std::filesystem::file_type::not_found) throw MeshError("no such file, expected a mesh");
  if (type != std::filesystem::file_type::regular) throw MeshError("found no file, expected a mesh");
  const std::string extension = file.extension();
  if (extension != ".vtu")
    throw MeshError("found the extension '" + extension + "', expected .vtu; `meshio convert mesh" +
                    (extension.empty() ? ".msh" : extension) +
                    " mesh.vtu` writes one (Debian package python3-meshio)");
}

// VTK takes the beginning of a file for a mesh without cells.
void check_end(const std::filesystem::path& file) {
  constexpr std::string_view end = "</VTKFile>";
  std::ifstream stream(file, std::ios::binary | std::ios::ate);
  const std::streamoff size = stream.tellg(), tail = std::min<std::streamoff>(size, 1024);
  std::string text(static_cast<std::size_t>(std::max<std::streamoff>(tail, 0)), ' ');
  stream.seekg(size - tail);
  stream.read(text.data(), tail);
  if (text.rfind(end) == std::string::npos)
    throw MeshError("the file is damaged: it does not end with " + std::string(end) +
                    ", expected a whole mesh");
}

vtkSmartPointer<vtkUnstructuredGrid> read_grid(const std::filesystem::path& file) {
  vtkObject::GlobalWarningDisplayOff();
  vtkNew<vtkXMLUnstructuredGridReader> reader;
  ReaderError error;
  vtkNew<vtkCallbackCommand> observer;
  observer->SetCallback(&ReaderError::note);
  observer->SetClientData(&error);
  reader->AddObserver(vtkCommand::ErrorEvent, observer);
  reader->SetReaderErrorObserver(observer);
  reader->SetParserErrorObserver(observer);
  reader->SetFileName(file.c_str());
  reader->Update();
  if (!error.first.empty() || reader->GetErrorCode() != 0)
    throw MeshError("the file is damaged: " + (error.first.empty() ? "VTK cannot read it" : error.first) +
                    "; expected a whole mesh");
  return reader->GetOutput();
}

void read_nodes(vtkUnstructuredGrid& grid, MeshData& mesh) {
  const vtkIdType count = grid.GetNumberOfPoints();
  constexpr vtkIdType max_nodes = 500'000'000;
  if (count > max_nodes) throw MeshError("found " + std::to_string(count) + " nodes, expected at most 5e8");
  mesh.nodes.resize(static_cast<std::size_t>(count));
  for (vtkIdType node = 0; node < count; ++node) {
    Eigen::Vector3d& x = mesh.nodes[static_cast<std::size_t>(node)];
    grid.GetPoint(node, x.data());
    for (const double coordinate : x)
      if (!std::isfinite(coordinate))
        throw MeshError("node " + std::to_string(node) + ": found the coordinate " +
                        in_digits(coordinate, 10) + ", expected a finite number");
  }
}

CellKind kind_of(int type, vtkIdType cell) {
  static const std::map<int, CellKind> known{
      {VTK_VERTEX, CellKind::vertex},     {VTK_LINE, CellKind::line},
      {VTK_TRIANGLE, CellKind::triangle}, {VTK_QUAD, CellKind::quadrangle},
      {VTK_TETRA, CellKind::tetrahedron}, {VTK_HEXAHEDRON, CellKind::hexahedron}};
  if (const auto found = known.find(type); found != known.end()) return found->second;
  throw MeshError("cell " + std::to_string(cell) + ": found VTK's cell type " + std::to_string(type) +
                  ", expected elements with 4 or 8 nodes (types 10, 12), and vertices, lines, triangles and "
                  "quadrangles (types 1, 3, 5, 9), which name sets");
}

// The bounds of the cells in the list of their nodes, as the file gives them.
struct CellBounds {
  vtkDataArray &offsets, &nodes;

  void check(vtkIdType cells) const {
    bool is_whole = offsets.GetNumberOfTuples() == cells + 1 && offsets.GetComponent(0, 0) == 0.0;
    for (vtkIdType k = 0; is_whole && k < cells; ++k)
      is_whole = offsets.GetComponent(k, 0) <= offsets.GetComponent(k + 1, 0);
    if (!is_whole || offsets.GetComponent(cells, 0) != static_cast<double>(nodes.GetNumberOfTuples()))
      throw MeshError("the file is damaged: cells and their nodes do not fit; expected a whole mesh");
  }
  vtkIdType first(vtkIdType cell) const { return static_cast<vtkIdType>(offsets.GetComponent(cell, 0)); }
};

MeshCell read_cell(const CellBounds& bounds, vtkIdType cell, CellKind kind, std::size_t node_count) {
  MeshCell read{kind, {}};
  const vtkIdType first = bounds.first(cell), count = bounds.first(cell + 1) - first;
  if (count != corners_of(kind))
    throw MeshError("cell " + std::to_string(cell) + ": found " + std::to_string(count) +
                    " nodes, expected " + std::to_string(corners_of(kind)));
  for (vtkIdType k = 0; k < count; ++k) {
    const double node = bounds.nodes.GetComponent(first + k, 0);
    if (!(node >= 0.0 && node < static_cast<double>(node_count)))
      throw MeshError("cell " + std::to_string(cell) + ": found node " + in_digits(node, 10) +
                      ", expected 0 to " + std::to_string(static_cast<std::ptrdiff_t>(node_count) - 1));
    read.nodes[static_cast<std::size_t>(k)] = static_cast<int>(node);
  }
  return read;
}

void read_cells(vtkUnstructuredGrid& grid, MeshData& mesh) {
  vtkCellArray* const cells = grid.GetCells();
  vtkUnsignedCharArray* const types = grid.GetCellTypesArray();
  if (!cells || !types || types->GetNumberOfTuples() == 0)
    throw MeshError("found no cells, expected tetrahedra or hexahedra");
  const vtkIdType count = types->GetNumberOfTuples();
  const CellBounds bounds{*cells->GetOffsetsArray(), *cells->GetConnectivityArray()};
  bounds.check(count);
  mesh.cells.reserve(static_cast<std::size_t>(count));
  for (vtkIdType cell = 0; cell < count; ++cell)
    mesh.cells.push_back(read_cell(bounds, cell, kind_of(types->GetValue(cell), cell), mesh.nodes.size()));
}

// Letters, digits and _ stay.
std::string name_of(const char* array) {
  std::string name = array ? array : "";
  for (char& c : name)
    if (std::isalnum(static_cast<unsigned char>(c)) == 0) c = '_';
  return name;
}

bool is_integer(vtkDataArray& array) {
  const int type = array.GetDataType();
  return type != VTK_FLOAT && type != VTK_DOUBLE;
}

// By value, the entries that have it; nothing where the values are too many to be names.
std::map<double, std::vector<int>> entries_by_value(vtkDataArray& array) {
  std::map<double, std::vector<int>> entries;
  for (vtkIdType k = 0; k < array.GetNumberOfTuples(); ++k) {
    const double value = array.GetComponent(k, 0);
    if (!(value > 0.0)) continue;
    entries[value].push_back(static_cast<int>(k));
    if (entries.size() > max_sets_per_array) return {};
  }
  return entries;
}

// Every value above 0 of an array of integers names a set: `array` where 1 is the only one, else
// `array_value`.
void read_groups(vtkDataSetAttributes& arrays, std::size_t count, std::vector<int> MeshGroup::*part,
                 MeshData& mesh) {
  for (int a = 0; a < arrays.GetNumberOfArrays(); ++a) {
    vtkDataArray* const array = arrays.GetArray(a);
    if (!array || array->GetNumberOfComponents() != 1 || !is_integer(*array)) continue;
    if (array->GetNumberOfTuples() != static_cast<vtkIdType>(count))
      throw MeshError("array '" + name_of(array->GetName()) + "': found " +
                      std::to_string(array->GetNumberOfTuples()) + " values, expected " +
                      std::to_string(count));
    const auto entries = entries_by_value(*array);
    const bool is_flag = entries.size() == 1 && entries.begin()->first == 1.0;
    for (const auto& [value, members] : entries) {
      const std::string name = name_of(array->GetName()) + (is_flag ? "" : "_" + in_digits(value, 10));
      std::vector<int>& set = mesh.groups[name].*part;
      if (!set.empty())
        throw MeshError("found two arrays or values for the set '" + name + "', expected one");
      set = members;
    }
  }
}

MeshData read_by_vtk(const std::filesystem::path& file) {
  const vtkSmartPointer<vtkUnstructuredGrid> grid = read_grid(file);
  MeshData mesh;
  read_nodes(*grid, mesh);
  read_cells(*grid, mesh);
  read_groups(*grid->GetPointData(), mesh.nodes.size(), &MeshGroup::nodes, mesh);
  read_groups(*grid->GetCellData(), mesh.cells.size(), &MeshGroup::cells, mesh);
  return mesh;
}

// ---- from the process that reads to this one ------------------------------------------------------------

void write_mesh(std::ostream& out, const MeshData& mesh) {
  write_value(out, std::uint64_t{mesh.nodes.size()});
  for (const Eigen::Vector3d& node : mesh.nodes) write_array(out, node.data(), 3);
  write_sized(out, mesh.cells);
  for (const auto& [name, group] : mesh.groups) {
    write_sized(out, std::vector<char>(name.begin(), name.end()));
    write_sized(out, group.nodes);
    write_sized(out, group.cells);
  }
}

void check_range(const std::vector<int>& numbers, std::size_t count) {
  for (const int number : numbers)
    if (number < 0 || static_cast<std::size_t>(number) >= count) refuse_damaged();
}

// A crashed reader may leave anything behind: it is not trusted.
MeshData mesh_of(const std::string& bytes) {
  std::istringstream in(bytes);
  MeshData mesh;
  std::uint64_t count = 0;
  read_value(in, count);
  if (count > bytes.size() / sizeof(Eigen::Vector3d)) refuse_damaged();
  mesh.nodes.resize(count);
  for (Eigen::Vector3d& node : mesh.nodes) read_array(in, node.data(), 3);
  mesh.cells = read_sized<MeshCell>(in, bytes.size() / sizeof(MeshCell));
  for (const MeshCell& cell : mesh.cells) {
    if (cell.kind < CellKind::vertex || cell.kind > CellKind::hexahedron) refuse_damaged();
    check_range({cell.nodes.begin(), cell.nodes.begin() + corners_of(cell.kind)}, mesh.nodes.size());
  }
  while (in.peek() != std::istringstream::traits_type::eof()) {
    const std::vector<char> name = read_sized<char>(in, bytes.size());
    MeshGroup& group = mesh.groups[std::string(name.begin(), name.end())];
    group.nodes = read_sized<int>(in, bytes.size());
    group.cells = read_sized<int>(in, bytes.size());
    check_range(group.nodes, mesh.nodes.size());
    check_range(group.cells, mesh.cells.size());
  }
  return mesh;
}

std::string bytes_of(const std::filesystem::path& file) {
  try {
    std::ostringstream out;
    write_mesh(out, read_by_vtk(file));
    return out.str();
  } catch (const MeshError&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw MeshError("the file is damaged or too large: out of memory");
  } catch (const std::exception& error) {
    throw MeshError(std::string("the file is damaged: ") + error.what());
  }
}

}  // namespace

MeshData read_mesh_file(const std::filesystem::path& file) {
  check_file(file);
  check_end(file);
  constexpr unsigned max_seconds = 600;
  constexpr unsigned long long least_bytes = 1ULL << 32, bytes_per_byte = 64;
  std::error_code ignored;
  const auto size = std::filesystem::file_size(file, ignored);
  try {
    return mesh_of(result_in_process([&] { return bytes_of(file); }, max_seconds,
                                     least_bytes + (ignored ? 0 : bytes_per_byte * size)));
  } catch (const ProcessEnded& ended) {
    throw MeshError(std::string("the file is damaged: VTK's reader ") + ended.what() +
                    "; expected a whole mesh");
  } catch (const std::runtime_error& error) {
    throw MeshError(error.what());
  }
}

}  // namespace ilaw::host
