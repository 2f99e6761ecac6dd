// `ilaw plot`: results as pictures, drawn by the Python module ilaw.plot.
// SPDX-License-Identifier: BSD-3-Clause
#include "cli/commands.hpp"

#include "cli/python.hpp"

#include <string>
#include <vector>

namespace ilaw::host {
namespace {

struct PlotOptions {
  std::vector<std::string> folders, panels, y;
  std::string x = "time", out;
};

}  // namespace

void add_plot(CLI::App& app, int& /*code*/) {
  const auto options = std::make_shared<PlotOptions>();
  CLI::App* command = app.add_subcommand(
      "plot", "Draw a run, several runs over each other, or what converge, study and bench measured");
  command->add_option("folders", options->folders, "Folders that run, converge, study or bench wrote")
      ->required();
  command
      ->add_option("--panels", options->panels,
                   "Panels of one run, by the names on their left: gap,velocity,status")
      ->delimiter(',');
  command->add_option("--y", options->y, "Columns of history.csv, a panel each")->delimiter(',');
  command->add_option("--x", options->x, "Column of the abscissa")->capture_default_str();
  command->add_option("--out", options->out,
                      "Existing folder for the picture (default: that of the run, or the one above several)");
  command->footer(
      "Writes .png and .svg.\n"
      "Example: ilaw plot results\n         ilaw plot results/* --y glue.F2,n50.u2");
  run_in_python(*command, {"ilaw.plot", "numpy, matplotlib", "python3-numpy python3-matplotlib"}, options);
}

}  // namespace ilaw::host
