// SPDX-License-Identifier: BSD-3-Clause
#include "scene/scene.hpp"

#include "contact/mesh_surface.hpp"
#include "model/bars.hpp"
#include "model/blocks.hpp"
#include "model/points.hpp"
#include "model/rotating_spring.hpp"
#include "scene/arguments.hpp"
#include "scene/selection.hpp"
#include "scene/validation.hpp"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <fstream>
#include <numeric>
#include <set>
#include <sstream>
#include <system_error>
#include <utility>

namespace ilaw::host {
namespace {

using nlohmann::json;

std::string at(const std::string& pointer, std::size_t index) {
  return pointer + "/" + std::to_string(index);
}

Vector read_vector_or_zero(const json& object, const char* key, int dimension, const std::string& pointer) {
  if (!object.contains(key)) return Vector::Zero(dimension);
  return read_vector(object[key], dimension, pointer + "/" + key);
}

// Rows of a table: time first, then width values.
Table read_table(const json& rows, int width, const std::string& pointer) {
  std::vector<double> times;
  std::vector<Vector> values;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    if (static_cast<int>(rows[k].size()) != width + 1)
      throw SceneError(at(pointer, k), "found " + std::to_string(rows[k].size()) + " numbers, expected " +
                                           std::to_string(width + 1) + " (time and values)");
    const double time = rows[k][0].get<double>();
    if (!times.empty() && time <= times.back())
      throw SceneError(at(pointer, k),
                       "found time " + rows[k][0].dump() + ", expected one after " + rows[k - 1][0].dump());
    times.push_back(time);
    Vector value(width);
    for (int i = 0; i < width; ++i) value[i] = rows[k][static_cast<std::size_t>(i) + 1].get<double>();
    values.push_back(value);
  }
  return {times, values};
}

Motion read_motion(const json& object, int d, const std::string& pointer) {
  if (object.contains("velocity") && object.contains("path"))
    throw SceneError(pointer, "found both 'velocity' and 'path', expected at most one of them");
  if (object.contains("path")) return Motion(read_table(object["path"], d, pointer + "/path"));
  return Motion(read_vector_or_zero(object, "velocity", d, pointer));
}

// ---- models ---------------------------------------------------------------------------------------------

std::unique_ptr<Model> read_points(const json& model) {
  const int d = model["dimension"].get<int>();
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

std::unique_ptr<Model> read_rotating_spring(const json& model) {
  return std::make_unique<RotatingSpring>(SpringSetup{
      model["mass"].get<double>(), model["stiffness"].get<double>(), model["length"].get<double>(),
      model.value("area", 1.0), read_vector(model["position"], 2, "/model/position"),
      read_vector_or_zero(model, "velocity", 2, "/model")});
}

// Bodies are named in a scene, or bar0, bar1 ...
class BodyNames {
 public:
  explicit BodyNames(const char* kind) : kind_(kind) {}
  std::string next(const json& body, const std::string& pointer) {
    std::string name = body.value("name", kind_ + std::to_string(seen_.size()));
    if (name == "all" || !seen_.insert(name).second)
      throw SceneError(pointer + "/name",
                       "found '" + name + "', expected a name of its own for each body, other than 'all'");
    return name;
  }

 private:
  std::string kind_;
  std::set<std::string> seen_;
};

std::unique_ptr<Model> read_bars(const json& model) {
  std::vector<BarSetup> bars;
  BodyNames names("bar");
  for (std::size_t k = 0; k < model["bars"].size(); ++k) {
    const json& bar = model["bars"][k];
    bars.push_back({names.next(bar, at("/model/bars", k)), bar.value("start", 0.0),
                    bar["length"].get<double>(), bar["elements"].get<int>(), bar["young"].get<double>(),
                    bar["density"].get<double>(), bar.value("section", 1.0), bar.value("velocity", 0.0)});
  }
  return std::make_unique<Bars>(bars);
}

Material read_material(const json& material) {
  return {material["type"] == "linear" ? MaterialLaw::linear : MaterialLaw::neo_hookean,
          material["young"].get<double>(), material["poisson"].get<double>(),
          material["density"].get<double>()};
}

std::unique_ptr<Model> read_blocks(const json& model) {
  std::vector<BlockSetup> blocks;
  BodyNames names("block");
  double nodes = 0.0;
  for (std::size_t k = 0; k < model["blocks"].size(); ++k) {
    const json& block = model["blocks"][k];
    const std::string pointer = at("/model/blocks", k);
    const auto elements = block["elements"].get<std::array<int, 3>>();
    nodes += (elements[0] + 1.0) * (elements[1] + 1.0) * (elements[2] + 1.0);
    constexpr double most_nodes = 5e8;  // 3 degrees of freedom each must fit a 32-bit number
    if (nodes > most_nodes)
      throw SceneError(pointer + "/elements", "found " + block["elements"].dump() + ", which makes " +
                                                  json(nodes).dump() + " nodes, expected at most 5e8");
    blocks.push_back({names.next(block, pointer), read_vector_or_zero(block, "corner", 3, pointer),
                      read_vector(block["size"], 3, pointer + "/size"),
                      read_vector_or_zero(block, "velocity", 3, pointer), elements,
                      read_material(block["material"])});
  }
  return std::make_unique<Blocks>(blocks);
}

std::unique_ptr<Model> read_model(const json& model) {
  const std::string type = model["type"].get<std::string>();
  if (type == "points") return read_points(model);
  if (type == "rotating_spring") return read_rotating_spring(model);
  return type == "bars" ? read_bars(model) : read_blocks(model);
}

// ---- loads ----------------------------------------------------------------------------------------------

// Part of a total force for each node, by tributary area.
std::vector<double> shares_of(const NodeSet& set, const std::string& pointer) {
  const double sum = std::accumulate(set.areas.begin(), set.areas.end(), 0.0);
  if (!(sum > 0.0)) throw SceneError(pointer, "the nodes have no area to share a total force by");
  std::vector<double> shares = set.areas;
  for (double& share : shares) share /= sum;
  return shares;
}

std::unique_ptr<Load> read_prescribed(const json& load, const NodeSet& set, int d,
                                      const std::string& pointer) {
  std::vector<int> axes(static_cast<std::size_t>(d));
  std::iota(axes.begin(), axes.end(), 0);
  if (load.contains("axes")) axes = load["axes"].get<std::vector<int>>();
  for (const int axis : axes)
    if (axis >= d)
      throw SceneError(pointer + "/axes",
                       "found axis " + std::to_string(axis) + ", expected 0 to " + std::to_string(d - 1));
  return std::make_unique<PrescribedMotion>(set.nodes, axes, d, read_motion(load, d, pointer));
}

std::unique_ptr<Load> read_load(const json& load, const Model& model, const std::string& pointer) {
  const int d = model.dimension();
  const std::string type = load["type"].get<std::string>();
  const NodeSet set = select_nodes(load.value("nodes", json("all")), model, pointer + "/nodes");
  if (type == "gravity")
    return std::make_unique<Gravity>(model, set.nodes,
                                     read_vector(load["acceleration"], d, pointer + "/acceleration"));
  if (type == "force") {
    const std::vector<double> shares = load.value("total", false)
                                           ? shares_of(set, pointer + "/nodes")
                                           : std::vector<double>(set.nodes.size(), 1.0);
    return std::make_unique<Force>(set.nodes, shares,
                                   read_vector(load["direction"], d, pointer + "/direction"),
                                   read_table(load["history"], 1, pointer + "/history"));
  }
  if (type == "damping") return std::make_unique<Damping>(set.nodes, d, load["rate"].get<double>());
  if (type == "motion") return read_prescribed(load, set, d, pointer);
  const double time = load["time"].get<double>();
  if (time <= 0.0)
    throw SceneError(pointer + "/time", "found " + load["time"].dump() + ", expected a time > 0");
  return std::make_unique<Shock>(set.nodes, time, read_vector(load["impulse"], d, pointer + "/impulse"));
}

// ---- interfaces -----------------------------------------------------------------------------------------

Vector read_direction(const json& value, int d, const std::string& pointer) {
  Vector direction = read_vector(value, d, pointer);
  if (direction.norm() == 0.0) throw SceneError(pointer, "found a vector of length 0, expected a direction");
  return direction;
}

std::unique_ptr<const Obstacle> read_obstacle(const json& obstacle, int d, const std::string& pointer) {
  const std::string type = obstacle["type"].get<std::string>();
  const Motion motion = read_motion(obstacle, d, pointer);
  if (type == "plane")
    return std::make_unique<Plane>(read_vector(obstacle["point"], d, pointer + "/point"),
                                   read_direction(obstacle["normal"], d, pointer + "/normal"), motion);
  if (type == "sphere")
    return std::make_unique<Sphere>(read_vector(obstacle["center"], d, pointer + "/center"),
                                    obstacle["radius"].get<double>(), motion);
  if (d != 3)
    throw SceneError(pointer + "/type", "found \"cylinder\" in " + std::to_string(d) +
                                            "D, expected a model in 3D (in 2D a sphere is a disc)");
  return std::make_unique<Cylinder>(read_vector(obstacle["point"], d, pointer + "/point"),
                                    read_direction(obstacle["axis"], d, pointer + "/axis"),
                                    obstacle["radius"].get<double>(), motion);
}

std::unique_ptr<Counterpart> read_partners(const json& against, const NodeSet& own, const Model& model,
                                           const std::string& pointer) {
  if (!against.contains("nodes") || !against.contains("normal"))
    throw SceneError(pointer, "found " + against.dump() + ", expected 'nodes' and 'normal', or 'surface'");
  const NodeSet partners = select_nodes(against["nodes"], model, pointer + "/nodes");
  if (partners.nodes.size() != own.nodes.size())
    throw SceneError(pointer + "/nodes", "found " + std::to_string(partners.nodes.size()) +
                                             " nodes, expected one for each of the " +
                                             std::to_string(own.nodes.size()) + " nodes of the interface");
  for (std::size_t k = 0; k < own.nodes.size(); ++k)
    if (own.nodes[k] == partners.nodes[k])
      throw SceneError(pointer + "/nodes",
                       "node " + std::to_string(own.nodes[k]) + " would meet itself, expected another node");
  const Vector normal =
      read_direction(against["normal"], model.dimension(), pointer + "/normal").normalized();
  return std::make_unique<NodeCounterpart>(model, own.nodes, partners.nodes, normal);
}

std::unique_ptr<Counterpart> read_surface(const std::string& name, const NodeSet& own, const Model& model,
                                          const std::string& pointer) {
  const NodeSet& surface = select_surface(name, model, pointer);
  for (const int node : surface.nodes)
    if (std::find(own.nodes.begin(), own.nodes.end(), node) != own.nodes.end())
      throw SceneError(pointer, "node " + std::to_string(node) +
                                    " would meet its own facet, expected the surface of another body");
  return std::make_unique<MeshSurface>(model, own.nodes, surface);
}

std::unique_ptr<Counterpart> read_counterpart(const json& interface, const NodeSet& own, const Model& model,
                                              const std::string& pointer) {
  if (interface.contains("obstacle") == interface.contains("against"))
    throw SceneError(pointer,
                     std::string("found ") +
                         (interface.contains("obstacle") ? "both 'obstacle' and 'against'" : "neither") +
                         ", expected one of 'obstacle' (rigid) and 'against' (another body)");
  if (interface.contains("obstacle"))
    return std::make_unique<RigidCounterpart>(
        model, own.nodes, read_obstacle(interface["obstacle"], model.dimension(), pointer + "/obstacle"));
  const json& against = interface["against"];
  if (!against.contains("surface")) return read_partners(against, own, model, pointer + "/against");
  return read_surface(against["surface"].get<std::string>(), own, model, pointer + "/against/surface");
}

// A node that follows a given path cannot give way to an interface.
void refuse_prescribed(const Interface& interface, const Loads& loads, const std::string& pointer) {
  std::set<int> driven;
  for (const auto& load : loads)
    driven.insert(load->prescribed_nodes().begin(), load->prescribed_nodes().end());
  for (const std::vector<int>* nodes : {&interface.nodes(), &interface.setup().counterpart->partners()})
    for (const int node : *nodes)
      if (driven.count(node))
        throw SceneError(pointer,
                         "found node " + std::to_string(node) +
                             ", whose motion is prescribed by a load, expected nodes that are free to move");
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

// The first tangent, for laws that tell the two apart: one direction for the whole interface, which must be
// flat.
Vector read_tangent(const json& interface, const InterfaceSetup& setup, const Model& model,
                    const std::string& pointer) {
  if (!interface.contains("tangent")) return {};
  Vector tangent = read_direction(interface["tangent"], model.dimension(), pointer).normalized();
  if (!setup.counterpart->keeps_normal())
    throw SceneError(pointer, "found a tangent, expected none: the normal of the counterpart turns");
  if (std::abs(tangent.dot(setup.counterpart->contact_point(0, Dofs::Zero(model.mass().size()), 0.0).normal)) > 1e-9)
    throw SceneError(pointer,
                     "found " + interface["tangent"].dump() + ", expected a direction across the normal");
  return tangent;
}

std::unique_ptr<Interface> read_interface(const json& interface, std::size_t number, const Scene& scene) {
  const std::string pointer = at("/interfaces", number);
  const NodeSet own = select_nodes(interface["nodes"], *scene.model, pointer + "/nodes");
  InterfaceSetup setup;
  setup.name = interface.value("name", "interface" + std::to_string(number));
  setup.law = interface["law"].get<std::string>();
  setup.library = library_of(interface, scene.file);
  setup.nodes = own.nodes;
  setup.areas = own.areas;
  setup.counterpart = read_counterpart(interface, own, *scene.model, pointer);
  setup.arguments = read_arguments(interface.value("parameters", json::object()), setup.nodes.size(),
                                   pointer + "/parameters");
  setup.birth = interface.value("birth", setup.birth);
  setup.death = interface.value("death", setup.death);
  if (setup.death <= setup.birth)
    throw SceneError(pointer + "/death", "found " + interface["death"].dump() +
                                             ", expected a time after birth, " + json(setup.birth).dump());
  setup.tangent = read_tangent(interface, setup, *scene.model, pointer + "/tangent");
  setup.gap_offset = interface.value("gap_offset", 0.0);
  setup.keeps_all_active = !interface.value("skip", true);
  try {
    auto made = std::make_unique<Interface>(std::move(setup), *scene.model);
    refuse_prescribed(*made, scene.loads, pointer + "/nodes");
    return made;
  } catch (const ParameterError& error) {
    const std::string whose =
        error.node_index() ? " (node " + std::to_string(own.nodes[*error.node_index()]) + ")" : "";
    throw SceneError(pointer + "/parameters" + error.pointer(), error.what() + whose);
  } catch (const ilaw::error& error) {
    const std::string library = pointer + (interface.contains("library") ? "/library" : "/law");
    if (error.code() == ILAW_BAD_LIBRARY) throw SceneError(library, error.what());
    if (error.code() == ILAW_NOT_FOUND)
      throw SceneError(library, std::string(error.what()) + "; libraries found: " + known_libraries());
    throw SceneError(pointer, error.what());
  }
}

// A step given as such may be larger than the model can stand.
void check_step(Scene& scene) {
  const Model& model = *scene.model;
  constexpr double rounding = 1e-14;
  if (!(scene.dt > model.critical_step() * (1.0 + rounding))) return;
  const std::string found = "found " + json(scene.dt).dump(), critical = json(model.critical_step()).dump();
  if (model.critical_step_is_exact())
    throw SceneError("/time/dt", found + ", expected at most " + critical + ", the model's critical step");
  scene.warnings.push_back("/time/dt: " + found +
                           ", which may be unstable: the critical step is known to be " + critical +
                           " at least");
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
    check_step(scene);
  }
  const double steps = time["end"].get<double>() / scene.dt;
  constexpr double most_steps = 1e15;  // beyond, n*dt no longer tells steps apart
  if (!(steps <= most_steps))
    throw SceneError("/time", "end/dt is " + json(steps).dump() + " steps, expected at most 1e15");
  const double rounded = std::round(steps);
  scene.steps =
      static_cast<std::int64_t>(std::abs(steps - rounded) <= 1e-9 * rounded ? rounded : std::ceil(steps));
}

void read_output(const json& output, Scene& scene) {
  scene.output.every = output.value("every", std::int64_t{1});
  scene.output.balance = output.value("balance", false);
  scene.output.fields = output.value("fields", std::int64_t{0});
  const json watch = output.value("watch", json::array());
  for (std::size_t k = 0; k < watch.size(); ++k) {
    const std::string pointer = at("/output/watch", k);
    if (watch[k].is_number() && watch[k].get<int>() >= scene.model->node_count())
      throw SceneError(pointer, "found node " + watch[k].dump() + ", expected 0 to " +
                                    std::to_string(scene.model->node_count() - 1));
    const json nodes = watch[k].is_number() ? json::array({watch[k]}) : watch[k];
    for (const int node : select_nodes(nodes, *scene.model, pointer).nodes)
      if (std::find(scene.output.watch.begin(), scene.output.watch.end(), node) == scene.output.watch.end())
        scene.output.watch.push_back(node);
  }
}

void check_names(const Scene& scene) {
  std::set<std::string> seen;
  for (std::size_t i = 0; i < scene.interfaces.size(); ++i)
    if (!seen.insert(scene.interfaces[i]->name()).second)
      throw SceneError(at("/interfaces", i) + "/name", "found '" + scene.interfaces[i]->name() +
                                                           "' twice, expected a different name for each");
}

// Times at which nothing can happen any more.
void warn_of_times(Scene& scene) {
  const double end = static_cast<double>(scene.steps) * scene.dt;
  const auto warn_if_late = [&](const json& parts, const char* key, const std::string& pointer) {
    for (std::size_t i = 0; i < parts.size(); ++i)
      if (parts[i].contains(key) && parts[i][key].get<double>() > end)
        scene.warnings.push_back(at(pointer, i) + "/" + key + ": found " + parts[i][key].dump() +
                                 ", after the end of the run, " + json(end).dump());
  };
  warn_if_late(scene.source.value("loads", json::array()), "time", "/loads");
  warn_if_late(scene.source["interfaces"], "birth", "/interfaces");
  const double wanted = scene.source["time"]["end"].get<double>();
  if (scene.dt > wanted * (1.0 + 1e-9))
    scene.warnings.push_back("/time/end: found " + json(wanted).dump() + ", less than one step, " +
                             json(scene.dt).dump() + ", which is taken all the same");
  if (scene.output.every > scene.steps)
    scene.warnings.push_back("/output/every: found " + std::to_string(scene.output.every) +
                             ": the history has no row in " + std::to_string(scene.steps) + " steps");
}

// Nodes that start inside a rigid obstacle are thrown out of it by most laws.
void warn_of_start(Scene& scene) {
  const Dofs start = Dofs::Zero(scene.model->mass().size());
  const double rounding = 1e-12 * scene.model->position().cwiseAbs().maxCoeff();
  for (std::size_t i = 0; i < scene.interfaces.size(); ++i) {
    const Interface& interface = *scene.interfaces[i];
    if (!interface.setup().counterpart->partners().empty()) continue;
    std::size_t count = 0, deepest = 0;
    double least = 0.0;
    for (std::size_t k = 0; k < interface.nodes().size(); ++k) {
      const double gap = interface.gap_at(static_cast<int>(k), start, 0.0);
      if (gap < -rounding) ++count;
      if (gap < least) {
        least = gap;
        deepest = k;
      }
    }
    if (count > 0)
      scene.warnings.push_back(at("/interfaces", i) + ": " + std::to_string(count) +
                               " node(s) start inside the obstacle, node " +
                               std::to_string(interface.nodes()[deepest]) + " by " + json(-least).dump());
  }
}

std::string read_file(const std::filesystem::path& file) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(file, error);
  if (status.type() == std::filesystem::file_type::not_found)
    throw SceneError("no such file, expected a scene");
  if (std::filesystem::is_directory(status)) throw SceneError("found a folder, expected a scene");
  std::ifstream stream(file);
  std::ostringstream text;
  if (stream.peek() == std::ifstream::traits_type::eof() && stream.is_open())
    throw SceneError("the file is empty, expected a scene");
  if (!stream || !(text << stream.rdbuf()))
    throw SceneError(std::string("the file cannot be read: ") + std::strerror(errno));
  return text.str();
}

}  // namespace

nlohmann::json read_scene_source(const std::filesystem::path& file) {
  nlohmann::json source = parse_scene(read_file(file));
  validate_scene(source);
  return source;
}

Scene read_scene(const std::filesystem::path& file) { return read_scene(read_scene_source(file), file); }

Scene read_scene(nlohmann::json source, const std::filesystem::path& file) {
  Scene scene;
  scene.file = file;
  scene.source = std::move(source);
  scene.title = scene.source.value("title", file.stem().string());
  scene.model = read_model(scene.source["model"]);
  read_time(scene.source["time"], scene);
  const json loads = scene.source.value("loads", json::array());
  for (std::size_t i = 0; i < loads.size(); ++i)
    scene.loads.push_back(read_load(loads[i], *scene.model, at("/loads", i)));
  for (std::size_t i = 0; i < scene.source["interfaces"].size(); ++i)
    scene.interfaces.push_back(read_interface(scene.source["interfaces"][i], i, scene));
  check_names(scene);
  read_output(scene.source.value("output", json::object()), scene);
  warn_of_times(scene);
  warn_of_start(scene);
  return scene;
}

}  // namespace ilaw::host
