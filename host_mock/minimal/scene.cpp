// scene.cpp - reads the scenes that this host can run, and refuses all others.
// SPDX-License-Identifier: BSD-3-Clause
#define JSON_DIAGNOSTICS 1  // errors of a type or a missing key have the place in the file

#include "minimal.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <numeric>
#include <stdexcept>

namespace minimal {
namespace {

using nlohmann::json;

[[noreturn]] void refuse(const std::string& place, const json& found, const std::string& allowed) {
  throw std::invalid_argument(place + ": found " + found.dump() + ", expected " + allowed);
}

// Refuses a key that this host would ignore.
const json& only(const json& object, const std::string& place, const std::vector<std::string>& keys) {
  std::string allowed;
  for (const std::string& key : keys) allowed += (allowed.empty() ? "" : ", ") + key;
  for (const auto& [key, value] : object.items())
    if (std::find(keys.begin(), keys.end(), key) == keys.end()) refuse(place, key, "one of " + allowed);
  return object;
}

double positive(const json& object, const std::string& place, const char* key) {
  const double value = object.at(key).get<double>();
  if (!(value > 0.0)) refuse(place + "/" + key, object[key], "a number above 0");
  return value;
}

Values vector_of(const json& object, const std::string& place, const char* key, std::size_t d) {
  const Values values = object.at(key).get<Values>();
  if (values.size() != d)
    refuse(place + "/" + key, object[key], std::to_string(d) + " numbers, the dimension");
  return values;
}

Values vector_or_zero(const json& object, const std::string& place, const char* key, std::size_t d) {
  return object.contains(key) ? vector_of(object, place, key, d) : Values(d, 0.0);
}

Values unit_of(const json& object, const std::string& place, std::size_t d) {
  Values unit = vector_of(object, place, "normal", d);
  const double length = std::sqrt(std::inner_product(unit.begin(), unit.end(), unit.begin(), 0.0));
  if (!(length > 0.0)) refuse(place + "/normal", object["normal"], "a direction");
  for (double& component : unit) component /= length;
  return unit;
}

Points read_points(const json& model) {
  only(model, "/model", {"type", "dimension", "points"});
  if (model.at("type") != "points") refuse("/model/type", model["type"], "\"points\"");
  Points points{model.at("dimension").get<std::size_t>(), {}, {}, {}, {}, {}};
  if (points.d < 1 || points.d > 3) refuse("/model/dimension", model["dimension"], "1, 2 or 3");
  const auto append = [](Values& all, const Values& own) { all.insert(all.end(), own.begin(), own.end()); };
  for (const json& point : model.at("points")) {
    const std::string place = "/model/points/" + std::to_string(points.mass.size());
    only(point, place, {"mass", "area", "position", "velocity", "stiffness"});
    points.mass.push_back(positive(point, place, "mass"));
    points.area.push_back(point.value("area", 1.0));
    append(points.position, vector_of(point, place, "position", points.d));
    append(points.velocity, vector_or_zero(point, place, "velocity", points.d));
    append(points.stiffness, vector_or_zero(point, place, "stiffness", points.d));
  }
  return points;
}

Nodes read_nodes(const json& nodes, const std::string& place, const Points& points) {
  Nodes read(points.mass.size());
  std::iota(read.begin(), read.end(), 0);
  if (nodes == "all") return read;
  const Nodes given = nodes.get<Nodes>();
  for (std::size_t k = 0; k < given.size(); ++k)
    if (std::count(read.begin(), read.end(), given[k]) == 0 ||
        std::count(given.begin(), given.end(), given[k]) > 1)
      refuse(place, given[k], "a node of 0 to " + std::to_string(read.size() - 1) + ", once");
  return given;
}

void read_load(const json& load, const std::string& place, Scene& scene) {
  const std::size_t d = scene.points.d;
  const std::string type = load.at("type");
  const Nodes nodes = read_nodes(load.value("nodes", json("all")), place + "/nodes", scene.points);
  if (type == "gravity") {
    only(load, place, {"type", "name", "nodes", "acceleration"});
    scene.forces.push_back({nodes, vector_of(load, place, "acceleration", d), {0.0}, {1.0}, true});
  } else if (type == "force") {
    only(load, place, {"type", "name", "nodes", "direction", "history"});
    Force force{nodes, vector_of(load, place, "direction", d), {}, {}, false};
    for (const json& row : load.at("history")) {
      if (row.size() != 2 || (!force.times.empty() && !(row[0].get<double>() > force.times.back())))
        refuse(place + "/history", row, "[time, value] with a time after the row before");
      force.times.push_back(row[0].get<double>());
      force.values.push_back(row[1].get<double>());
    }
    if (force.times.empty()) refuse(place + "/history", load["history"], "at least one [time, value]");
    scene.forces.push_back(force);
  } else if (type == "shock") {
    only(load, place, {"type", "name", "nodes", "time", "impulse"});
    scene.shocks.push_back({nodes, positive(load, place, "time"), vector_of(load, place, "impulse", d)});
  } else {
    refuse(place + "/type", load["type"], "gravity, force or shock");
  }
}

Obstacle read_obstacle(const json& obstacle, const std::string& place, std::size_t d) {
  const Values velocity = vector_or_zero(obstacle, place, "velocity", d);
  if (obstacle.at("type") == "plane") {
    only(obstacle, place, {"type", "point", "normal", "velocity"});
    return {vector_of(obstacle, place, "point", d), unit_of(obstacle, place, d), velocity, 0.0};
  }
  if (obstacle["type"] != "sphere") refuse(place + "/type", obstacle["type"], "plane or sphere");
  only(obstacle, place, {"type", "center", "radius", "velocity"});
  return {vector_of(obstacle, place, "center", d), Values(d, 0.0), velocity,
          positive(obstacle, place, "radius")};
}

// JSON has no infinity: "inf" stands for it.
void flatten(const json& values, Values& flat) {
  if (!values.is_array()) return flat.push_back(values == "inf" ? INFINITY : values.get<double>());
  for (const json& value : values) flatten(value, flat);
}

// {"table": [[time, value], ...]} or {"table": {"axes": [{"name", "points"}], "values": nested arrays}}
void add_table(const json& table, const std::string& name, ilaw::parameters& parameters) {
  std::vector<ilaw::parameters::axis> axes;
  Values values;
  if (table.is_array()) {
    axes.push_back({"time", {}});
    for (const json& row : table) {
      flatten(row.at(0), axes[0].points);
      flatten(row.at(1), values);
    }
  } else {
    for (const json& axis : table.at("axes"))
      flatten(axis.at("points"), axes.emplace_back(ilaw::parameters::axis{axis.at("name"), {}}).points);
    flatten(table.at("values"), values);
  }
  parameters.table(name, axes, values);
}

bool takes_field(const ilaw_law& law, const std::string& name) {
  constexpr ilaw_parameter_flags field = ILAW_FLAG_FIELD | ILAW_FLAG_ALLOWS_PER_NODE;
  for (std::uint32_t k = 0; k < law.parameter_count; ++k)
    if (name == law.parameters[k]->name) return (law.parameters[k]->flags & field) == field;
  return false;
}

// A field of the scene, such as the temperature, is a parameter per node of the laws that take it.
ilaw::interface create_law(const json& interface, const std::string& place, const json& fields,
                           std::size_t d) {
  const std::string id = interface.at("law");
  const auto library = ilaw::library::named(interface.value("library", id));
  const ilaw_law* const law = library.law(id);
  if (!law) refuse(place + "/law", id, "a law of " + library.path());
  ilaw::parameters parameters;
  const json given = interface.value("parameters", json::object());
  for (const auto& [name, value] : given.items()) {
    if (value.is_string())
      parameters.set(*law, name, value.get<std::string>());
    else if (value.is_object())
      add_table(only(value, place + "/parameters/" + name, {"table"}).at("table"), name, parameters);
    else
      parameters.number(name, value.get<double>());
  }
  for (const auto& [name, values] : fields.items())
    if (takes_field(*law, name) && !given.contains(name)) parameters.per_node(name);
  ilaw_setup setup{};
  setup.struct_size = sizeof setup;
  setup.dimension = static_cast<std::uint32_t>(d);
  setup.delassus_form = ILAW_DELASSUS_SCALAR;
  setup.frame = ILAW_FRAME_GLOBAL;
  setup.numbers = ILAW_NUMBERS_DOUBLE;
  parameters.give(setup);
  return {library, id, setup};
}

// Nodes against an obstacle, or against other nodes across a given normal.
Contacts read_interface(const json& interface, const std::string& place, const json& fields,
                        const Points& points) {
  only(interface, place, {"name", "law", "library", "parameters", "nodes", "obstacle", "against"});
  const std::size_t d = points.d;
  Contacts contacts(interface.value("name", "interface" + place.substr(place.rfind('/') + 1)),
                    create_law(interface, place, fields, d),
                    read_nodes(interface.at("nodes"), place + "/nodes", points));
  const std::size_t count = contacts.nodes.size();
  if (interface.contains("against")) {
    const json& against = only(interface["against"], place + "/against", {"nodes", "normal"});
    contacts.partners = read_nodes(against.at("nodes"), place + "/against/nodes", points);
    if (contacts.partners.size() != count)
      refuse(place + "/against/nodes", against["nodes"], "one for each node of the interface");
    contacts.obstacle = {{}, unit_of(against, place + "/against", d), Values(d, 0.0), 0.0};
  } else {
    contacts.obstacle = read_obstacle(interface.at("obstacle"), place + "/obstacle", d);
  }
  for (std::uint32_t p = 0; p < contacts.info.per_node_parameter_count; ++p) {
    const json& field = fields.at(contacts.info.per_node_parameters[p]);
    const Values all =
        field.is_number() ? Values(points.mass.size(), field.get<double>()) : field.get<Values>();
    if (all.size() != points.mass.size()) refuse("/fields", field, "a number, or one for each point");
    Values& own = contacts.parameters.emplace_back();
    for (const std::int32_t node : contacts.nodes) own.push_back(all[static_cast<std::size_t>(node)]);
  }
  for (const std::int32_t node : contacts.nodes)
    contacts.area.push_back(points.area[static_cast<std::size_t>(node)]);
  for (Values* vectors : {&contacts.v_free, &contacts.v_previous, &contacts.normal, &contacts.impulse})
    vectors->resize(d * count);
  contacts.delassus.resize(count);
  contacts.gap.resize(count);
  contacts.state.resize(contacts.info.state_size * count);
  contacts.status.resize(count, ILAW_FREE);
  return contacts;
}

void read_time(const json& time, Scene& scene) {
  only(time, "/time", {"dt", "end"});
  scene.dt = positive(time, "/time", "dt");
  for (std::size_t i = 0; i < scene.points.stiffness.size(); ++i) {
    const double stable = 2.0 / std::sqrt(scene.points.stiffness[i] / scene.points.mass[i / scene.points.d]);
    if (scene.dt > stable)
      refuse("/time/dt", time["dt"], "at most the critical step " + std::to_string(stable));
  }
  const double steps = positive(time, "/time", "end") / scene.dt, rounded = std::round(steps);
  if (!(steps <= 1e15)) refuse("/time/end", time["end"], "at most 1e15 steps");
  scene.steps =
      static_cast<std::int64_t>(std::abs(steps - rounded) <= 1e-9 * rounded ? rounded : std::ceil(steps));
}

// "balance" and "forces" ask for more columns, which this host leaves out.
Scene read(const json& source) {
  only(source, "/",
       {"title", "doc", "model", "time", "fields", "loads", "interfaces", "output", "expect", "exact",
        "converge", "study"});
  const json none = json::array();
  const json& loads = source.contains("loads") ? source["loads"] : none;
  const json& interfaces = source.contains("interfaces") ? source["interfaces"] : none;
  Scene scene{source.value("title", "a scene"), read_points(source.at("model")), {}, {}, {}, 0.0, 0, 1, {}};
  for (std::size_t k = 0; k < loads.size(); ++k) read_load(loads[k], "/loads/" + std::to_string(k), scene);
  for (std::size_t k = 0; k < interfaces.size(); ++k)
    scene.contacts.push_back(read_interface(interfaces[k], "/interfaces/" + std::to_string(k),
                                            source.value("fields", json::object()), scene.points));
  read_time(source.at("time"), scene);
  const json output = source.value("output", json::object());
  only(output, "/output", {"every", "watch", "balance", "forces"});
  scene.every = output.value("every", std::int64_t{1});
  if (scene.every < 1) refuse("/output/every", output["every"], "1 or more");
  scene.watch = read_nodes(output.value("watch", none), "/output/watch", scene.points);
  return scene;
}

}  // namespace

double Force::at(double time) const {
  if (time <= times.front()) return values.front();
  if (time >= times.back()) return values.back();
  const auto k = static_cast<std::size_t>(std::upper_bound(times.begin(), times.end(), time) - times.begin());
  const double fraction = (time - times[k - 1]) / (times[k] - times[k - 1]);
  return (1.0 - fraction) * values[k - 1] + fraction * values[k];
}

Scene read_scene(const std::string& file) try {
  std::ifstream in(file);
  if (!in) refuse(file, "no file", "a scene in JSON");
  return read(json::parse(in));
} catch (const json::exception& error) {
  throw std::invalid_argument(error.what());
} catch (const ilaw::error& error) {
  throw std::invalid_argument(error.what());
}

}  // namespace minimal
