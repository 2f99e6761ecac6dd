// `ilaw plot`: runs as pictures, drawn by gnuplot: the history of one, or several in comparison.
// SPDX-License-Identifier: BSD-3-Clause
#include "cli/commands.hpp"

#include "base/exit_code.hpp"
#include "base/words.hpp"
#include "cli/terminal.hpp"
#include "plot/comparison.hpp"
#include "plot/history_file.hpp"
#include "plot/picture.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>
#include <system_error>
#include <vector>

namespace ilaw::host {
namespace {

struct PlotOptions {
  std::vector<std::string> folders, y, panels;
  std::string x = "time", out;
};

Columns read_columns(const std::filesystem::path& file) {
  HistoryFile history(file);
  Columns columns{history.names(), {}, {}};
  columns.all_zero.assign(columns.names.size(), true);
  for (std::vector<double> row; history.next(row);)
    for (std::size_t k = 0; k < row.size(); ++k) {
      if (row[k] != 0.0) columns.all_zero[k] = false;
      if (columns.names[k].ends_with(".status")) ++columns.statuses[static_cast<int>(row[k])];
    }
  return columns;
}

// Reads the caption from the summary; a folder without one is drawn all the same.
Caption read_caption(const std::filesystem::path& folder) {
  std::ifstream stream(folder / "summary.json");
  const nlohmann::json summary = nlohmann::json::parse(stream, nullptr, false);
  if (!summary.is_object()) return {folder.filename().string(), 0};
  const auto value = [&](const char* pointer, auto otherwise) {
    return summary.value(nlohmann::json::json_pointer(pointer), otherwise);
  };
  return {value("/scene/title", folder.filename().string()), value("/scene/source/output/every", 1)};
}

void check_panels(const std::vector<std::string>& wanted, const std::vector<std::string>& names) {
  for (const std::string& panel : wanted)
    if (std::find(names.begin(), names.end(), panel) == names.end())
      throw InputError("--panels: found '" + panel + "', expected some of " + joined(names) +
                       suggestion(panel, names));
}

[[noreturn]] void refuse(const std::filesystem::path& history, const std::string& found) {
  const std::string folder = history.parent_path().string();
  if (std::filesystem::is_regular_file(folder))
    throw InputError(folder + ": found a file, expected a folder that `ilaw run SCENE --out FOLDER` wrote");
  throw InputError(history.string() + ": found " + found +
                   ", expected the history of watched nodes that `ilaw run SCENE --out " + folder +
                   "` writes");
}

// Reads history.csv and summary.json of a run's folder and writes history.png and history.svg,
// beside them if nothing else is asked for.
int plot_history(const PlotOptions& options) {
  const std::filesystem::path results = options.folders.front();
  // gnuplot takes file names that begin with < or | for commands: an absolute path never does.
  const std::filesystem::path folder = std::filesystem::absolute(results).lexically_normal();
  const std::filesystem::path history = folder / "history.csv";
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(history, error);
  if (status.type() == std::filesystem::file_type::not_found) refuse(history, "no such file");
  if (!std::filesystem::is_regular_file(status))
    refuse(history, error ? error.message() : "something that is no file");
  const Columns columns = read_columns(history);
  if (columns.names.size() < 2) refuse(history, "no column besides time");

  Caption caption = read_caption(folder);
  caption.panels = options.panels;
  check_panels(caption.panels, panel_names(columns, caption.every));
  const std::filesystem::path drawn = options.out.empty() ? results : std::filesystem::path(options.out);
  const std::filesystem::path pictures = std::filesystem::absolute(drawn).lexically_normal();
  if (!draw_picture(folder, pictures, columns, caption)) return exit_failed;
  std::printf("%s\n%s\n", (drawn / "history.png").c_str(), (drawn / "history.svg").c_str());
  return exit_done;
}

void check_columns(const std::vector<RunFolder>& runs, const std::vector<std::string>& columns) {
  for (const RunFolder& run : runs) {
    const HistoryFile history(run.folder / "history.csv");
    for (const std::string& column : columns)
      if (!history.index_of(column))
        throw InputError((run.folder / "history.csv").string() + ": found no column '" + column +
                         "', expected one of " + last_of(history.names()) +
                         suggestion(column, history.names()));
  }
}

// The name of the picture: comparison, or its columns.
std::string picture_name(const PlotOptions& options) {
  if (options.y.empty()) return "comparison";
  std::string name;
  for (const std::string& column : options.y) name += (name.empty() ? "" : "_") + column;
  return name + "_over_" + options.x;
}

int plot_columns(const PlotOptions& options) {
  const std::vector<RunFolder> runs = open_runs(options.folders);
  ComparisonSetup setup{options.x, options.y};
  if (setup.y.empty()) setup.y = comparable_columns(runs);
  if (setup.y.empty()) throw InputError("found no columns that all runs have");
  check_columns(runs, setup.y);
  check_columns(runs, {setup.x});
  if (options.y.empty() && setup.y.size() > most_panels) {
    complain(std::to_string(setup.y.size() - most_panels) + " columns are left out; --y chooses");
    setup.y.resize(most_panels);
  }
  const std::filesystem::path first = runs.front().folder;
  const std::filesystem::path folder = !options.out.empty() ? std::filesystem::absolute(options.out)
                                       : runs.size() > 1    ? first.parent_path()
                                                            : first;
  const std::string picture = (folder / picture_name(options)).string();
  if (!draw_comparison(picture, runs, setup)) return exit_failed;
  std::printf("%s.png\n%s.svg\n", picture.c_str(), picture.c_str());
  return exit_done;
}

int plot(const PlotOptions& options) {
  std::error_code ignored;
  if (!options.out.empty() && !std::filesystem::is_directory(options.out, ignored))
    throw InputError("--out " + options.out + ": found no such folder, expected one that exists");
  const bool history = options.folders.size() == 1 && options.y.empty() && options.x == "time";
  if (history) return plot_history(options);
  if (options.panels.empty()) return plot_columns(options);
  throw InputError(
      "--panels: found with several folders or --x, expected one folder; --y chooses columns there");
}

}  // namespace

void add_plot(CLI::App& app, int& code) {
  const auto options = std::make_shared<PlotOptions>();
  CLI::App* command =
      app.add_subcommand("plot", "Draw the history of a run, or several runs over each other: .png and .svg");
  command->add_option("folders", options->folders, "Folders that `ilaw run` wrote")->required();
  command
      ->add_option("--panels", options->panels,
                   "Panels of one run, by the names on their left: gap,velocity,status")
      ->delimiter(',');
  command->add_option("--y", options->y, "Columns of history.csv, a panel each")->delimiter(',');
  command->add_option("--x", options->x, "Column of the abscissa")->capture_default_str();
  command->add_option("--out", options->out,
                      "Existing folder for the picture (default: that of the run, or the one above several)");
  command->footer("Example: ilaw plot results\n         ilaw plot results/* --y glue.F2,n50.u2");
  command->callback([options, &code] { code = plot(*options); });
}

}  // namespace ilaw::host
