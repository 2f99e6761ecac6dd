// read_interface.hpp - an interface of a scene: its nodes, their counterpart, and the law.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "scene/scene.hpp"

#include <cstddef>
#include <memory>

namespace ilaw::host {

// The one with that number, of a scene whose model and loads were read. Throws SceneError.
std::unique_ptr<Interface> read_interface(std::size_t number, const Scene& scene);

}  // namespace ilaw::host
