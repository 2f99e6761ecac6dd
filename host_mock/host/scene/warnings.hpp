// warnings.hpp - what a scene can run with, but can hardly mean.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "scene/scene.hpp"

namespace ilaw::host {

// Adds to the warnings of a scene that was read.
void add_warnings(Scene& scene);

}  // namespace ilaw::host
