// SPDX-License-Identifier: BSD-3-Clause
#include "scene/readers.hpp"

#include "base/words.hpp"
#include "model/bars.hpp"
#include "model/box.hpp"
#include "model/model.hpp"
#include "model/points.hpp"
#include "model/springs.hpp"
#include "scene/json_text.hpp"
#include "scene/points_file.hpp"
#include "scene/read_meshes.hpp"
#include "scene/values.hpp"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <set>
#include <string>
#include <vector>

namespace ilaw::host {
namespace {

using nlohmann::json;

std::unique_ptr<Model> read_points(const json& model, const std::filesystem::path& scene_file) {
  const int d = model["dimension"].get<int>();
  if (model["points"].is_string())
    return std::make_unique<Points>(
        d, read_points_file(beside(scene_file, model["points"].get<std::string>()), d, "/model/points"));
  std::vector<PointMass> points;
  for (std::size_t k = 0; k < model["points"].size(); ++k) {
    const json& point = model["points"][k];
    const std::string pointer = at("/model/points", k);
    points.push_back({point["mass"].get<double>(), point.value("area", 1.0),
                      read_vector(point["position"], d, pointer + "/position"),
                      read_vector_or_zero(point, "velocity", d, pointer),
                      point.contains("stiffness") ? read_vector(point["stiffness"], d, pointer + "/stiffness")
                                                  : Vector()});
  }
  return std::make_unique<Points>(d, points);
}

// A point on a spring to the origin.
std::unique_ptr<Model> read_rotating_spring(const json& model) {
  const PointMass point{model["mass"].get<double>(), model.value("area", 1.0),
                        read_vector(model["position"], 2, "/model/position"),
                        read_vector_or_zero(model, "velocity", 2, "/model"), Vector()};
  const Spring spring{
      0, -1, Vector::Zero(2), model["stiffness"].get<double>(), 0.0, model["length"].get<double>()};
  return std::make_unique<Sprung>(std::make_unique<Points>(2, std::vector{point}), std::vector{spring});
}

// Bodies are named in a scene, or as kind and number: bar0, bar1 ... Adds the name to those seen.
std::string name_of(const json& body, const std::string& number, const std::string& pointer,
                    std::set<std::string>& seen) {
  std::string name = body.value("name", number);
  if (name == "all" || !seen.insert(name).second)
    throw mistake(pointer + "/name", "'" + name + "'", "a name of its own for each body, other than 'all'");
  return name;
}

// Least memory of a run: positions, displacements, velocities, masses and impulses, and the
// nodes of the elements.
constexpr double bytes_per_node(int dimension) { return dimension == 1 ? 72.0 : 12.0 * 24.0; }

// Memory of the machine, or the limit of the process where that is less.
double bytes_of_memory() {
  rlimit limit{};
  const double all =
      static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGESIZE));
  if (getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return all;
  return std::min(all, static_cast<double>(limit.rlim_cur));
}

// Before any of it is asked for.
void check_memory(double nodes, int dimension, const std::string& pointer) {
  const double needed = nodes * bytes_per_node(dimension), there = bytes_of_memory();
  if (!(needed > there)) return;
  throw mistake(pointer, formatted("%.4g nodes, which take %.3g GB of memory or more", nodes, needed * 1e-9),
                formatted("at most the %.3g GB that there are", there * 1e-9));
}

// Nodes of all bodies read so far: three degrees of freedom each must fit a 32-bit number.
void check_nodes(double nodes, const json& body, const std::string& pointer) {
  if (!(nodes > 5e8)) return;
  throw mistake(pointer + "/elements",
                body["elements"].dump() + formatted(", which makes %.10g nodes", nodes), "at most 5e8");
}

std::unique_ptr<Model> read_bars(const json& model) {
  std::vector<BarSetup> bars;
  std::set<std::string> names;
  double nodes = 0.0;
  for (std::size_t k = 0; k < model["bars"].size(); ++k) {
    const json& bar = model["bars"][k];
    const std::string pointer = at("/model/bars", k);
    check_nodes(nodes += bar["elements"].get<double>() + 1.0, bar, pointer);
    bars.push_back({name_of(bar, "bar" + std::to_string(k), pointer, names), bar.value("start", 0.0),
                    bar["length"].get<double>(), bar["elements"].get<int>(), bar["young"].get<double>(),
                    bar["density"].get<double>(), bar.value("section", 1.0), bar.value("velocity", 0.0)});
  }
  check_memory(nodes, 1, "/model/bars");
  return std::make_unique<Bars>(bars);
}

Material read_material(const json& material) {
  return {material["type"] == "linear" ? MaterialLaw::linear : MaterialLaw::neo_hookean,
          material["young"].get<double>(), material["poisson"].get<double>(),
          material["density"].get<double>()};
}

Element read_element(const json& body) {
  return body.value("element", "full") == "full" ? Element::full : Element::mean_dilatation;
}

std::vector<MeshSetup> read_boxes(const json& given, std::set<std::string>& names) {
  std::vector<BoxSetup> setups;
  double nodes = 0.0;
  for (std::size_t k = 0; k < given.size(); ++k) {
    const json& block = given[k];
    const std::string pointer = at("/model/blocks", k);
    const auto elements = block["elements"].get<std::array<int, 3>>();
    nodes += (elements[0] + 1.0) * (elements[1] + 1.0) * (elements[2] + 1.0);
    check_nodes(nodes, block, pointer);
    setups.push_back({name_of(block, "block" + std::to_string(k), pointer, names),
                      read_vector_or_zero(block, "corner", 3, pointer),
                      read_vector(block["size"], 3, pointer + "/size"),
                      read_vector_or_zero(block, "velocity", 3, pointer), elements,
                      read_material(block["material"]), read_element(block)});
  }
  check_memory(nodes, 3, "/model/blocks");
  std::vector<MeshSetup> boxes;
  std::transform(setups.begin(), setups.end(), std::back_inserter(boxes), box_of);
  return boxes;
}

// Blocks first, then meshes.
std::unique_ptr<Model> read_solids(const json& model, const std::filesystem::path& scene_file,
                                   json& described) {
  std::set<std::string> names;
  std::vector<MeshSetup> bodies = read_boxes(model.value("blocks", json::array()), names);
  const std::size_t first_mesh = bodies.size();
  const json meshes = model.value("meshes", json::array());
  for (std::size_t k = 0; k < meshes.size(); ++k) {
    const std::string pointer = at("/model/meshes", k);
    const std::string name = name_of(meshes[k], "mesh" + std::to_string(k), pointer, names);
    MeshSetup& setup = bodies.emplace_back(read_mesh(meshes[k], pointer, scene_file));
    setup.name = name;
    setup.material = read_material(meshes[k]["material"]);
    setup.element = read_element(meshes[k]);
  }
  auto solids = std::make_unique<Solids>(bodies);
  for (std::size_t k = 0; k < meshes.size(); ++k)
    described.push_back(
        describe_mesh(meshes[k], bodies[first_mesh + k], solids->critical_step_of(first_mesh + k)));
  return solids;
}

}  // namespace

std::unique_ptr<Model> read_model(const json& model, const std::filesystem::path& scene_file, json& meshes) {
  const std::string type = model["type"].get<std::string>();
  if (type == "points") return read_points(model, scene_file);
  if (type == "rotating_spring") return read_rotating_spring(model);
  return type == "bars" ? read_bars(model) : read_solids(model, scene_file, meshes);
}

}  // namespace ilaw::host
