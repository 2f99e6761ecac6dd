// SPDX-License-Identifier: BSD-3-Clause
#include "scene/selection.hpp"

#include "scene/json_text.hpp"
#include "scene/suggestion.hpp"
#include "scene/values.hpp"

#include <set>

namespace ilaw::host {
namespace {

using nlohmann::json;

// The sets there are, and which of them may be meant.
std::string names_of(const Model& model, bool with_facets, const std::string& wanted) {
  std::vector<std::string> names;
  for (const auto& [name, set] : model.sets())
    if (!with_facets || !set.facets.empty()) names.push_back(name);
  return names.empty() ? "no name: the model has none" : joined(names) + suggestion(wanted, names);
}

const NodeSet& find_set(const std::string& name, const Model& model, bool with_facets,
                        const std::string& pointer) {
  const auto found = model.sets().find(name);
  if (found == model.sets().end() || (with_facets && found->second.facets.empty()))
    throw mistake(pointer, "\"" + name + "\"", "one of " + names_of(model, with_facets, name));
  return found->second;
}

// The part of a set whose indices in it are given.
NodeSet part_of(const NodeSet& set, const std::vector<std::size_t>& indices) {
  NodeSet part;
  for (const std::size_t index : indices) {
    part.nodes.push_back(set.nodes[index]);
    part.areas.push_back(set.areas[index]);
  }
  return part;
}

// A number of any size, which an int need not hold.
int node_of(const json& number, const Model& model, const std::string& pointer) {
  if (number.get<double>() < model.node_count()) return number.get<int>();
  throw mistake(pointer, "node " + number.dump(), "0 to " + std::to_string(model.node_count() - 1));
}

NodeSet listed(const json& numbers, const Model& model, const std::string& pointer) {
  std::vector<std::size_t> indices;
  std::set<int> seen;
  for (std::size_t k = 0; k < numbers.size(); ++k) {
    const std::string where = at(pointer, k);
    const int node = node_of(numbers[k], model, where);
    if (!seen.insert(node).second)
      throw mistake(where, "node " + std::to_string(node) + " twice", "each node once");
    indices.push_back(static_cast<std::size_t>(node));
  }
  return part_of(model.sets().at("all"), indices);
}

Vector position_of(const Model& model, int node) {
  return model.position().segment(node * model.dimension(), model.dimension());
}

NodeSet nearest(const Vector& x, const Model& model) {
  std::size_t best = 0;
  for (std::size_t node = 1; node < static_cast<std::size_t>(model.node_count()); ++node)
    if ((position_of(model, static_cast<int>(node)) - x).squaredNorm() <
        (position_of(model, static_cast<int>(best)) - x).squaredNorm())
      best = node;
  return part_of(model.sets().at("all"), {best});
}

NodeSet inside(const json& selection, const Model& model, const std::string& pointer) {
  const NodeSet& set = find_set(selection.value("of", "all"), model, false, pointer + "/of");
  const Vector low = read_vector(selection["box"][0], model.dimension(), pointer + "/box/0");
  const Vector high = read_vector(selection["box"][1], model.dimension(), pointer + "/box/1");
  std::vector<std::size_t> indices;
  for (std::size_t k = 0; k < set.nodes.size(); ++k) {
    const Vector x = position_of(model, set.nodes[k]);
    if ((x.array() >= low.array()).all() && (x.array() <= high.array()).all()) indices.push_back(k);
  }
  if (indices.empty()) throw mistake(pointer + "/box", "no node inside", "at least one");
  return part_of(set, indices);
}

}  // namespace

NodeSet select_nodes(const json& nodes, const Model& model, const std::string& pointer) {
  if (nodes.is_string()) return find_set(nodes.get<std::string>(), model, false, pointer);
  if (nodes.is_number())
    return part_of(model.sets().at("all"), {static_cast<std::size_t>(node_of(nodes, model, pointer))});
  if (nodes.is_array()) return listed(nodes, model, pointer);
  if (nodes.contains("near"))
    return nearest(read_vector(nodes["near"], model.dimension(), pointer + "/near"), model);
  return inside(nodes, model, pointer);
}

const NodeSet& select_surface(const std::string& name, const Model& model, const std::string& pointer) {
  return find_set(name, model, true, pointer);
}

}  // namespace ilaw::host
