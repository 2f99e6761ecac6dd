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

// "--y=a,b"; nothing without words.
void add_list(std::vector<std::string>& arguments, const std::string& option,
              const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? option + "=" : ",") + word;
  if (!words.empty()) arguments.push_back(text);
}

void plot(const PlotOptions& options) {
  std::vector<std::string> arguments = {"--x=" + options.x};
  add_list(arguments, "--panels", options.panels);
  add_list(arguments, "--y", options.y);
  if (!options.out.empty()) arguments.push_back("--out=" + options.out);
  arguments.emplace_back("--");
  arguments.insert(arguments.end(), options.folders.begin(), options.folders.end());
  run_python("ilaw.plot", arguments, "numpy, matplotlib", "python3-numpy python3-matplotlib");
}

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
  command->callback([options] { plot(*options); });
}

}  // namespace ilaw::host
