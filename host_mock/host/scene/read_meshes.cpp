// SPDX-License-Identifier: BSD-3-Clause
#include "scene/read_meshes.hpp"

#include "base/files.hpp"
#include "base/words.hpp"
#include "scene/json_text.hpp"
#include "scene/values.hpp"

#include <array>
#include <fstream>
#include <numeric>

namespace ilaw::host {
namespace {

using nlohmann::json;

FileMark mark_of(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  FileMark mark;
  std::array<char, 1 << 16> part{};
  while (stream.read(part.data(), part.size()) || stream.gcount() > 0)
    mark.add(part.data(), static_cast<std::size_t>(stream.gcount()));
  return mark;
}

json describe_sets(const MeshTopology& topology) {
  json sets = json::object();
  for (const auto& [name, set] : topology.sets)
    if (!name.empty())
      sets[name] = {{"nodes", set.nodes.size()},
                    {"facets", set.facets.size()},
                    {"area", std::accumulate(set.areas.begin(), set.areas.end(), 0.0)}};
  return sets;
}

}  // namespace

MeshSetup read_mesh(const json& mesh, const std::string& pointer, const std::filesystem::path& scene_file) {
  MeshSetup setup;
  try {
    setup.mesh = read_mesh_file(beside(scene_file, mesh["file"].get<std::string>()));
    setup.topology = topology_of(setup.mesh);
  } catch (const MeshError& error) {
    throw SceneError(pointer + "/file", mesh["file"].get<std::string>() + ": " + error.what());
  }
  setup.offset = read_vector_or_zero(mesh, "offset", 3, pointer);
  setup.velocity = read_vector_or_zero(mesh, "velocity", 3, pointer);
  return setup;
}

json describe_mesh(const json& mesh, const MeshSetup& setup, double critical_step) {
  const MeshTopology& topology = setup.topology;
  return {{"name", setup.name},
          {"file", mesh["file"]},
          {"nodes", setup.mesh.nodes.size()},
          {"hexahedra", topology.hexahedra.size()},
          {"tetrahedra", topology.tetrahedra.size()},
          {"parts", topology.parts},
          {"critical_step", critical_step},
          {"worst_element", {{"cell", topology.worst_cell}, {"scaled_jacobian", topology.worst_quality}}},
          {"sets", describe_sets(topology)}};
}

std::string line_of_mesh(const json& mesh) {
  const auto count = [&](const char* key) { return mesh[key].dump() + " " + key; };
  std::string line =
      mesh["name"].get<std::string>() + " from " + mesh["file"].get<std::string>() + ": " + count("nodes");
  for (const char* kind : {"hexahedra", "tetrahedra"})
    if (mesh[kind].get<std::size_t>() > 0) line += ", " + count(kind);
  if (mesh["parts"].get<int>() > 1) line += " in " + count("parts") + " that share no node";
  line += "; critical step " + in_digits(mesh["critical_step"].get<double>(), 4) + "; worst element: cell " +
          mesh["worst_element"]["cell"].dump() + ", scaled Jacobian " +
          in_digits(mesh["worst_element"]["scaled_jacobian"].get<double>(), 4) + "; sets (facets):";
  for (const auto& [name, set] : mesh["sets"].items()) line += " " + name + " (" + set["facets"].dump() + ")";
  return line;
}

json marks_of_files(const json& model, const std::filesystem::path& scene_file) {
  json marks = json::array();
  const auto add = [&](const json& file) {
    const FileMark mark = mark_of(beside(scene_file, file.get<std::string>()));
    marks.push_back({{"size", mark.size}, {"checksum", mark.checksum}});
  };
  for (const json& mesh : model.value("meshes", json::array())) add(mesh["file"]);
  if (const json points = model.value("points", json()); points.is_string()) add(points);
  return marks;
}

}  // namespace ilaw::host
