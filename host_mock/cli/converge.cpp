// `ilaw converge`: errors of a scene and their orders.
// SPDX-License-Identifier: BSD-3-Clause
#include "cli/commands.hpp"

#include "base/exit_code.hpp"
#include "base/files.hpp"
#include "check/progress.hpp"
#include "cli/guard.hpp"
#include "study/convergence.hpp"

#include <cstdio>
#include <filesystem>
#include <string>

namespace ilaw::host {
namespace {

using nlohmann::json;

struct ConvergeOptions {
  std::filesystem::path scene, folder;
  SweepOptions sweep;
  check::ProgressForm progress = check::ProgressForm::line;
};

// A number in ten columns.
void print(const char* format, double value) {
  const std::string text = text_of(format, value);
  std::printf(" %10s", text == "-0.00" ? "0.00" : text.c_str());
}

void print_table(const ErrorTable& table) {
  std::printf("%12s %10s", "dt", "seconds");
  for (const char* norm : norm_names) std::printf(" %10s", norm);
  std::printf("\n");
  for (std::size_t k = 0; k < table.errors.size(); ++k) {
    std::printf("%12.4g %10.2g", table.runs[k].dt, table.runs[k].seconds);
    for (std::size_t n = 0; n < norm_names.size(); ++n) print("%.2e", table.errors[k][n]);
    std::printf("\n");
  }
  std::printf("%23s", "order");
  for (std::size_t n = 0; n < norm_names.size(); ++n) print("%.2f", table.order(n));
  std::printf("\n");
}

int converge(const ConvergeOptions& options) {
  set_threads(1);  // those of the runs are made in their processes
  name_crashes();
  const std::filesystem::path folder = std::filesystem::absolute(options.folder).lexically_normal();
  const json source = read_scene_source(options.scene);
  const Sweep sweep = options.sweep.over(read_sweep(source.value("converge", json::object())));
  const std::string title = source.value("title", options.scene.stem().string());
  check_sweep(source, sweep, options.scene);  // before anything is written
  const HeldFolder held(folder);
  const ErrorTable table = [&] {
    check::Progress progress("converge", "steps", 1.0, options.progress);
    return run_levels(source, sweep, options.scene,
                      [&](double done, double total) { progress.set(done, total); });
  }();
  remove_pictures(folder);
  write_convergence(table, sweep, title, folder);
  print_table(table);
  return exit_done;
}

}  // namespace

void add_converge(CLI::App& app, int& code) {
  const auto options = std::make_shared<ConvergeOptions>();
  CLI::App* command = app.add_subcommand(
      "converge", "Run a scene at smaller and smaller steps (and meshes) and measure errors and their order");
  command->add_option("scene", options->scene, "Scene file (JSON)")->required();
  command->add_option("--out", options->folder, "Folder for converge.csv and .json, which `ilaw plot` draws")
      ->required();
  add_sweep(*command, options->sweep, "Number of runs, the scene's own included", CLI::Range(2, 12));
  check::add_progress(*command, options->progress);
  command->footer("Example: ilaw converge host_mock/scenes/bar_on_wall.json --out results");
  command->callback(
      [options, &code] { code = in_scene(options->scene, [&] { return converge(*options); }); });
}

}  // namespace ilaw::host
