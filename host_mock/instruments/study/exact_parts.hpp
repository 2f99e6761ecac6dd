// exact_parts.hpp - parts of exact solutions, and the solutions of elastic bars on walls, on planes, on each
// other, glued, and of a point under the Post-it law. Derivations: the `doc` of each scene.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "study/exact.hpp"

#include <nlohmann/json.hpp>

#include <string>
#include <vector>

namespace ilaw::host {

// Throws SceneError where a solution does not cover the scene.
void require(bool good, const std::string& expected);

// A scene of one body: that, and what its solution depends on.
struct OneBody {
  const nlohmann::json &model, &body, &interface;  // interface: the first one
  nlohmann::json loads, parameters;
};
// kind: "points" or "bars".
OneBody one_body(const Scene& scene, const char* kind, const std::string& wanted);

struct Motion1D {
  double displacement, velocity;
};
ExactNode node_of(const std::function<Motion1D(double)>& motion);

// Velocity that is constant between instants; displacement is its integral from 0.
ExactNode piecewise(const std::vector<double>& instants, const std::vector<double>& velocities);

ExactNode bar_on_wall(const Scene& scene);
ExactNode bouncing_bar(const Scene& scene);
ExactNode held_rod(const Scene& scene);
ExactNode glued_bar(const Scene& scene);
std::vector<ExactNode> two_bars(const Scene& scene);

// In one dimension, from rest on the plane, moved by a force that never pushes and by shocks of
// either sign. Rupture is brittle.
struct PostitPoint {
  struct Knot {
    double time, force;  // linear between knots, constant outside
  };
  struct Shock {
    double time, impulse;
  };
  double mass;
  std::vector<Knot> knots;    // at least one, in the order of time
  std::vector<Shock> shocks;  // in the order of time
  double initial_adhesion, adhesion_limit, efficiency_decrease, memory;
  double end;
};

ExactNode postit_motion(const PostitPoint& point);

}  // namespace ilaw::host
