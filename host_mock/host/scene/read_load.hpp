// read_load.hpp - what acts on the bodies of a scene from outside.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "model/load.hpp"

#include <nlohmann/json.hpp>

#include <memory>
#include <string>

namespace ilaw::host {

// Throws SceneError at the pointer.
std::unique_ptr<Load> read_load(const nlohmann::json& load, const Model& model, const std::string& pointer);

}  // namespace ilaw::host
