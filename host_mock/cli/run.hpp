// run.hpp - one run of a scene into its folder: `ilaw run`.
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
  std::filesystem::path
      text;  // file with the text of the scene, where a command has changed it; empty: scene
  std::int64_t checkpoint_every = 0;  // steps; 0: never
  bool resume = false;
  int threads = 1;
  std::optional<double> tolerance = {};  // of coupled contacts
  check::ProgressForm progress = check::ProgressForm::line;
  bool audits = false;                // each step (audit/audit.hpp)
  std::vector<std::string> settings;  // of --set, which ilaw.sweep reads
};

// Says how a run ended, and gives its ExitCode. judged: its expectations, as judge_expectations gives them.
int report_run(const Scene& scene, const Integrator& integrator, const RunRecord& record,
               const nlohmann::json& judged, const RunOptions& options);

}  // namespace ilaw::host
