// run.hpp - `ilaw run`: a scene from JSON to results.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

namespace ilaw::host {

// Exit codes of the program, as in its help.
enum ExitCode { exit_done = 0, exit_failed = 1, exit_bad_input = 2 };

// Runs a scene and writes its results to folder; says on stderr what went wrong. Returns an ExitCode.
int run(const std::filesystem::path& scene_file, const std::filesystem::path& folder);

}  // namespace ilaw::host
