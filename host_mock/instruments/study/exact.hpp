// exact.hpp - solutions in closed form of some scenes, to measure errors against. Derivations: the
// `doc` of each scene.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "scene/scene.hpp"

#include <functional>
#include <limits>
#include <vector>

namespace ilaw::host {

// Instants of a contact, NaN where there is none.
struct ContactInstants {
  static constexpr double none = std::numeric_limits<double>::quiet_NaN();
  double first_impulse = none, last_impulse = none, last_rupture = none;
};

// One degree of freedom of a watched node: displacement and velocity in time.
struct ExactNode {
  std::function<double(double)> displacement, velocity;
  ContactInstants instants{};
  // The impulse that the interface has given so far, where it is the node of an interface, and the
  // work that it did, which of a vector the first component tells with the largest energy of the
  // motion. Empty where that is not known.
  std::function<double(double)> impulse{}, work{};
  double energy = 0.0;
};

// One per component of every watched node, in the order of the scene; empty where the scene names no
// exact solution.
// Throws SceneError where the scene is not one that the named solution covers.
std::vector<ExactNode> exact_solution(const Scene& scene);

}  // namespace ilaw::host
