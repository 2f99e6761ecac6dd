// values.hpp - vectors, tables, motions and nodes of a scene. All throw SceneError at the pointer.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/table.hpp"
#include "base/vector.hpp"
#include "model/model.hpp"
#include "model/obstacle.hpp"

#include <nlohmann/json.hpp>

#include <optional>
#include <string>
#include <vector>

namespace ilaw::host {

// A vector of the model's dimension.
Vector read_vector(const nlohmann::json& value, int dimension, const std::string& pointer);
// A vector whose key may be left out; then it is zero.
Vector read_vector_or_zero(const nlohmann::json& object, const char* key, int dimension,
                           const std::string& pointer);
// Any vector but zero.
Vector read_direction(const nlohmann::json& value, int dimension, const std::string& pointer);

// Rows of a table: time first, then width values. Or an object: {"rows": [...], "smooth": true} or {"sine":
// {...}}.
Table read_table(const nlohmann::json& rows, int width, const std::string& pointer);

// "velocity", "path" or neither.
Motion read_motion(const nlohmann::json& object, int dimension, const std::string& pointer);

// "all" or the name of a set; [0, 3]; {"near": [x, y, z]}, the nearest node, or those nearest to a
// list of places; {"box": [[...], [...]], "of": set}, those inside. Throws SceneError at the pointer.
NodeSet select_nodes(const nlohmann::json& nodes, const Model& model, const std::string& pointer);

// The shortest edge of an element; where there are none, the least distance of two nodes.
double spacing_of(std::vector<int> nodes, const Model& model);

struct ChosenPartners {
  std::vector<int> nodes;
  bool are_facing;  // false: sets that do not face each other node by node, in their own orders
};
// A partner for each node. A list or places keep their order; a set or box has none, so its nodes are paired
// with those that they face along a direction, by default from the center of the nodes to that of the
// partners.
ChosenPartners select_partners(const nlohmann::json& partners, const std::vector<int>& nodes,
                               const Model& model, std::optional<Vector> direction,
                               const std::string& pointer);

// As above, for a set that must have facets.
const NodeSet& select_surface(const std::string& name, const Model& model, const std::string& pointer);

}  // namespace ilaw::host
