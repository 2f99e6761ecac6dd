// `ilaw plot`, `view`, `table`, `converge` and `study`: modules of the Python package. Their options are
// declared for checks and help; Python reads them again.
// SPDX-License-Identifier: BSD-3-Clause
#include "check/command.hpp"
#include "check/progress.hpp"
#include "cli/commands.hpp"
#include "cli/python.hpp"

#include <memory>
#include <string>
#include <utility>

namespace ilaw::host {
namespace {

CLI::Option* add(CLI::App& command, const std::string& name, const char* type, const std::string& doc) {
  return command.add_option(name, doc)->type_name(type);
}

CLI::Option* add_list(CLI::App& command, const std::string& name, const std::string& doc) {
  return add(command, name, "TEXT", doc)->expected(CLI::detail::expected_max_vector_size);
}

// Options of converge and study.
void add_refinement(CLI::App& command, const std::string& levels, const CLI::Range& allowed) {
  const auto shared = std::make_shared<std::pair<int, check::ProgressForm>>(1, check::ProgressForm::line);
  add(command, "--levels", "INT", levels)->check(allowed);
  add(command, "--factor", "FLOAT", "Refinement from run to run")->check(check::within(1.01, 10.0));
  add(command, "--refine", "TEXT", "time, or mesh (with the time step)")
      ->check(CLI::IsMember({"time", "mesh"}));
  add_threads(command, shared->first);
  check::add_progress(command, shared->second);
  command.parse_complete_callback([shared] {});  // keeps what they are bound to
}

}  // namespace

void add_plot(CLI::App& app, int& /*code*/) {
  CLI::App& command = *app.add_subcommand(
      "plot", "Draw a run, several runs over each other, or what converge, study and bench measured");
  add_list(command, "folders", "Folders that run, converge, study or bench wrote")->required();
  add_list(command, "--panels", "Panels of one run, by the names on their left: gap,velocity,status")
      ->delimiter(',');
  add_list(command, "--y", "Columns of history.csv, a panel each")->delimiter(',');
  add(command, "--x", "TEXT", "Column of the abscissa")->default_str("time");
  add(command, "--out", "TEXT",
      "Existing folder for the picture (default: that of the run, or the one above several)");
  command.footer(
      "Writes .png and .svg.\n"
      "Example: ilaw plot results\n         ilaw plot results/* --y glue.F2,n50.u2");
  run_in_python(command, {"ilaw.plot", "numpy, matplotlib", "python3-numpy python3-matplotlib"});
}

void add_view(CLI::App& app, int& /*code*/) {
  CLI::App& command = *app.add_subcommand(
      "view", "Write a run as one HTML file: bodies in motion, fields, forces, curves, events");
  add(command, "folder", "TEXT", "Folder that `ilaw run` wrote")->required();
  add(command, "-o,--out", "TEXT", "File to write (default: view.html in the folder)");
  add(command, "--megabytes", "FLOAT",
      "About the most that the data take: first frames are left out, then nodes")
      ->check(check::within(0.01, 2000.0))
      ->default_str("50");
  command.footer(
      "The file opens in any browser and needs no network.\n"
      "Example: ilaw view results -o run.html");
  run_in_python(command, {"ilaw.view", "numpy, vtkmodules.vtkIOXML", "python3-numpy python3-vtk9"});
}

void add_table(CLI::App& app, int& /*code*/) {
  CLI::App& command = *app.add_subcommand("table", "Compare runs: a row each, with the keys that differ");
  add_list(command, "folders", "Folders that `ilaw run` wrote")->required();
  add_list(command, "--columns",
           "Numbers of the summary (energy.kinetic) or of the history (n0.u0:max; :last, :min, :mean)")
      ->delimiter(',');
  command.add_flag("--csv")->description("As comma-separated values");
  command.footer("Example: ilaw table results/* --columns steps,n0.u0:max");
  run_in_python(command, {"ilaw.table", "numpy", "python3-numpy"});
}

void add_converge(CLI::App& app, int& /*code*/) {
  CLI::App& command = *app.add_subcommand(
      "converge", "Run a scene at smaller and smaller steps (and meshes) and measure errors and their order");
  add(command, "scene", "TEXT", "Scene file (JSON)")->required();
  add(command, "--out", "TEXT", "Folder for converge.csv and .json, which `ilaw plot` draws")->required();
  add_refinement(command, "Number of runs, the scene's own included", CLI::Range(2, 12));
  command.footer("Example: ilaw converge host_mock/scenes/bar_on_wall.json --out errors");
  run_in_python(command, {"ilaw.converge", "numpy", "python3-numpy"});
}

void add_study(CLI::App& app, int& /*code*/) {
  CLI::App& command = *app.add_subcommand("study", "Compare laws in a scene: errors over steps and run time");
  add_list(command, "scenes", "Scene files (JSON)")->required();
  add(command, "--out", "TEXT",
      "Folder for study.csv, study_needed.csv and study.json; each of several scenes gets one in it")
      ->required();
  add_list(
      command, "--law",
      "Law instead of the scene's list: NAME, NAME:{parameters}, or an entry of the list in JSON; may be "
      "repeated")
      ->take_all()
      ->allow_extra_args(false);
  add_refinement(command, "Runs per law", CLI::Range(1, 30));
  add(command, "--repetitions", "INT", "Repetitions of each run, for the median of its times")
      ->check(CLI::Range(1, 1000));
  command.footer(
      "Example: ilaw study host_mock/scenes/bar_on_wall.json --out study\n"
      "         ilaw study scene.json --out study --law contact --law 'penalty:{\"stiffness\": 1e6}'");
  run_in_python(command, {"ilaw.study", "numpy", "python3-numpy"});
}

}  // namespace ilaw::host
