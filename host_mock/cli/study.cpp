// `ilaw converge` and `ilaw study`: errors of a scene at smaller and smaller steps, and of laws side by side,
// by the Python modules ilaw.converge and ilaw.study.
// SPDX-License-Identifier: BSD-3-Clause
#include "check/progress.hpp"
#include "cli/commands.hpp"
#include "cli/python.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace ilaw::host {
namespace {

// For the checks and the help; Python reads them again.
struct SweepOptions {
  std::vector<std::filesystem::path> scenes;
  std::filesystem::path scene, folder;
  std::vector<std::string> laws;
  int levels = 0, threads = 1, repetitions = 0;
  double factor = 0.0;
  std::string refine;
  check::ProgressForm progress = check::ProgressForm::line;
};

void add_sweep(CLI::App& command, SweepOptions& options, const std::string& levels,
               const CLI::Range& allowed) {
  command.add_option("--levels", options.levels, levels)->check(allowed);
  command.add_option("--factor", options.factor, "Refinement from run to run")
      ->check(number_from(1.01, 10.0));
  command.add_option("--refine", options.refine, "time, or mesh (with the time step)")
      ->check(CLI::IsMember({"time", "mesh"}));
  add_threads(command, options.threads);
  check::add_progress(command, options.progress);
}

}  // namespace

void add_converge(CLI::App& app, int& /*code*/) {
  const auto options = std::make_shared<SweepOptions>();
  CLI::App* command = app.add_subcommand(
      "converge", "Run a scene at smaller and smaller steps (and meshes) and measure errors and their order");
  command->add_option("scene", options->scene, "Scene file (JSON)")->required();
  command->add_option("--out", options->folder, "Folder for converge.csv and .json, which `ilaw plot` draws")
      ->required();
  add_sweep(*command, *options, "Number of runs, the scene's own included", CLI::Range(2, 12));
  command->footer("Example: ilaw converge host_mock/scenes/bar_on_wall.json --out errors");
  run_in_python(*command, {"ilaw.converge", "numpy", "python3-numpy"}, options);
}

void add_study(CLI::App& app, int& /*code*/) {
  const auto options = std::make_shared<SweepOptions>();
  CLI::App* command = app.add_subcommand("study", "Compare laws in a scene: errors over steps and run time");
  command->add_option("scenes", options->scenes, "Scene files (JSON)")->required();
  command
      ->add_option("--out", options->folder,
                   "Folder for study.csv, study_needed.csv and study.json; each of several scenes gets one "
                   "in it")
      ->required();
  command
      ->add_option(
          "--law", options->laws,
          "Law instead of the scene's list: NAME, NAME:{parameters}, or an entry of the list in JSON; may be "
          "repeated")
      ->take_all()
      ->allow_extra_args(false);
  add_sweep(*command, *options, "Runs per law", CLI::Range(1, 30));
  command
      ->add_option("--repetitions", options->repetitions,
                   "Repetitions of each run, for the median of its times")
      ->check(CLI::Range(1, 1000));
  command->footer(
      "Example: ilaw study host_mock/scenes/bar_on_wall.json --out study\n"
      "         ilaw study scene.json --out study --law contact --law 'penalty:{\"stiffness\": 1e6}'");
  run_in_python(*command, {"ilaw.study", "numpy", "python3-numpy"}, options);
}

}  // namespace ilaw::host
