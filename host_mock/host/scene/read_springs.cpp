// SPDX-License-Identifier: BSD-3-Clause
#include "scene/readers.hpp"

#include "model/springs.hpp"
#include "scene/json_text.hpp"
#include "scene/values.hpp"

#include <cstddef>
#include <string>

namespace ilaw::host {
namespace {

using nlohmann::json;

// As many other ends as there are nodes, or a fixed point for all.
std::vector<int> read_other_ends(const json& spring, const std::vector<int>& nodes, const Model& model,
                                 const std::string& pointer, std::vector<std::string>& warnings) {
  if (spring.contains("anchor")) return std::vector<int>(nodes.size(), -1);
  const ChosenPartners partners = select_partners(spring["to"], nodes, model, {}, pointer + "/to");
  if (!partners.are_facing)
    warnings.push_back(pointer +
                       "/to: these nodes do not face those of 'nodes' one by one, so they are "
                       "paired in the order of both sets; list them to choose the pairs");
  return partners.nodes;
}

// Without load, where the scene does not say: the distance of the ends before any displacement.
double read_length(const json& spring, const Spring& ends, const Model& model) {
  if (spring.contains("length")) return spring["length"].get<double>();
  const Vector end = ends.partner < 0 ? ends.anchor : model.position(ends.partner);
  return (end - model.position(ends.node)).norm();
}

}  // namespace

std::vector<Spring> read_springs(const json& springs, const Model& model,
                                 std::vector<std::string>& warnings) {
  std::vector<Spring> found;
  for (std::size_t i = 0; i < springs.size(); ++i) {
    const json& spring = springs[i];
    const std::string pointer = at("/springs", i);
    require_one_of(spring, "to", "anchor", "'to' (nodes) and 'anchor' (a fixed point)", pointer);
    const double stiffness = spring.value("stiffness", 0.0), damping = spring.value("damping", 0.0);
    if (stiffness == 0.0 && damping == 0.0)
      throw mistake(pointer, spring.dump(), "'stiffness', 'damping' or both above 0");
    const std::vector<int> nodes = select_nodes(spring["nodes"], model, pointer + "/nodes").nodes;
    const std::vector<int> partners = read_other_ends(spring, nodes, model, pointer, warnings);
    const Vector anchor = read_vector_or_zero(spring, "anchor", model.dimension(), pointer);
    for (std::size_t k = 0; k < nodes.size(); ++k) {
      Spring made{nodes[k], partners[k], anchor, stiffness, damping, 0.0};
      made.length = read_length(spring, made, model);
      found.push_back(std::move(made));
    }
  }
  return found;
}

}  // namespace ilaw::host
