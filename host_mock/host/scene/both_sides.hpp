// both_sides.hpp - an interface against a surface from both sides, as the two interfaces that it stands for.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nlohmann/json.hpp>

namespace ilaw::host {

// Replaces "both_sides" in a scene: a second interface, at the end of the list, has the nodes of the surface
// against the surface of the nodes, and each bears half of its tributary areas.
void expand_both_sides(nlohmann::json& scene);

}  // namespace ilaw::host
