// random_parts.hpp - parts of a random scene: parameters of a law, and what moves and meets beside free
// bodies and obstacles at rest: obstacles that turn and follow paths, second bodies, and nodes that are
// driven.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "stress/draw.hpp"

#include <ilaw/ilaw.h>

#include <nlohmann/json.hpp>

namespace ilaw::host {

// Parameters as a scene gives them, drawn from what the law says of itself. Times are drawn around the time
// step dt.
nlohmann::json random_parameters(const ilaw_law& law, double dt, Draw& draw);

// The figures that a scene of one body was drawn for.
struct DrawnScene {
  int dimension;
  double step;  // near the one that it will take
  double end;
};

// A path, or a turning, or both, where a scene may have them.
void set_in_motion(nlohmann::json& obstacle, const DrawnScene& drawn, Draw& draw);

// Gives the first interface a second body, or another node of the same points, in place of its obstacle.
// Returns the nodes of that body that may meet something else; null where there is none to be had.
nlohmann::json join_a_body(nlohmann::json& scene, const DrawnScene& drawn, Draw& draw);

// Nodes that no interface has follow a path, or are held: an end of a bar, a face of a block, or the far end
// of a spring to a point.
void drive_nodes(nlohmann::json& scene, const DrawnScene& drawn, Draw& draw);

}  // namespace ilaw::host
