// read_initial.hpp - where the nodes of a scene are at the start.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "model/model.hpp"

#include <nlohmann/json.hpp>

namespace ilaw::host {

// "/initial": displacements of nodes at time 0, on top of those that the bodies have. Throws
// SceneError.
void read_initial(const nlohmann::json& initial, Model& model);

}  // namespace ilaw::host
