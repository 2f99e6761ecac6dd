// read_time.hpp - the time step of a scene, and the number of steps.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "scene/scene.hpp"

namespace ilaw::host {

// Into a scene whose model was read. Throws SceneError.
void read_time(const nlohmann::json& time, Scene& scene);

}  // namespace ilaw::host
