// SPDX-License-Identifier: BSD-3-Clause
#include "results/fields.hpp"

#include "base/files.hpp"

#include <vtkCellType.h>
#include <vtkDoubleArray.h>
#include <vtkIdList.h>
#include <vtkIntArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkUnstructuredGrid.h>
#include <vtkXMLUnstructuredGridWriter.h>

#include <cstdio>
#include <limits>
#include <regex>
#include <stdexcept>
#include <vector>

namespace ilaw::host {
namespace {

// VTK is 3D: missing components are zero.
void add_vectors(vtkUnstructuredGrid& grid, const char* name, const Dofs& values, int dimension) {
  vtkNew<vtkDoubleArray> array;
  array->SetName(name);
  array->SetNumberOfComponents(3);
  for (Eigen::Index i = 0; i < values.size(); i += dimension) {
    double vector[3] = {0.0, 0.0, 0.0};
    for (int c = 0; c < dimension; ++c) vector[c] = values[i + c];
    array->InsertNextTuple(vector);
  }
  grid.GetPointData()->AddArray(array);
}

vtkDoubleArray* add_array(vtkUnstructuredGrid& grid, const std::string& name, int nodes, int components,
                          double value) {
  vtkNew<vtkDoubleArray> array;
  array->SetName(name.c_str());
  array->SetNumberOfComponents(components);
  array->SetNumberOfTuples(nodes);
  array->Fill(value);
  grid.GetPointData()->AddArray(array);
  return array;  // kept alive by the grid
}

void add_geometry(vtkUnstructuredGrid& grid, const Model& model) {
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  const int d = model.dimension();
  for (Eigen::Index i = 0; i < model.position().size(); i += d) {
    double x[3] = {0.0, 0.0, 0.0};
    for (int c = 0; c < d; ++c) x[c] = model.position()[i + c];
    points->InsertNextPoint(x);
  }
  grid.SetPoints(points);
  const Mesh& mesh = model.mesh();
  vtkNew<vtkIdList> cell;
  const auto add_cell = [&](int type, const int* nodes, int count) {
    cell->Reset();
    for (int k = 0; k < count; ++k) cell->InsertNextId(nodes[k]);
    grid.InsertNextCell(type, cell);
  };
  for (int node = 0; mesh.cells.empty() && node < model.node_count(); ++node) add_cell(VTK_VERTEX, &node, 1);
  for (std::size_t k = 0; k < mesh.cells.size(); k += static_cast<std::size_t>(mesh.nodes_per_cell))
    add_cell(mesh.nodes_per_cell == 8 ? VTK_HEXAHEDRON : VTK_LINE, &mesh.cells[k], mesh.nodes_per_cell);
}

// Where a state variable stands in the state of a node. Histories and what is internal mean nothing
// outside their law.
struct StateArray {
  vtkDoubleArray* array;
  int entry, count;
};

std::vector<StateArray> add_states(vtkUnstructuredGrid& grid, const ilaw_instance_info& info,
                                   const std::string& prefix, int node_count) {
  std::vector<StateArray> states;
  int entry = 0;
  for (std::uint32_t i = 0; i < info.state_variable_count; ++i) {
    const ilaw_state_variable& variable = *info.state_variables[i];
    const bool vector = variable.kind == ILAW_STATE_VECTOR || variable.kind == ILAW_STATE_TANGENTIAL;
    const auto count = static_cast<int>(variable.count);
    const bool is_shown = (variable.flags & ILAW_VARIABLE_INTERNAL) == 0;
    if (is_shown && count > 0 && (vector || variable.kind == ILAW_STATE_SCALAR))
      states.push_back(
          {add_array(grid, prefix + variable.name, node_count, vector ? 3 : 1, 0.0), entry, count});
    entry += count;
  }
  return states;
}

void add_interface(vtkUnstructuredGrid& grid, const Interface& interface, const std::string& prefix,
                   int node_count, const Integrator& integrator) {
  vtkDoubleArray* gap =
      add_array(grid, prefix + "gap", node_count, 1, std::numeric_limits<double>::quiet_NaN());
  vtkNew<vtkIntArray> status;
  status->SetName((prefix + "status").c_str());
  status->SetNumberOfTuples(node_count);
  status->FillValue(-1);
  grid.GetPointData()->AddArray(status);
  const std::vector<StateArray> states = add_states(grid, interface.info(), prefix, node_count);
  for (std::size_t k = 0; k < interface.nodes().size(); ++k) {
    const int node = interface.nodes()[k], node_index = static_cast<int>(k);
    gap->SetValue(node, interface.gap_at(node_index, integrator.displacement(), integrator.time()));
    status->SetValue(node, ILAW_FREE);
    if (states.empty()) continue;
    const std::vector<double> values = interface.state_at(node_index, integrator.displacement());
    for (const StateArray& state : states)
      for (int c = 0; c < state.count; ++c)
        state.array->SetComponent(
            node, c, values[static_cast<std::size_t>(state.entry) + static_cast<std::size_t>(c)]);
  }
  for (const std::int32_t contact_index : interface.active())
    status->SetValue(interface.node_of(contact_index), interface.status(contact_index));
}

// VTK's own writer of files tells nobody of a disk that is full, but for its debug text.
std::string text_of(vtkUnstructuredGrid& grid) {
  vtkObject::GlobalWarningDisplayOff();
  vtkNew<vtkXMLUnstructuredGridWriter> writer;
  writer->WriteToOutputStringOn();
  writer->SetInputData(&grid);
  if (!writer->Write()) throw std::runtime_error("VTK cannot write the fields");
  return writer->GetOutputString();
}

}  // namespace

void Fields::clear() const {
  std::filesystem::remove(folder_ / "fields.vtu.series");
  const std::regex own("fields_[0-9]{6,}\\.vtu(\\.partial)?");
  std::vector<std::filesystem::path> old;
  for (const auto& entry : std::filesystem::directory_iterator(folder_))
    if (std::regex_match(entry.path().filename().string(), own)) old.push_back(entry.path());
  for (const std::filesystem::path& file : old) std::filesystem::remove(file);
}

void Fields::write(const Integrator& integrator) {
  const Model& model = *scene_.model;
  vtkNew<vtkUnstructuredGrid> grid;
  add_geometry(*grid, model);
  add_vectors(*grid, "u", integrator.displacement(), model.dimension());
  add_vectors(*grid, "v", integrator.velocity(), model.dimension());
  add_vectors(*grid, "r", integrator.interface_impulse(), model.dimension());
  for (const auto& interface : scene_.interfaces)
    add_interface(*grid, *interface, scene_.interfaces.size() == 1 ? "" : interface->name() + ".",
                  model.node_count(), integrator);

  char name[40];
  std::snprintf(name, sizeof name, "fields_%06zu.vtu", written_.size());
  AtomicFile file(folder_ / name);
  file.stream() << text_of(*grid);
  const FileMark mark = file.commit();
  written_.push_back(
      {{"name", name}, {"time", integrator.time()}, {"size", mark.size}, {"checksum", mark.checksum}});
  write_series();
}

void Fields::write_series() const {
  nlohmann::json files = nlohmann::json::array();
  for (const nlohmann::json& field : written_)
    files.push_back({{"name", field.at("name")}, {"time", field.at("time")}});
  AtomicFile series(folder_ / "fields.vtu.series");
  series.stream() << nlohmann::json{{"file-series-version", "1.0"}, {"files", files}}.dump(1) << '\n';
  series.commit();
}

}  // namespace ilaw::host
