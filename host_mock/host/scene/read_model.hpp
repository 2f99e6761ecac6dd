// read_model.hpp - the bodies of a scene.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "model/model.hpp"

#include <nlohmann/json.hpp>

#include <memory>

namespace ilaw::host {

// Throws SceneError.
std::unique_ptr<Model> read_model(const nlohmann::json& model);

}  // namespace ilaw::host
