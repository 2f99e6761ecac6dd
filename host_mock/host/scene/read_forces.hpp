// read_forces.hpp - the resultants that a scene asks for.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "scene/scene.hpp"

#include <vector>

namespace ilaw::host {

// "/output/forces": names of interfaces, of loads, of springs, or of sets that motions drive. The
// rest of the scene has been read. Throws SceneError.
std::vector<ForceSetup> read_forces(const nlohmann::json& forces, const Scene& scene);

}  // namespace ilaw::host
