// read_sets.hpp - sets of nodes that a scene names itself.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "model/model.hpp"

#include <nlohmann/json.hpp>

namespace ilaw::host {

// "/sets": a name for some nodes, beside those that the model has. Throws SceneError.
void read_sets(const nlohmann::json& sets, Model& model);

}  // namespace ilaw::host
