// selection.hpp - nodes that a scene names: by set, by number, by position.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "model/model.hpp"

#include <nlohmann/json.hpp>

#include <string>

namespace ilaw::host {

// "all" or the name of a set; [0, 3]; {"near": [x, y, z]}, the nearest node, or those nearest to a
// list of places; {"box": [[...], [...]], "of": set}, those inside. Throws SceneError at the pointer.
NodeSet select_nodes(const nlohmann::json& nodes, const Model& model, const std::string& pointer);

// As above, for a set that must have facets.
const NodeSet& select_surface(const std::string& name, const Model& model, const std::string& pointer);

}  // namespace ilaw::host
