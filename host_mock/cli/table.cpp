// `ilaw table`: several runs side by side, in numbers.
// SPDX-License-Identifier: BSD-3-Clause
#include "cli/commands.hpp"

#include "base/exit_code.hpp"
#include "cli/run_table.hpp"

#include <iostream>

namespace ilaw::host {
namespace {

struct TableOptions {
  std::vector<std::string> folders, columns;
  bool csv = false;
};

// Many columns are read more easily below each other.
Rows transposed(const Rows& rows) {
  Rows columns(rows.front().size());
  for (const auto& row : rows)
    for (std::size_t k = 0; k < row.size(); ++k) columns[k].push_back(row[k]);
  return columns;
}

int table(const TableOptions& options) {
  const std::vector<RunFolder> runs = open_runs(options.folders);
  const Rows rows = table_of(runs, options.columns);
  if (options.csv)
    write_csv(std::cout, rows);
  else
    print_rows(options.columns.empty() ? transposed(rows) : rows, "");
  return exit_done;
}

}  // namespace

void add_table(CLI::App& app, int& code) {
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
  command->callback([options, &code] { code = table(*options); });
}

}  // namespace ilaw::host
