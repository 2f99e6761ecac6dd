// convergence.hpp - errors of a scene for a sweep of time steps, or of meshes with them, and their files.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "scene/scene.hpp"
#include "study/errors.hpp"
#include "study/sweep.hpp"

#include <nlohmann/json.hpp>

#include <filesystem>
#include <string>
#include <vector>

namespace ilaw::host {

struct ErrorTable {
  std::vector<Trace> runs;
  std::vector<Errors> errors;  // one per run but, without exact solution, the finest
  bool exact = false;          // against the exact solution, not the finest run

  double order(std::size_t norm) const;  // by least squares; NaN where errors tell none
};

// Throws SceneError where the sweep makes no sense of the scene, before anything is run.
void check_sweep(const nlohmann::json& source, const Sweep& sweep, const std::filesystem::path& file);

// Runs all levels, and tells of steps.
ErrorTable run_levels(const nlohmann::json& source, const Sweep& sweep, const std::filesystem::path& file,
                      const Told& told);

// converge.csv with the errors, converge.json with their orders.
void write_convergence(const ErrorTable& table, const Sweep& sweep, const std::string& title,
                       const std::filesystem::path& folder);

}  // namespace ilaw::host
