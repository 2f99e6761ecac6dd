// convergence.hpp - errors of a scene for a sweep of time steps, or of meshes with them.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "scene/scene.hpp"
#include "study/errors.hpp"

#include <nlohmann/json.hpp>

#include <array>
#include <filesystem>
#include <vector>

namespace ilaw::host {

struct Sweep {
  int levels;
  double factor;
  double first;  // step (and element size) of level 0 over the scene's
  bool with_mesh;
};

struct ErrorTable {
  static constexpr std::array<const char*, 4> norms{"u_L2", "u_max", "v_L1", "instant"};

  std::vector<Trace> runs;
  std::vector<Errors> errors;  // one per run but, without exact solution, the finest
  bool exact = false;          // against the exact solution, not the finest run

  double error(std::size_t run, std::size_t norm) const;
  double order(std::size_t norm) const;  // by least squares; NaN where errors tell none
};

// Throws SceneError where the sweep makes no sense of the scene, before anything is run.
void check_sweep(const nlohmann::json& source, const Sweep& sweep, const std::filesystem::path& file);

// Runs all levels; says on stderr how far it is.
ErrorTable run_levels(const nlohmann::json& source, const Sweep& sweep, const std::filesystem::path& file);

}  // namespace ilaw::host
