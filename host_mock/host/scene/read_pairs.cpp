// SPDX-License-Identifier: BSD-3-Clause
#include "scene/readers.hpp"

#include "base/words.hpp"
#include "contact/interface.hpp"
#include "scene/arguments.hpp"
#include "scene/json_text.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <utility>
#include <vector>

namespace ilaw::host {
namespace {

using nlohmann::json;

using Sides = std::pair<std::string, std::string>;  // of a node, of its counterpart
using Values = std::map<std::string, double>;       // of parameters, by name

std::string names_of(const Values& values) {
  std::vector<std::string> names;
  for (const auto& [name, value] : values) names.push_back(name);
  return joined(names);
}

// The names of all obstacles of a scene.
std::set<std::string> obstacles_of(const json& scene) {
  std::set<std::string> names;
  for (const json& interface : scene["interfaces"])
    if (interface.contains("obstacle") && interface["obstacle"].contains("name"))
      names.insert(interface["obstacle"]["name"].get<std::string>());
  return names;
}

class PairTable {
 public:
  PairTable(const json& rows, const json& scene, const Model& model, const std::string& pointer) {
    for (std::size_t i = 0; i < rows.size(); ++i) add(rows[i], at(pointer, i));
    find_sides(scene, model, pointer);
  }

  // The one side that a node belongs to.
  const std::string& side_of(int node, const std::string& pointer) const {
    const auto found = side_of_.find(node);
    if (found == side_of_.end())
      throw mistake(pointer, "node " + std::to_string(node) + " in none of the sides",
                    "each node in one of " + joined({names_.begin(), names_.end()}));
    return found->second;
  }

  // A row holds for both orders, unless the other order has its own.
  const Values& row(const Sides& sides, const std::string& pointer) const {
    auto found = rows_.find(sides);
    if (found == rows_.end()) found = rows_.find({sides.second, sides.first});
    if (found == rows_.end())
      throw mistake(pointer, "no row for " + sides.first + " and " + sides.second, "one in the table");
    return found->second;
  }

 private:
  void add(const json& row, const std::string& pointer) {
    const Sides sides{row["sides"][0].get<std::string>(), row["sides"][1].get<std::string>()};
    const Values values = read_arguments(row["parameters"], 0, pointer + "/parameters").numbers;
    if (!rows_.empty() && names_of(rows_.begin()->second) != names_of(values))
      throw mistake(pointer + "/parameters", names_of(values),
                    names_of(rows_.begin()->second) + ", as in the other rows");
    if (!rows_.emplace(sides, values).second)
      throw mistake(pointer + "/sides", row["sides"].dump() + " twice", "each pair once");
    names_.insert({sides.first, sides.second});
  }

  void find_sides(const json& scene, const Model& model, const std::string& pointer) {
    const std::set<std::string> obstacles = obstacles_of(scene);
    for (const std::string& name : names_) {
      const auto set = model.sets().find(name);
      if (set == model.sets().end() && !obstacles.contains(name))
        throw mistake(pointer, "the side '" + name + "'", "a set of nodes, or the name of an obstacle");
      if (set == model.sets().end()) continue;
      for (const int node : set->second.nodes)
        if (const auto [other, is_new] = side_of_.emplace(node, name); !is_new)
          throw mistake(pointer,
                        "node " + std::to_string(node) + " in '" + other->second + "' and '" + name + "'",
                        "sides that have no node in common");
    }
  }

  std::map<Sides, Values> rows_;
  std::set<std::string> names_;
  std::map<int, std::string> side_of_;
};

// By node of the interface, the side that it meets.
std::vector<std::string> counterpart_sides(const json& interface, const Counterpart& counterpart,
                                           std::size_t node_count, const PairTable& table,
                                           const std::string& pointer) {
  if (interface.contains("obstacle")) {
    const json& obstacle = interface["obstacle"];
    if (!obstacle.contains("name"))
      throw SceneError(pointer + "/obstacle", "key 'name' is missing, the side of the obstacle in 'pairs'");
    return {node_count, obstacle["name"].get<std::string>()};
  }
  std::vector<std::string> sides;
  for (const int partner : counterpart.partners())
    sides.push_back(table.side_of(partner, pointer + "/against"));
  if (!counterpart.shares_partners()) return sides;
  const auto other = std::ranges::find_if(sides, [&](const auto& side) { return side != sides.front(); });
  if (other != sides.end())
    throw mistake(pointer + "/against/surface", "a surface of '" + sides.front() + "' and '" + *other + "'",
                  "an interface for each of them");
  return {node_count, sides.front()};
}

}  // namespace

void read_pairs(const json& interface, const json& scene, const Model& model, const std::string& pointer,
                InterfaceSetup& setup) {
  if (!interface.contains("pairs")) return;
  const std::string key = pointer + "/pairs", name = interface["pairs"].get<std::string>();
  const json tables = scene.value("pairs", json::object());
  if (!tables.contains(name)) {
    std::vector<std::string> names;
    for (const auto& [known, rows] : tables.items()) names.push_back(known);
    throw mistake(key, "\"" + name + "\"",
                  names.empty() ? "a table under '/pairs', which has none"
                                : "one of " + joined(names) + suggestion(name, names));
  }
  const PairTable table(tables[name], scene, model, "/pairs/" + name);
  const std::vector<std::string> met =
      counterpart_sides(interface, *setup.counterpart, setup.nodes.size(), table, pointer);
  std::map<std::string, std::vector<double>> columns;
  for (std::size_t k = 0; k < setup.nodes.size(); ++k)
    for (const auto& [parameter, value] :
         table.row({table.side_of(setup.nodes[k], pointer + "/nodes"), met[k]}, key))
      columns[parameter].push_back(value);
  for (auto& [parameter, values] : columns) {
    if (setup.arguments.gives(parameter))
      throw mistake(pointer + "/parameters/" + parameter,
                    "'" + parameter + "' here and in the table of 'pairs'", "one of them");
    const double first = values.front();
    const bool is_one = std::ranges::all_of(values, [first](double value) { return value == first; });
    if (is_one)
      setup.arguments.numbers[parameter] = first;
    else
      setup.arguments.per_node[parameter] = std::move(values);
  }
}

}  // namespace ilaw::host
