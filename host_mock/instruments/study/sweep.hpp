// sweep.hpp - the same scene with ever smaller steps, or meshes and steps.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nlohmann/json.hpp>

#include <cmath>
#include <functional>
#include <string>

namespace ilaw::host {

struct Sweep {
  int levels;
  double factor;
  double first;  // step (and element size) of level 0 over the scene's
  bool with_mesh;
  int threads = 1;  // of each run

  // How many times smaller than the scene's.
  double refinement(int level) const { return std::pow(factor, level) / first; }
};

// Is told how much work is done, and an estimate of all.
using Told = std::function<void(double done, double total)>;

// The keys of "converge" or "study" in a scene.
Sweep read_sweep(const nlohmann::json& given);

// The scene with smaller steps, and elements where the mesh goes with them.
nlohmann::json refined(const nlohmann::json& source, const Sweep& sweep, double refinement);

// Throws SceneError where a mesh is to be refined and the model has none, or the scene names nodes
// by number, which a refined mesh gives to others. pointer: to what the scene says of the sweep.
void check_mesh(const nlohmann::json& source, const Sweep& sweep, const std::string& pointer);

}  // namespace ilaw::host
