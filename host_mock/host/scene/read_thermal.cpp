// SPDX-License-Identifier: BSD-3-Clause
#include "scene/readers.hpp"

#include "model/load.hpp"
#include "model/thermal_model.hpp"
#include "scene/json_text.hpp"
#include "scene/scene.hpp"
#include "scene/values.hpp"

#include <algorithm>
#include <limits>
#include <map>
#include <string_view>
#include <utility>
#include <vector>

namespace ilaw::host {
namespace {

using nlohmann::json;

ThermalBody body_of(const json& thermal, std::string name, std::vector<int> nodes) {
  return {std::move(name), std::move(nodes), thermal["specific_heat"].get<double>(),
          thermal.value("conductivity", 0.0), thermal["initial_temperature"].get<double>()};
}

bool has_temperature(int node, const Model& model) {
  return model.thermal() && model.thermal()->has_temperature(node);
}

// With two temperatures of one node the law would see the one, and heat flow into the other.
[[noreturn]] void refuse_second_value(const std::string& pointer, const std::string& interface) {
  throw mistake(pointer, "a value",
                "none: the nodes of '" + interface + "' have temperatures of their own, which its law reads");
}

// Values per node until a step overwrites them: the law is created with them.
std::vector<double> first_values(std::string_view field, const InterfaceSetup& setup, const Model& model) {
  const ThermalModel& thermal = *model.thermal();
  const std::vector<int>& partners = setup.counterpart->partners();
  const bool is_counterpart = field.starts_with("counterpart_"), is_capacity = field.ends_with("capacity");
  double obstacle = std::numeric_limits<double>::infinity();
  if (!is_capacity)
    obstacle = setup.heat->obstacle_temperature ? setup.heat->obstacle_temperature->at(0.0)[0] : 0.0;
  std::vector<double> values;
  for (std::size_t k = 0; k < setup.nodes.size(); ++k) {
    if (is_counterpart && partners.empty()) {
      values.push_back(obstacle);
      continue;
    }
    const bool has_pairs = partners.size() == setup.nodes.size();
    const int node = is_counterpart ? partners[has_pairs ? k : 0] : setup.nodes[k];
    values.push_back(is_capacity ? thermal.capacity()[node] : thermal.initial_temperature()[node]);
  }
  return values;
}

std::optional<Table> read_obstacle_temperature(const json& interface, const std::string& pointer) {
  if (!interface.contains("obstacle") || !interface["obstacle"].contains("temperature")) return {};
  const json& temperature = interface["obstacle"]["temperature"];
  if (temperature.is_number()) return Table({0.0}, {Vector::Constant(1, temperature.get<double>())});
  return read_table(temperature, 1, pointer + "/obstacle/temperature");
}

}  // namespace

std::shared_ptr<const ThermalModel> read_thermal(const json& given, const Model& model) {
  std::vector<ThermalBody> bodies;
  for (const auto& [list, kind] : {std::pair{"blocks", "block"}, std::pair{"meshes", "mesh"}})
    for (std::size_t k = 0; given.contains(list) && k < given[list].size(); ++k) {
      const json& body = given[list][k];
      const std::string name = body.value("name", kind + std::to_string(k));
      if (body.contains("thermal"))
        bodies.push_back(body_of(body["thermal"], name, model.sets().at(name).nodes));
    }
  if (given.contains("points") && given["points"].is_array())
    for (std::size_t k = 0; k < given["points"].size(); ++k)
      if (const json& point = given["points"][k]; point.contains("thermal"))
        bodies.push_back(body_of(point["thermal"], "point" + std::to_string(k), {static_cast<int>(k)}));
  return bodies.empty() ? nullptr : std::make_shared<const ThermalModel>(model, bodies);
}

void require_temperatures(const std::vector<int>& nodes, const Model& model, const std::string& pointer) {
  for (const int node : nodes)
    if (!has_temperature(node, model))
      throw mistake(pointer, "node " + std::to_string(node) + ", which has no temperature",
                    "nodes of bodies with 'thermal'");
}

void read_contact_heat(const json& interface, const Scene& scene, const std::string& pointer,
                       InterfaceSetup& setup) {
  const Model& model = *scene.model;
  const std::vector<int>& partners = setup.counterpart->partners();
  const auto any = [&](const std::vector<int>& nodes) {
    return std::any_of(nodes.begin(), nodes.end(), [&](int node) { return has_temperature(node, model); });
  };
  std::optional<Table> obstacle = read_obstacle_temperature(interface, pointer);
  if (obstacle || any(partners)) require_temperatures(setup.nodes, model, pointer + "/nodes");
  if (!any(setup.nodes)) return;
  require_temperatures(setup.nodes, model, pointer + "/nodes");
  require_temperatures(partners, model, pointer + "/against");
  setup.heat = HeatSetup{std::move(obstacle)};
  for (const char* field : ContactHeat::field_names) {
    if (setup.arguments.gives(field)) refuse_second_value(pointer + "/parameters/" + field, setup.name);
    setup.arguments.fields[field] = first_values(field, setup, model);
  }
}

void check_temperatures_read(const Interface& interface, const Scene& scene, const std::string& pointer) {
  const InterfaceSetup& setup = interface.setup();
  if (!setup.heat) return;
  const json fields = scene.source.value("fields", json::object());
  for (const char* field : ContactHeat::field_names)
    if (fields.contains(field) && interface.heat()->reads(field))
      refuse_second_value(std::string("/fields/") + field, setup.name);
  const bool is_missing = !setup.heat->obstacle_temperature && setup.counterpart->partners().empty();
  if (is_missing && interface.heat()->reads("counterpart_temperature"))
    throw SceneError(pointer + "/obstacle",
                     "key 'temperature' is missing, which law '" + setup.law + "' reads");
}

void check_held_temperatures(const Scene& scene) {
  const json loads = scene.source.value("loads", json::array());
  std::map<int, std::size_t> first_load;
  for (std::size_t i = 0; i < loads.size(); ++i) {
    const HeatLoad* const heat = scene.loads[i]->heat();
    if (!heat || !heat->holds()) continue;
    for (const int node : heat->set().nodes) {
      const std::size_t first = first_load.emplace(node, i).first->second;
      const json &own = loads[i]["history"], &other = loads[first]["history"];
      if (own != other)
        throw mistake(at("/loads", i),
                      "node " + std::to_string(node) + " held at " + own.dump() + ", which " +
                          at("/loads", first) + " holds at " + other.dump(),
                      "one 'history' for each node");
    }
  }
}

}  // namespace ilaw::host
