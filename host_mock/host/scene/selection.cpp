// SPDX-License-Identifier: BSD-3-Clause
#include "scene/values.hpp"

#include "base/words.hpp"
#include "model/elements.hpp"
#include "scene/json_text.hpp"
#include "scene/readers.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <iterator>
#include <map>
#include <optional>
#include <set>
#include <utility>

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

// The part of a set whose indices in it are given, with the facets that it has all nodes of.
NodeSet part_of(const NodeSet& set, const std::vector<std::size_t>& indices) {
  NodeSet part;
  for (const std::size_t index : indices) {
    part.nodes.push_back(set.nodes[index]);
    part.areas.push_back(set.areas[index]);
  }
  if (set.facets.empty()) return part;
  const std::set<int> own(part.nodes.begin(), part.nodes.end());
  std::copy_if(set.facets.begin(), set.facets.end(), std::back_inserter(part.facets), [&](const auto& facet) {
    return std::all_of(facet.begin(), facet.end(), [&](int node) { return own.count(node) > 0; });
  });
  return part;
}

// A number of any size, which an int need not hold.
int node_of(const json& number, const Model& model, const std::string& pointer) {
  if (number.get<double>() < model.node_count()) return number.get<int>();
  throw mistake(pointer, "node " + number.dump(), "0 to " + std::to_string(model.node_count() - 1));
}

// Nodes of a set in the order in which a scene names them.
class Distinct {
 public:
  explicit Distinct(const NodeSet& set) : set_(set) {}
  void add(std::size_t index, const std::string& pointer) {
    if (!seen_.insert(index).second)
      throw mistake(pointer, "node " + std::to_string(set_.nodes[index]) + " twice", "each node once");
    indices_.push_back(index);
  }
  NodeSet part() const { return part_of(set_, indices_); }

 private:
  const NodeSet& set_;
  std::set<std::size_t> seen_;
  std::vector<std::size_t> indices_;
};

NodeSet listed(const json& numbers, const Model& model, const std::string& pointer) {
  Distinct nodes(model.sets().at("all"));
  for (std::size_t k = 0; k < numbers.size(); ++k)
    nodes.add(static_cast<std::size_t>(node_of(numbers[k], model, at(pointer, k))), at(pointer, k));
  return nodes.part();
}

// The sets that name a body and have the node.
std::string bodies_of(int node, const Model& model) {
  std::vector<std::string> names;
  for (const auto& [name, set] : model.sets())
    if (name != "all" && name.find('.') == std::string::npos &&
        std::find(set.nodes.begin(), set.nodes.end(), node) != set.nodes.end())
      names.push_back("'" + name + "'");
  return "node " + std::to_string(node) + (names.empty() ? "" : " of " + joined(names));
}

// Nodes of two bodies at one place are refused: which of them comes first says nothing.
std::size_t nearest(const Vector& x, const NodeSet& set, const Model& model, const std::string& pointer) {
  const auto distance = [&](const Vector& from, std::size_t k) {
    return (model.position(set.nodes[k]) - from).norm();
  };
  std::size_t best = 0;
  for (std::size_t k = 1; k < set.nodes.size(); ++k)
    if (distance(x, k) < distance(x, best)) best = k;
  const Vector place = model.position(set.nodes[best]);
  const double edge = shortest_edge(model), same = std::isfinite(edge) ? 1e-6 * edge : 1e-12 * place.norm();
  for (std::size_t k = 0; k < set.nodes.size(); ++k)
    if (k != best && distance(place, k) <= same)
      throw mistake(
          pointer,
          bodies_of(set.nodes[best], model) + " and " + bodies_of(set.nodes[k], model) + " at one place",
          "one node there: name its body or face with 'of', or give its number");
  return best;
}

// One place, or a list of them.
NodeSet nearest_of(const json& selection, const Model& model, const std::string& selection_pointer) {
  const NodeSet& set = find_set(selection.value("of", "all"), model, false, selection_pointer + "/of");
  const json& places = selection["near"];
  const std::string pointer = selection_pointer + "/near";
  Distinct nodes(set);
  const auto add = [&](const json& place, const std::string& where) {
    nodes.add(nearest(read_vector(place, model.dimension(), where), set, model, where), where);
  };
  const auto numbers =
      std::count_if(places.begin(), places.end(), [](const json& one) { return one.is_number(); });
  if (numbers == static_cast<std::ptrdiff_t>(places.size())) {
    add(places, pointer);
  } else {
    if (numbers > 0) throw mistake(pointer, places.dump(), "a place, or a list of places");
    for (std::size_t k = 0; k < places.size(); ++k) add(places[k], at(pointer, k));
  }
  return nodes.part();
}

NodeSet inside(const json& selection, const Model& model, const std::string& pointer) {
  const NodeSet& set = find_set(selection.value("of", "all"), model, false, pointer + "/of");
  const Vector low = read_vector(selection["box"][0], model.dimension(), pointer + "/box/0");
  const Vector high = read_vector(selection["box"][1], model.dimension(), pointer + "/box/1");
  const double rounding = 1e-12 * std::max(low.cwiseAbs().maxCoeff(), high.cwiseAbs().maxCoeff());
  std::vector<std::size_t> indices;
  for (std::size_t k = 0; k < set.nodes.size(); ++k) {
    const Vector x = model.position(set.nodes[k]);
    if (((x - low).array() >= -rounding).all() && ((high - x).array() >= -rounding).all())
      indices.push_back(k);
  }
  if (indices.empty()) throw mistake(pointer + "/box", "no node inside", "at least one");
  return part_of(set, indices);
}

// ---- partners ----

// A unit vector, or 0 where both centers are one.
Vector between_centers(const std::vector<int>& nodes, const std::vector<int>& partners, double spacing,
                       const Model& model) {
  Vector sum = Vector::Zero(model.dimension());
  for (std::size_t k = 0; k < nodes.size(); ++k)
    sum += model.position(partners[k]) - model.position(nodes[k]);
  const double distance = sum.norm() / static_cast<double>(nodes.size());
  return distance > 1e-6 * spacing ? Vector(sum.normalized()) : Vector(Vector::Zero(model.dimension()));
}

// For each node the partner that it faces along a direction; none where some node faces no partner of its
// own.
std::vector<int> facing(const std::vector<int>& nodes, const std::vector<int>& partners,
                        const Vector& direction, double spacing, const Model& model) {
  const double near = 0.5 * spacing;
  const auto across = [&](int node) {
    const Vector x = model.position(node);
    return Vector(x - x.dot(direction) * direction);
  };
  const Vector axis =
      direction.isZero() ? Vector(Vector::Unit(model.dimension(), 0)) : Vector(direction.unitOrthogonal());
  const auto along = [&](int node) { return across(node).dot(axis); };
  std::multimap<double, int> sorted;
  for (const int partner : partners) sorted.emplace(along(partner), partner);
  std::vector<int> found;
  for (const int node : nodes) {
    const Vector x = across(node);
    double least = near;
    auto nearest = sorted.end();
    for (auto at = sorted.lower_bound(along(node) - near);
         at != sorted.end() && at->first <= along(node) + near; ++at)
      if (const double aside = (across(at->second) - x).norm(); aside < least) least = aside, nearest = at;
    if (nearest == sorted.end()) return {};
    found.push_back(nearest->second);
    sorted.erase(nearest);
  }
  return found;
}

// ---- names for nodes ----

bool is_letter(char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0; }
bool is_in_name(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; }

void check_name(const std::string& name, const Model& model, const std::string& pointer) {
  if (name.empty() || !is_letter(name.front()) || !std::all_of(name.begin(), name.end(), is_in_name))
    throw mistake(pointer, "the name '" + name + "'", "a letter, then letters, digits and _");
  if (model.sets().count(name) > 0)
    throw mistake(pointer, "'" + name + "', which the model has", "a name of its own");
}

}  // namespace

double spacing_of(std::vector<int> nodes, const Model& model) {
  double least = shortest_edge(model);
  if (std::isfinite(least) || nodes.empty()) return least;
  Vector low = model.position(nodes.front()), high = low;
  for (const int node : nodes) {
    low = low.cwiseMin(model.position(node));
    high = high.cwiseMax(model.position(node));
  }
  Eigen::Index axis = 0;
  (high - low).maxCoeff(&axis);
  std::ranges::sort(nodes, {}, [&](int node) { return model.position(node)[axis]; });
  for (std::size_t k = 0; k < nodes.size(); ++k)
    for (std::size_t j = k + 1; j < nodes.size(); ++j) {
      const Vector apart = model.position(nodes[j]) - model.position(nodes[k]);
      if (apart[axis] >= least) break;
      least = std::min(least, apart.norm());
    }
  return least;
}

NodeSet select_nodes(const json& nodes, const Model& model, const std::string& pointer) {
  if (nodes.is_string()) return find_set(nodes.get<std::string>(), model, false, pointer);
  if (nodes.is_number())
    return part_of(model.sets().at("all"), {static_cast<std::size_t>(node_of(nodes, model, pointer))});
  if (nodes.is_array()) return listed(nodes, model, pointer);
  if (nodes.contains("near")) return nearest_of(nodes, model, pointer);
  return inside(nodes, model, pointer);
}

ChosenPartners select_partners(const json& partners, const std::vector<int>& nodes, const Model& model,
                               std::optional<Vector> direction, const std::string& pointer) {
  ChosenPartners found{select_nodes(partners, model, pointer).nodes, true};
  if (found.nodes.size() != nodes.size())
    throw mistake(pointer, std::to_string(found.nodes.size()) + " nodes",
                  "one for each of the " + std::to_string(nodes.size()) + " nodes of 'nodes'");
  const bool is_ordered = partners.is_array() || partners.contains("near");
  if (!is_ordered && model.dimension() > 1) {
    const double spacing = spacing_of(found.nodes, model);
    const Vector along = direction ? *direction : between_centers(nodes, found.nodes, spacing, model);
    const std::vector<int> opposite = facing(nodes, found.nodes, along, spacing, model);
    found.are_facing = !opposite.empty();
    if (found.are_facing) found.nodes = opposite;
  }
  for (std::size_t k = 0; k < nodes.size(); ++k)
    if (nodes[k] == found.nodes[k])
      throw mistake(pointer, "node " + std::to_string(nodes[k]) + " at both ends", "another node");
  return found;
}

const NodeSet& select_surface(const std::string& name, const Model& model, const std::string& pointer) {
  return find_set(name, model, true, pointer);
}

// By the model's own sets, not by each other: members of a JSON object have no order.
void read_sets(const json& sets, Model& model) {
  std::vector<std::pair<std::string, NodeSet>> found;
  for (const auto& [name, selection] : sets.items()) {
    const std::string pointer = "/sets/" + name;
    check_name(name, model, pointer);
    found.emplace_back(name, select_nodes(selection, model, pointer));
  }
  for (auto& [name, set] : found) model.add_set(name, std::move(set));
}

}  // namespace ilaw::host
