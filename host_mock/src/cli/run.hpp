// run.hpp - `ilaw run`: a scene from JSON to results.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/exit_code.hpp"

#include <cstdint>
#include <filesystem>

namespace ilaw::host {

struct RunOptions {
  std::filesystem::path scene, folder;
  std::int64_t checkpoint_every = 0;  // steps; 0: never
  bool resume = false;
};

// Runs a scene and writes its results to folder; says on stderr what went wrong. Returns an ExitCode.
int run(const RunOptions& options);

}  // namespace ilaw::host
