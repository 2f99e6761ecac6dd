// SPDX-License-Identifier: BSD-3-Clause
#include "scene.hpp"

#include "points.hpp"
#include "validation.hpp"

#include <cmath>
#include <fstream>
#include <numeric>
#include <set>
#include <sstream>
#include <utility>

namespace ilaw::host {
namespace {

using nlohmann::json;

std::string at(const std::string& pointer, std::size_t index) {
  return pointer + "/" + std::to_string(index);
}

Eigen::VectorXd read_vector(const json& value, int dimension, const std::string& pointer) {
  if (static_cast<int>(value.size()) != dimension)
    throw SceneError(pointer, "found " + std::to_string(value.size()) + " components, expected " +
                                  std::to_string(dimension) + ", the dimension of the model");
  Eigen::VectorXd vector(dimension);
  for (int i = 0; i < dimension; ++i) vector[i] = value[static_cast<std::size_t>(i)].get<double>();
  return vector;
}

Eigen::VectorXd read_vector_or_zero(const json& object, const char* key, int dimension,
                                    const std::string& pointer) {
  if (!object.contains(key)) return Eigen::VectorXd::Zero(dimension);
  return read_vector(object[key], dimension, pointer + "/" + key);
}

// Rows of a table: time first, then width values.
Table read_table(const json& rows, int width, const std::string& pointer) {
  std::vector<double> times;
  std::vector<Eigen::VectorXd> values;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    if (static_cast<int>(rows[k].size()) != width + 1)
      throw SceneError(at(pointer, k), "found " + std::to_string(rows[k].size()) + " numbers, expected " +
                                           std::to_string(width + 1) + " (time and values)");
    const double time = rows[k][0].get<double>();
    if (!times.empty() && time <= times.back())
      throw SceneError(at(pointer, k),
                       "found time " + rows[k][0].dump() + ", expected one after " + rows[k - 1][0].dump());
    times.push_back(time);
    Eigen::VectorXd value(width);
    for (int i = 0; i < width; ++i) value[i] = rows[k][static_cast<std::size_t>(i) + 1].get<double>();
    values.push_back(value);
  }
  return {times, values};
}

void check_node(int node, int node_count, const std::string& pointer) {
  if (node >= node_count)
    throw SceneError(
        pointer, "found node " + std::to_string(node) + ", expected 0 to " + std::to_string(node_count - 1));
}

std::vector<int> read_nodes(const json& nodes, int node_count, const std::string& pointer) {
  std::vector<int> list;
  if (nodes.is_string()) {
    list.resize(static_cast<std::size_t>(node_count));
    std::iota(list.begin(), list.end(), 0);
    return list;
  }
  std::set<int> seen;
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    list.push_back(nodes[k].get<int>());
    check_node(list.back(), node_count, at(pointer, k));
    if (!seen.insert(list.back()).second)
      throw SceneError(at(pointer, k), "found node " + nodes[k].dump() + " twice, expected each node once");
  }
  return list;
}

std::unique_ptr<Model> read_points(const json& model) {
  const int d = model["dimension"].get<int>();
  const json& points = model["points"];
  const auto count = static_cast<Eigen::Index>(points.size());
  Eigen::VectorXd mass(count), area(count);
  Dofs position(count * d), velocity(count * d);
  for (std::size_t k = 0; k < points.size(); ++k) {
    const std::string pointer = at("/model/points", k);
    const auto i = static_cast<Eigen::Index>(k);
    mass[i] = points[k]["mass"].get<double>();
    area[i] = points[k].value("area", 1.0);
    position.segment(i * d, d) = read_vector(points[k]["position"], d, pointer + "/position");
    velocity.segment(i * d, d) = read_vector_or_zero(points[k], "velocity", d, pointer);
  }
  return std::make_unique<Points>(d, mass, position, velocity, area);
}

std::unique_ptr<Load> read_load(const json& load, const Model& model, const std::string& pointer) {
  const int d = model.dimension();
  const std::string type = load["type"].get<std::string>();
  const std::vector<int> nodes = read_nodes(load.contains("nodes") ? load["nodes"] : json("all"),
                                            model.node_count(), pointer + "/nodes");
  if (type == "gravity")
    return std::make_unique<Gravity>(model, nodes,
                                     read_vector(load["acceleration"], d, pointer + "/acceleration"));
  if (type == "force")
    return std::make_unique<Force>(nodes, read_vector(load["direction"], d, pointer + "/direction"),
                                   read_table(load["history"], 1, pointer + "/history"));
  const double time = load["time"].get<double>();
  if (time <= 0.0)
    throw SceneError(pointer + "/time", "found " + load["time"].dump() + ", expected a time > 0");
  return std::make_unique<Shock>(nodes, time, read_vector(load["impulse"], d, pointer + "/impulse"));
}

std::shared_ptr<const Obstacle> read_obstacle(const json& obstacle, int d, const std::string& pointer) {
  const Eigen::VectorXd normal = read_vector(obstacle["normal"], d, pointer + "/normal");
  if (normal.norm() == 0.0)
    throw SceneError(pointer + "/normal", "found a vector of length 0, expected a direction");
  if (obstacle.contains("velocity") && obstacle.contains("path"))
    throw SceneError(pointer, "found both 'velocity' and 'path', expected at most one of them");
  const Motion motion = obstacle.contains("path")
                            ? Motion(read_table(obstacle["path"], d, pointer + "/path"))
                            : Motion(read_vector_or_zero(obstacle, "velocity", d, pointer));
  return std::make_shared<Plane>(read_vector(obstacle["point"], d, pointer + "/point"), normal, motion);
}

// JSON has no infinity: "inf" stands for it.
bool is_infinity(const json& value) { return value.is_string() && value.get<std::string>() == "inf"; }

double read_number(const json& value, const std::string& pointer) {
  if (is_infinity(value)) return INFINITY;
  if (!value.is_number())
    throw SceneError(pointer, "found " + value.dump() + ", expected a number or \"inf\"");
  return value.get<double>();
}

void read_varying(const json& value, const std::string& name, std::size_t node_count, Arguments& arguments,
                  const std::string& pointer) {
  if (value.size() != 1 || !(value.contains("table") || value.contains("per_node")))
    throw SceneError(pointer, "found " + value.dump() + ", expected a number, \"inf\", a choice, " +
                                  "{\"table\": [[time, value], ...]} or {\"per_node\": [value, ...]}");
  const std::string key = value.begin().key();
  const json& rows = value[key];
  const std::string where = pointer + "/" + key;
  if (!rows.is_array()) throw SceneError(where, "found " + rows.dump() + ", expected an array");
  for (std::size_t k = 0; k < rows.size(); ++k) {
    if (key == "per_node") {
      arguments.per_node[name].push_back(read_number(rows[k], at(where, k)));
      continue;
    }
    if (!rows[k].is_array() || rows[k].size() != 2)
      throw SceneError(at(where, k), "found " + rows[k].dump() + ", expected [time, value]");
    for (std::size_t i = 0; i < 2; ++i)
      arguments.tables[name].push_back(read_number(rows[k][i], at(at(where, k), i)));
  }
  if (key == "per_node" && rows.size() != node_count)
    throw SceneError(where, "found " + std::to_string(rows.size()) + " values, expected " +
                                std::to_string(node_count) + ", one per node of the interface");
}

Arguments read_arguments(const json& parameters, std::size_t node_count, const std::string& pointer) {
  Arguments arguments;
  for (const auto& [name, value] : parameters.items()) {
    if (value.is_object())
      read_varying(value, name, node_count, arguments, pointer + "/" + name);
    else if (value.is_string() && !is_infinity(value))
      arguments.texts[name] = value.get<std::string>();
    else
      arguments.numbers[name] = read_number(value, pointer + "/" + name);
  }
  return arguments;
}

// An explicit path is relative to the scene, not to wherever the user happens to be.
std::string library_of(const json& interface, const std::filesystem::path& scene_file) {
  std::string library = interface.value("library", interface["law"].get<std::string>());
  if (library.find('/') == std::string::npos) return library;
  return (std::filesystem::absolute(scene_file).parent_path() / library).string();
}

std::string known_libraries() {
  std::string names;
  for (const std::string& file : ilaw::search())
    names += (names.empty() ? "" : ", ") + std::filesystem::path(file).stem().string();
  return names.empty() ? "none" : names;
}

std::unique_ptr<Interface> read_interface(const json& interface, std::size_t number, const Scene& scene) {
  const std::string pointer = at("/interfaces", number);
  InterfaceSetup setup;
  setup.name = interface.value("name", "interface" + std::to_string(number));
  setup.law = interface["law"].get<std::string>();
  setup.library = library_of(interface, scene.file);
  setup.nodes = read_nodes(interface["nodes"], scene.model->node_count(), pointer + "/nodes");
  setup.obstacle = read_obstacle(interface["obstacle"], scene.model->dimension(), pointer + "/obstacle");
  setup.arguments = read_arguments(interface.value("parameters", json::object()), setup.nodes.size(),
                                   pointer + "/parameters");
  try {
    return std::make_unique<Interface>(std::move(setup), *scene.model, scene.dt);
  } catch (const ilaw::error& error) {
    if (error.code() == ILAW_INVALID_PARAMETER) throw SceneError(pointer + "/parameters", error.what());
    if (error.code() == ILAW_NOT_FOUND)
      throw SceneError(pointer + (interface.contains("library") ? "/library" : "/law"),
                       std::string(error.what()) + "; libraries found: " + known_libraries());
    throw SceneError(pointer, error.what());
  }
}

void read_time(const json& time, Scene& scene) {
  if (time.contains("dt") == time.contains("cfl"))
    throw SceneError("/time", "found " +
                                  std::string(time.contains("dt") ? "both 'dt' and 'cfl'" : "neither") +
                                  ", expected one of 'dt' and 'cfl'");
  if (time.contains("cfl")) {
    const double critical = scene.model->critical_step();
    if (!std::isfinite(critical))
      throw SceneError("/time/cfl",
                       "this model has no critical time step (no internal forces), expected 'dt'");
    scene.dt = time["cfl"].get<double>() * critical;
  } else {
    scene.dt = time["dt"].get<double>();
  }
  const double steps = time["end"].get<double>() / scene.dt;
  constexpr double most_steps = 1e15;  // beyond, n*dt no longer tells steps apart
  if (!(steps <= most_steps))
    throw SceneError("/time", "end/dt is " + std::to_string(steps) + " steps, expected at most 1e15");
  const double rounded = std::round(steps);
  scene.steps =
      static_cast<std::int64_t>(std::abs(steps - rounded) <= 1e-9 * rounded ? rounded : std::ceil(steps));
}

void read_output(const json& output, Scene& scene) {
  scene.output.every = output.value("every", std::int64_t{1});
  const json watch = output.value("watch", json::array());
  for (std::size_t k = 0; k < watch.size(); ++k) {
    scene.output.watch.push_back(watch[k].get<int>());
    check_node(scene.output.watch.back(), scene.model->node_count(), at("/output/watch", k));
  }
}

void check_names(const Scene& scene) {
  std::set<std::string> seen;
  for (std::size_t i = 0; i < scene.interfaces.size(); ++i)
    if (!seen.insert(scene.interfaces[i]->name()).second)
      throw SceneError(at("/interfaces", i) + "/name", "found '" + scene.interfaces[i]->name() +
                                                           "' twice, expected a different name for each");
}

std::string read_file(const std::filesystem::path& file) {
  std::ifstream stream(file);
  std::ostringstream text;
  if (!stream || !(text << stream.rdbuf())) throw SceneError("", "the file cannot be read");
  return text.str();
}

}  // namespace

Scene read_scene(const std::filesystem::path& file) {
  Scene scene;
  scene.file = file;
  scene.source = parse_scene(read_file(file));
  validate_scene(scene.source);
  scene.title = scene.source.value("title", file.stem().string());
  scene.model = read_points(scene.source["model"]);
  read_time(scene.source["time"], scene);
  const json loads = scene.source.value("loads", json::array());
  for (std::size_t i = 0; i < loads.size(); ++i)
    scene.loads.push_back(read_load(loads[i], *scene.model, at("/loads", i)));
  for (std::size_t i = 0; i < scene.source["interfaces"].size(); ++i)
    scene.interfaces.push_back(read_interface(scene.source["interfaces"][i], i, scene));
  check_names(scene);
  read_output(scene.source.value("output", json::object()), scene);
  return scene;
}

}  // namespace ilaw::host
