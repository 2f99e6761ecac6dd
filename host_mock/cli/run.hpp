// run.hpp - one run of a scene into its folder, alone or as part of a sweep.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "scene/scene.hpp"

#include <cstdint>
#include <filesystem>

namespace ilaw::host {

struct RunOptions {
  std::filesystem::path scene, folder;
  std::int64_t checkpoint_every = 0;  // steps; 0: never
  bool resume = false;
  int threads = 1;
  bool shows_progress = true;
  bool tells_of_start = true;  // on stdout
};

// Runs a scene that was read into options.folder, which it makes and holds; says on stderr what goes wrong.
// Returns an ExitCode.
int run_scene(Scene& scene, const RunOptions& options);

}  // namespace ilaw::host
