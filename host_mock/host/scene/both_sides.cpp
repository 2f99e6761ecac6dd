// SPDX-License-Identifier: BSD-3-Clause
#include "scene/readers.hpp"

#include "base/scene_error.hpp"
#include "scene/json_text.hpp"

#include <cstddef>
#include <string>
#include <utility>

namespace ilaw::host {

void expand_both_sides(nlohmann::json& scene) {
  nlohmann::json& interfaces = scene["interfaces"];
  const std::size_t count = interfaces.size();
  for (std::size_t i = 0; i < count; ++i) {
    if (!interfaces[i].contains("against")) continue;
    nlohmann::json& against = interfaces[i]["against"];
    const bool both = against.value("both_sides", false);
    against.erase("both_sides");
    if (!both) continue;
    const std::string pointer = at("/interfaces", i);
    if (!against.contains("surface"))
      throw SceneError(pointer + "/against/both_sides", "found pairs of nodes, expected a 'surface'");
    if (against.value("discretization", "node_to_facet") != "node_to_facet")
      throw SceneError(pointer + "/against/both_sides",
                       "found " + against["discretization"].dump() + ", which is one of both sides already");
    if (!interfaces[i]["nodes"].is_string())
      throw SceneError(pointer + "/nodes", "found a list, expected a surface, which its other side meets");
    interfaces[i]["area_factor"] = 0.5 * interfaces[i].value("area_factor", 1.0);
    nlohmann::json other = interfaces[i];
    other["name"] = interfaces[i].value("name", "interface" + std::to_string(i)) +
                    other_side_suffix;  // a comma would be a column
    other["nodes"] = against["surface"];
    other["against"]["surface"] = interfaces[i]["nodes"];
    interfaces.push_back(std::move(other));
  }
}

}  // namespace ilaw::host
