// `ilaw table`: several runs side by side, in numbers, by the Python module ilaw.table.
// SPDX-License-Identifier: BSD-3-Clause
#include "cli/commands.hpp"

#include "cli/python.hpp"

namespace ilaw::host {
namespace {

struct TableOptions {
  std::vector<std::string> folders, columns;
  bool csv = false;
};

}  // namespace

void add_table(CLI::App& app, int& /*code*/) {
  const auto options = std::make_shared<TableOptions>();
  CLI::App* command = app.add_subcommand("table", "Compare runs: a row each, with the keys that differ");
  command->add_option("folders", options->folders, "Folders that `ilaw run` wrote")->required();
  command
      ->add_option(
          "--columns", options->columns,
          "Numbers of the summary (energy.kinetic) or of the history (n0.u0:max; :last, :min, :mean)")
      ->delimiter(',');
  command->add_flag("--csv", options->csv, "As comma-separated values");
  command->footer("Example: ilaw table results/* --columns steps,n0.u0:max");
  run_in_python(*command, {"ilaw.table", "numpy", "python3-numpy"}, options);
}

}  // namespace ilaw::host
