// `ilaw study`: laws side by side in a scene, run time against error.
// SPDX-License-Identifier: BSD-3-Clause
#include "cli/commands.hpp"

#include "base/exit_code.hpp"
#include "base/files.hpp"
#include "check/progress.hpp"
#include "cli/guard.hpp"
#include "cli/terminal.hpp"
#include "scene/scene.hpp"
#include "study/work_precision.hpp"

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace ilaw::host {
namespace {

using nlohmann::json;

struct StudyOptions {
  std::vector<std::filesystem::path> scenes;
  std::filesystem::path folder;
  std::vector<std::string> laws;
  SweepOptions sweep;
  check::ProgressForm progress = check::ProgressForm::line;
  std::optional<int> repetitions;  // what a scene says under "study", unless given
};

StudySetup setup_of(json& source, const StudyOptions& options) {
  StudySetup setup = read_study(source, options.laws);
  setup.sweep = options.sweep.over(setup.sweep);
  setup.repetitions = options.repetitions.value_or(setup.repetitions);
  return setup;
}

void print_runs(const Study& study) {
  std::vector<Row> rows{{"law", "largest stable step", "steps", "seconds", "penetration"}};
  for (const char* norm : norm_names) rows[0].emplace_back(norm);
  for (const LawRuns& law : study.laws)
    for (const MeasuredRun& run : law.runs) {
      const bool is_first = &run == &law.runs.front();
      rows.push_back({is_first ? law.name : "",
                      is_first ? (law.stable == law.tried ? ">= " : "") + text_of("%.3g", law.stable) : "",
                      std::to_string(run.steps), text_of("%.2g", run.seconds),
                      text_of("%.1e", run.penetration)});
      for (std::size_t n = 0; n < norm_names.size(); ++n)
        rows.back().push_back(text_of("%.2e", run.errors[n]));
      if (!run.failure.empty()) rows.back().push_back(run.failure);
    }
  print_rows(rows, "");
}

// The cost of an error u_L2: steps, and over those of the first law steps and run time.
void print_costs(const Study& study) {
  std::printf("\nsteps for an error u_L2 (over the first law's steps, run time over the first law's)\n");
  std::vector<Row> rows{{"law"}};
  for (const double error : wanted_errors) rows[0].push_back(text_of("%.0e", error));
  for (const LawRuns& law : study.laws) {
    rows.push_back({law.name});
    for (const double error : wanted_errors) {
      const Cost first = cost_of(study.laws[0].runs, norm_u_L2, error),
                 cost = cost_of(law.runs, norm_u_L2, error);
      std::string cell = text_of("%.0f", cost.steps);
      if (std::isfinite(cost.steps / first.steps))
        cell += " (" + text_of("%.2g", cost.steps / first.steps) + ", " +
                text_of("%.2g", cost.seconds / first.seconds) + ")";
      rows.back().push_back(cell);
    }
  }
  print_rows(rows, "");
}

int study_scene(const std::filesystem::path& file, const std::filesystem::path& folder,
                const StudyOptions& options) {
  json source = read_scene_source(file);
  const StudySetup setup = setup_of(source, options);
  const std::string title = source.value("title", file.stem().string());
  check_study(source, setup, file);  // before anything is written
  const HeldFolder held(folder);
  const Study study = [&] {
    check::Progress progress("study", "runs", 1.0, options.progress);
    return run_study(source, setup, file, [&](double done, double total) { progress.set(done, total); });
  }();
  remove_pictures(folder);
  write_study(study, title, folder);
  std::printf("%s, against the %s\n", printable(title).c_str(),
              study.exact ? "exact solution" : "finest run of the first law");
  print_runs(study);
  print_costs(study);
  return exit_done;
}

int study(const StudyOptions& options) {
  set_threads(1);  // those of the runs are made in their processes
  name_crashes();
  const std::filesystem::path folder = std::filesystem::absolute(options.folder).lexically_normal();
  const auto study_in = [&](const std::filesystem::path& scene, const std::filesystem::path& own) {
    return in_scene(scene, [&] { return study_scene(scene, own, options); });
  };
  if (options.scenes.size() == 1) return study_in(options.scenes[0], folder);
  // A folder for each.
  std::set<std::string> names;
  for (const std::filesystem::path& scene : options.scenes)
    if (!names.insert(scene.stem()).second)
      throw InputError("found two scenes called '" + scene.stem().string() +
                       "', expected a different name for each");
  const HeldFolder held(folder);
  for (const std::filesystem::path& scene : options.scenes)
    if (const int code = study_in(scene, folder / scene.stem()); code != exit_done) return code;
  return exit_done;
}

}  // namespace

void add_study(CLI::App& app, int& code) {
  const auto options = std::make_shared<StudyOptions>();
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
  add_sweep(*command, options->sweep, "Runs per law", CLI::Range(1, 30));
  check::add_progress(*command, options->progress);
  command
      ->add_option("--repetitions", options->repetitions,
                   "Repetitions of each run, for the median of its times")
      ->check(CLI::Range(1, 1000));
  command->footer(
      "Example: ilaw study host_mock/scenes/bar_on_wall.json --out results\n"
      "         ilaw study scene.json --out results --law contact --law 'penalty:{\"stiffness\": 1e6}'");
  command->callback([options, &code] { code = study(*options); });
}

}  // namespace ilaw::host
