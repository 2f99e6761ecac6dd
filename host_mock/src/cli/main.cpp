// The `ilaw` program.
// SPDX-License-Identifier: BSD-3-Clause
#include "cli/describe.hpp"
#include "cli/plot.hpp"
#include "cli/run.hpp"
#include "study/converge.hpp"

#include <CLI/CLI.hpp>

#include <omp.h>

#include <cstdint>
#include <cstdio>
#include <exception>
#include <string>
#include <vector>

namespace {

// Names what nobody knows first: CLI11 would only tell what is missing for it.
std::string usage_message(const CLI::App* app, const CLI::Error& error) {
  const CLI::App* command = app->get_subcommands().empty() ? app : app->get_subcommands().front();
  const std::string name = app->get_name() + (command == app ? "" : " " + command->get_name());
  const std::vector<std::string> unknown = app->remaining(true);
  std::string text = "ilaw: ";
  if (unknown.empty()) {
    text += error.what();
  } else {
    text += "found '" + unknown.front() + "', expected ";
    std::string known;
    for (const CLI::App* one : command->get_subcommands({}))
      known += (known.empty() ? "one of " : ", ") + one->get_name();
    for (const CLI::Option* one : command->get_options())
      if (!one->get_positional()) known += (known.empty() ? "one of " : ", ") + one->get_name();
    text += known;
  }
  return text + "\nRun `" + name + " --help` for more.\n";
}

}  // namespace

int main(int argc, char** argv) {
  using namespace ilaw::host;
  CLI::App app{
      "ilaw - interface laws in explicit dynamics: runs scenes, draws them, tells what laws there are"};
  app.set_version_flag("--version", "ilaw " ILAW_VERSION);
  app.name("ilaw");
  app.require_subcommand(1);
  app.failure_message(usage_message);
  app.footer(
      "Exit codes: 0 done; 1 the run failed (diverged, plugin error, interrupted); 2 bad usage or bad input, "
      "before\n"
      "anything ran.\nExample: ilaw run scene.json --out results && ilaw plot results");

  RunOptions options;
  int threads = 1;
  const auto add_threads = [&threads](CLI::App* command) {
    command->add_option("--threads", threads, "Threads; any number gives the same bits")
        ->check(CLI::Range(1, 1024))
        ->capture_default_str();
  };
  CLI::App* run_command = app.add_subcommand("run", "Run a scene and write history.csv and summary.json");
  run_command->add_option("scene", options.scene, "Scene file (JSON)")->required();
  run_command->add_option("--out", options.folder, "Folder for the results, made if it does not exist")
      ->required();
  run_command
      ->add_option("--checkpoint-every", options.checkpoint_every,
                   "Steps between checkpoints, from which --resume goes on")
      ->check(CLI::Range(std::int64_t{1}, std::int64_t{1'000'000'000'000'000}));
  run_command->add_flag("--resume", options.resume,
                        "Go on from the checkpoint in the folder, to the same bits");
  add_threads(run_command);
  run_command->footer("Example: ilaw run plugins/contact/bouncing_ball.json --out results");

  std::string results;
  CLI::App* plot_command =
      app.add_subcommand("plot", "Draw the history of a run: history.png and history.svg");
  plot_command->add_option("folder", results, "Folder that `ilaw run` wrote")->required();
  plot_command->footer("Example: ilaw plot results");

  ConvergeOptions sweep;
  CLI::App* converge_command = app.add_subcommand(
      "converge", "Run a scene with ever smaller steps (and meshes) and measure its errors and their order");
  converge_command->add_option("scene", sweep.scene, "Scene file (JSON)")->required();
  converge_command->add_option("--out", sweep.folder, "Folder for converge.csv, .json, .png and .svg")
      ->required();
  converge_command->add_option("--levels", sweep.levels, "Runs, the scene's own among them")
      ->check(CLI::Range(2, 12));
  converge_command->add_option("--factor", sweep.factor, "Refinement from run to run")
      ->check(CLI::Range(1.01, 10.0));
  converge_command->add_option("--refine", sweep.refine, "time, or mesh (with the time step)")
      ->check(CLI::IsMember({"time", "mesh"}));
  add_threads(converge_command);
  converge_command->footer("Example: ilaw converge host_mock/scenes/bar_on_wall.json --out results");

  CLI::App* list_command = app.add_subcommand("list", "List the laws on the search path");
  list_command->footer("Example: ILAW_PATH=$HOME/my_laws ilaw list");

  std::string law;
  bool as_json = false;
  CLI::App* describe_command =
      app.add_subcommand("describe", "Describe a law: parameters, state, references");
  describe_command->add_option("law", law, "Name of a law, or path of a library")->required();
  describe_command->add_flag("--json", as_json, "Print JSON");
  describe_command->footer("Example: ilaw describe coulomb --json");

  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? exit_done : exit_bad_input;
  }
  omp_set_num_threads(threads);
  try {
    if (run_command->parsed()) return run(options);
    if (plot_command->parsed()) return plot(results);
    if (converge_command->parsed()) return converge(sweep);
    return list_command->parsed() ? list_laws() : describe(law, as_json);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "ilaw: %s\n", error.what());
    return exit_failed;
  }
}
