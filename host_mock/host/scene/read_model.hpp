// read_model.hpp - the bodies of a scene.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "model/model.hpp"

#include <nlohmann/json.hpp>

#include <filesystem>
#include <memory>

namespace ilaw::host {

// meshes: what was read of files, as describe_meshes has it. Throws SceneError.
std::unique_ptr<Model> read_model(const nlohmann::json& model, const std::filesystem::path& scene_file,
                                  nlohmann::json& meshes);

}  // namespace ilaw::host
