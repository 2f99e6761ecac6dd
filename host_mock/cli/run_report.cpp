// How `ilaw run` ends: in words and as an exit code.
// SPDX-License-Identifier: BSD-3-Clause
#include "cli/run.hpp"

#include "base/exit_code.hpp"
#include "cli/commands.hpp"
#include "cli/terminal.hpp"
#include "results/expectations.hpp"
#include "results/state_hash.hpp"

#include <cstdio>

namespace ilaw::host {
namespace {

// Of the expectations of a scene; a missed one is a complaint with its reason.
int report_judged(const Scene& scene, const nlohmann::json& judged) {
  int code = exit_done;
  for (const nlohmann::json& one : judged) {
    const std::string line = describe_judged(one);
    if (one["within"]) {
      std::printf("  %s\n", printable(line).c_str());
      continue;
    }
    complain(scene.file.string() + ": missed: " + line + "; " + one["because"].get<std::string>());
    code = exit_missed;
  }
  return code;
}

}  // namespace

int report_run(const Scene& scene, const Integrator& integrator, const RunRecord& record,
               const nlohmann::json& judged, const RunOptions& options) {
  const std::filesystem::path& folder = options.folder;
  const std::string file = scene.file.string(), steps = std::to_string(integrator.steps());
  if (!record.failure.empty()) {
    complain(file + ": failed after step " + steps + ", time " + text_of("%g", integrator.time()) + ": " +
             record.failure);
    return exit_failed;
  }
  if (record.interrupted) {
    complain(file + ": interrupted at step " + steps + " of " + std::to_string(scene.steps) +
             "; the files in " + folder.string() + " are whole up to there" +
             (options.checkpoint_every > 0 ? ", and --resume goes on from there" : ""));
    return exit_failed;
  }
  std::printf(
      "%s: %lld steps to time %g in %.2g s, energy balance closed to %.1e, state %s%s; results in %s\n",
      printable(scene.title).c_str(), static_cast<long long>(integrator.steps()), integrator.time(),
      record.seconds_total, integrator.energy().balance_error, state_hash(scene, integrator).c_str(),
      scene.warnings.empty() && record.warnings.empty() ? "" : ", with warnings", folder.c_str());
  return report_judged(scene, judged);
}

}  // namespace ilaw::host
