// SPDX-License-Identifier: BSD-3-Clause
#include "results/fields.hpp"

#include "base/files.hpp"
#include "base/words.hpp"
#include "model/elements.hpp"
#include "results/obstacle_shapes.hpp"
#include "results/quantities.hpp"

#include <vtkCellData.h>
#include <vtkCellType.h>
#include <vtkDataSetAttributes.h>
#include <vtkDoubleArray.h>
#include <vtkIdList.h>
#include <vtkIntArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkUnstructuredGrid.h>
#include <vtkXMLUnstructuredGridWriter.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

namespace ilaw::host {
namespace {

constexpr double no_value = std::numeric_limits<double>::quiet_NaN();

// Edge rows write the traction into the array of their interface, at other nodes.
vtkDoubleArray* add_to(vtkDataSetAttributes& arrays, const std::string& name, int components, vtkIdType count,
                       double value) {
  if (auto* known = vtkDoubleArray::SafeDownCast(arrays.GetArray(name.c_str()))) return known;
  vtkNew<vtkDoubleArray> array;
  array->SetName(name.c_str());
  array->SetNumberOfComponents(components);
  array->SetNumberOfTuples(count);
  array->Fill(value);
  arrays.AddArray(array);
  return array;  // kept alive by the grid
}

vtkDoubleArray* add_array(vtkUnstructuredGrid& grid, const std::string& name, int nodes, int components,
                          double value) {
  return add_to(*grid.GetPointData(), name, components, nodes, value);
}

// VTK is 3D: missing components are zero.
void add_vectors(vtkUnstructuredGrid& grid, const char* name, const Dofs& values, int dimension) {
  vtkDoubleArray* array = add_array(grid, name, static_cast<int>(values.size()) / dimension, 3, 0.0);
  for (Eigen::Index i = 0; i < values.size(); ++i)
    array->SetComponent(i / dimension, static_cast<int>(i % dimension), values[i]);
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
  for (int node = 0; mesh.cells.empty() && mesh.tetrahedra.empty() && node < model.node_count(); ++node)
    add_cell(VTK_VERTEX, &node, 1);
  for (std::size_t k = 0; k < mesh.cells.size(); k += static_cast<std::size_t>(mesh.nodes_per_cell))
    add_cell(mesh.nodes_per_cell == 8 ? VTK_HEXAHEDRON : VTK_LINE, &mesh.cells[k], mesh.nodes_per_cell);
  for (std::size_t k = 0; k < mesh.tetrahedra.size(); k += 4) add_cell(VTK_TETRA, &mesh.tetrahedra[k], 4);
}

vtkDoubleArray* add_cell_array(vtkUnstructuredGrid& grid, const char* name, int components) {
  return add_to(*grid.GetCellData(), name, components, grid.GetNumberOfCells(), 0.0);
}

// In ParaView's order of a symmetric tensor.
void add_stresses(vtkUnstructuredGrid& grid, const Model& model, const Dofs& u) {
  const std::vector<Eigen::Matrix3d> stresses = model.stresses(u);
  if (stresses.empty()) return;
  vtkDoubleArray* tensor = add_cell_array(grid, "stress", 6);
  vtkDoubleArray* mises = add_cell_array(grid, "von_mises", 1);
  const char* const names[] = {"XX", "YY", "ZZ", "XY", "YZ", "XZ"};
  for (int c = 0; c < 6; ++c) tensor->SetComponentName(c, names[c]);
  for (std::size_t k = 0; k < stresses.size(); ++k) {
    const Eigen::Matrix3d& s = stresses[k];
    const double values[6] = {s(0, 0), s(1, 1), s(2, 2), s(0, 1), s(1, 2), s(0, 2)};
    tensor->SetTuple(static_cast<vtkIdType>(k), values);
    const Eigen::Matrix3d deviator = s - s.trace() / 3.0 * Eigen::Matrix3d::Identity();
    mises->SetValue(static_cast<vtkIdType>(k), std::sqrt(1.5 * deviator.squaredNorm()));
  }
}

// Force per area on the interface's own nodes in the last step, in the scene's axes.
void add_traction(vtkUnstructuredGrid& grid, const Interface& interface, const std::string& prefix,
                  int node_count, double dt) {
  vtkDoubleArray* traction = add_array(grid, prefix + "traction", node_count, 3, no_value);
  const std::vector<double>& areas = interface.setup().areas;
  for (std::size_t k = 0; k < areas.size(); ++k)
    if (areas[k] > 0.0) traction->SetTuple3(interface.nodes()[k], 0.0, 0.0, 0.0);
  for (const std::int32_t contact_index : interface.active()) {
    const double area = interface.area(contact_index);
    if (!(area > 0.0)) continue;
    const auto impulse = interface.impulse(contact_index);
    for (int c = 0; c < static_cast<int>(impulse.size()); ++c)
      traction->SetComponent(interface.node_of(contact_index), c, impulse[c] / (dt * area));
  }
}

void add_interface(vtkUnstructuredGrid& grid, const Interface& interface, const std::string& prefix,
                   int node_count, const Integrator& integrator) {
  vtkDoubleArray* gap = add_array(grid, prefix + "gap", node_count, 1, no_value);
  vtkNew<vtkIntArray> status;
  status->SetName((prefix + "status").c_str());
  status->SetNumberOfTuples(node_count);
  status->FillValue(-1);
  grid.GetPointData()->AddArray(status);
  const std::vector<ShownState> states = shown_states(interface.info());
  std::vector<vtkDoubleArray*> arrays;
  arrays.reserve(states.size());
  for (const ShownState& state : states)
    arrays.push_back(add_array(grid, prefix + state.name, node_count, state.is_vector ? 3 : 1, no_value));
  interface.setup().counterpart->follow(integrator.displacement());
  for (std::size_t k = 0; k < interface.nodes().size(); ++k) {
    const int node = interface.nodes()[k], node_index = static_cast<int>(k);
    gap->SetValue(node, interface.gap_at(node_index, integrator.displacement(), integrator.time()));
    status->SetValue(node, ILAW_FREE);
    if (states.empty()) continue;
    const std::vector<double> values = interface.state_at(node_index, integrator.displacement());
    for (std::size_t s = 0; s < states.size(); ++s)
      for (int c = 0; c < arrays[s]->GetNumberOfComponents(); ++c) {
        const auto place = static_cast<std::size_t>(c);
        arrays[s]->SetComponent(node, c, place < states[s].count ? values[states[s].entry + place] : 0.0);
      }
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

void Fields::write(const Integrator& integrator) {
  const Model& model = *scene_.model;
  vtkNew<vtkUnstructuredGrid> grid;
  add_body(*grid, integrator);
  add_vectors(*grid, "r", integrator.interface_impulse(), model.dimension());
  const auto is_own = [](const auto& interface) { return interface->setup().edges_of.empty(); };
  const bool is_alone = std::count_if(scene_.interfaces.begin(), scene_.interfaces.end(), is_own) == 1;
  for (const auto& interface : scene_.interfaces) {
    const std::string& name = is_own(interface) ? interface->name() : interface->setup().edges_of;
    const std::string prefix = is_alone ? "" : name + ".";
    if (is_own(interface)) add_interface(*grid, *interface, prefix, model.node_count(), integrator);
    add_traction(*grid, *interface, prefix, model.node_count(), scene_.dt);
  }
  write_next("fields", *grid, integrator.time());
  const bool first = names_of("obstacles").empty();
  if (has_obstacles(scene_) && (first || has_moving_obstacles(scene_))) {
    vtkNew<vtkUnstructuredGrid> obstacles;
    add_obstacles(*obstacles, scene_, integrator.time());
    write_next("obstacles", *obstacles, integrator.time());
  }
  write_series();
}

// Values of interfaces mean nothing after a divergence and are left out.
std::filesystem::path Fields::write_diverged(const Integrator& integrator) const {
  vtkNew<vtkUnstructuredGrid> grid;
  add_body(*grid, integrator);
  if (grid->GetCellData()->GetArray("stress")) {
    vtkDoubleArray* inverted = add_cell_array(*grid, "inverted", 1);
    for (const int element : inverted_elements(*scene_.model, integrator.displacement()))
      inverted->SetValue(element, 1.0);
  }
  std::filesystem::path path = folder_ / "diverged.vtu";
  write_file(path, text_of(*grid));
  return path;
}

void Fields::add_body(vtkUnstructuredGrid& grid, const Integrator& integrator) const {
  const Model& model = *scene_.model;
  add_geometry(grid, model);
  add_vectors(grid, "u", integrator.displacement(), model.dimension());
  add_vectors(grid, "v", integrator.velocity(), model.dimension());
  add_stresses(grid, model, integrator.displacement());
  if (!integrator.temperatures()) return;
  vtkDoubleArray* temperature = add_array(grid, "temperature", model.node_count(), 1, no_value);
  for (int node = 0; node < model.node_count(); ++node)
    if (model.thermal()->has_temperature(node))
      temperature->SetValue(node, integrator.temperatures()->at(node));
}

// Files with a number, and what is in them.
void Fields::write_next(const std::string& kind, vtkUnstructuredGrid& grid, double time) {
  const std::string name = formatted("%s_%06zu.vtu", kind.c_str(), names_of(kind).size());
  const FileMark mark = write_file(folder_ / name, text_of(grid));
  written_.push_back({{"name", name}, {"time", time}, {"size", mark.size}, {"checksum", mark.checksum}});
}

// With their times, as ParaView's series has them.
nlohmann::json Fields::names_of(const std::string& kind) const {
  nlohmann::json files = nlohmann::json::array();
  for (const nlohmann::json& field : written_)
    if (field.at("name").get<std::string>().starts_with(kind + "_"))
      files.push_back({{"name", field.at("name")}, {"time", field.at("time")}});
  return files;
}

void Fields::write_series() const {
  for (const char* kind : {"fields", "obstacles"}) {
    const nlohmann::json files = names_of(kind);
    if (files.empty()) continue;
    const nlohmann::json series = {{"file-series-version", "1.0"}, {"files", files}};
    write_file(folder_ / (std::string(kind) + ".vtu.series"), series.dump(1) + "\n");
  }
}

}  // namespace ilaw::host
