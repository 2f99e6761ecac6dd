// read_springs.hpp - springs and dampers of a scene.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "model/springs.hpp"

#include <nlohmann/json.hpp>

#include <vector>

namespace ilaw::host {

// "/springs": one between each pair of nodes. Throws SceneError.
std::vector<Spring> read_springs(const nlohmann::json& springs, const Model& model);

}  // namespace ilaw::host
