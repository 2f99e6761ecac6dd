// `ilaw plot`: the history of a run as a picture, drawn by gnuplot.
// SPDX-License-Identifier: BSD-3-Clause
#include "cli/commands.hpp"

#include "base/csv.hpp"
#include "base/exit_code.hpp"
#include "cli/terminal.hpp"
#include "results/gnuplot.hpp"
#include "results/picture.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <system_error>
#include <vector>

namespace ilaw::host {
namespace {

Columns read_columns(const std::filesystem::path& history) {
  std::ifstream stream(history);
  std::string line;
  std::getline(stream, line);
  Columns columns{csv_cells(line), {}, {}};
  columns.all_zero.assign(columns.names.size(), true);
  while (std::getline(stream, line)) {
    const std::vector<std::string> cells = csv_cells(line);
    for (std::size_t k = 0; k < std::min(cells.size(), columns.names.size()); ++k) {
      const double value = std::strtod(cells[k].c_str(), nullptr);
      if (value != 0.0) columns.all_zero[k] = false;
      if (columns.names[k].ends_with(".status")) columns.statuses.insert(static_cast<int>(value));
    }
  }
  return columns;
}

// What the summary tells about the history; a folder without a summary is drawn all the same.
Caption read_caption(const std::filesystem::path& folder) {
  std::ifstream stream(folder / "summary.json");
  const nlohmann::json summary = nlohmann::json::parse(stream, nullptr, false);
  if (!summary.is_object()) return {folder.filename().string(), 0};
  const auto value = [&](const char* pointer, auto otherwise) {
    return summary.value(nlohmann::json::json_pointer(pointer), otherwise);
  };
  return {value("/scene/title", folder.filename().string()), value("/scene/source/output/every", 1)};
}

int refuse(const std::filesystem::path& history, const char* found) {
  complain(history.string() + ": found " + found +
           ", expected the history that `ilaw run` writes of watched nodes");
  return exit_bad_input;
}

// Reads history.csv and summary.json of a run's folder and writes history.png and history.svg
// beside them.
int plot(const std::filesystem::path& results) {
  // gnuplot takes file names that begin with < or | for commands: an absolute path never does.
  const std::filesystem::path folder = std::filesystem::absolute(results).lexically_normal();
  const std::filesystem::path history = folder / "history.csv";
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(history, error);
  if (status.type() == std::filesystem::file_type::not_found) return refuse(history, "no such file");
  if (!std::filesystem::is_regular_file(status))
    return refuse(history, error ? error.message().c_str() : "something that is no file");
  const Columns columns = read_columns(history);
  if (columns.names.size() < 2) return refuse(history, "no column besides time");

  const Caption caption = read_caption(folder);
  if (!draw_by_gnuplot(folder / "history.gnuplot",
                       [&](std::ostream& script) { write_picture(script, folder, columns, caption); }))
    return exit_failed;
  std::printf("%s\n%s\n", (results / "history.png").c_str(), (results / "history.svg").c_str());
  return exit_done;
}

}  // namespace

void add_plot(CLI::App& app, Action& chosen) {
  const auto results = std::make_shared<std::string>();
  CLI::App* command = app.add_subcommand("plot", "Draw the history of a run: history.png and history.svg");
  command->add_option("folder", *results, "Folder that `ilaw run` wrote")->required();
  command->footer("Example: ilaw plot results");
  command->callback([results, &chosen] { chosen = [results] { return plot(*results); }; });
}

}  // namespace ilaw::host
