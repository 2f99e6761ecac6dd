// run.hpp - one run of a scene into its folder, and runs with several values of its keys: `ilaw run`.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "check/progress.hpp"
#include "results/summary.hpp"
#include "scene/scene.hpp"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace ilaw::host {

struct RunOptions {
  std::filesystem::path scene, folder;
  std::int64_t checkpoint_every = 0;  // steps; 0: never
  bool resume = false;
  int threads = 1;
  std::optional<double> tolerance = {};  // of coupled contacts
  check::ProgressForm progress = check::ProgressForm::line;
  check::Progress* shared = nullptr;  // that of a sweep, which counts the steps of its runs
  bool tells_of_start = true;         // on stdout
  bool audits = false;                // each step (audit/audit.hpp)
};

// Runs a scene that was read into options.folder, which it makes and holds; says on stderr what goes wrong.
// Returns an ExitCode.
int run_scene(Scene& scene, const RunOptions& options);

// Says how a run ended, and gives its ExitCode. judged: its expectations, as judge_expectations gives them.
int report_run(const Scene& scene, const Integrator& integrator, const RunRecord& record,
               const nlohmann::json& judged, const RunOptions& options);

// settings: "/pointer=value,value,...". Every combination runs into a folder of its own in
// options.folder, options.threads at a time; sweep.csv there has a row for each. Nothing runs if
// one of them is refused. Returns an ExitCode.
int sweep(const RunOptions& options, const std::vector<std::string>& settings);

}  // namespace ilaw::host
