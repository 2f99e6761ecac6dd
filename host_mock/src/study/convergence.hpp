// converge.hpp - `ilaw converge`: errors of a scene for a sweep of time steps, or of meshes with them.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace ilaw::host {

struct ConvergeOptions {
  std::filesystem::path scene, folder;
  // What the scene says under "converge", unless given here.
  std::optional<int> levels;
  std::optional<double> factor;
  std::optional<std::string> refine;  // "time" or "mesh"
};

// Writes converge.csv, converge.json (orders by least squares), converge.png and .svg. Returns an ExitCode.
int converge(const ConvergeOptions& options);

}  // namespace ilaw::host
