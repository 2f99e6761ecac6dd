// SPDX-License-Identifier: BSD-3-Clause
#include "cli/run_table.hpp"

#include "base/csv.hpp"
#include "base/csv_file.hpp"
#include "base/scene_error.hpp"
#include "base/words.hpp"
#include "results/quantities.hpp"

#include <algorithm>
#include <fstream>
#include <map>
#include <optional>

namespace ilaw::host {
namespace {

using nlohmann::json;

std::string cell_text(const json& value) {
  if (value.is_null()) return "";
  std::string text = value.is_string() ? value.get<std::string>() : value.dump();
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c == ',' || c == '\n'; }, ';');
  return text;
}

std::optional<std::string> cell(const RunFolder& run, const std::string& column) {
  const std::map<std::string, json> numbers = numbers_of(run.summary);
  if (const auto found = numbers.find(column); found != numbers.end()) return cell_text(found->second);
  const std::optional<double> value = value_of(history_quantity(column), run.folder);
  if (!value) return std::nullopt;
  return cell_text(json(*value));
}

std::vector<std::string> all_columns(const std::vector<RunFolder>& runs) {
  std::vector<std::string> columns;
  for (const RunFolder& run : runs)
    for (const auto& [name, value] : numbers_of(run.summary))
      if (std::find(columns.begin(), columns.end(), name) == columns.end()) columns.push_back(name);
  return columns;
}

[[noreturn]] void refuse_column(const std::string& column, const std::vector<RunFolder>& runs) {
  const std::vector<std::string> of_history = CsvFile(runs.front().folder / "history.csv").names();
  std::vector<std::string> all = all_columns(runs);
  const std::string numbers = joined(all);
  all.insert(all.end(), of_history.begin(), of_history.end());
  throw InputError(column + ": found in no run, expected a number of summary.json, one of " + numbers +
                   "; or a column of history.csv, one of " + last_of(of_history) +
                   suggestion(column.substr(0, column.rfind(':')), all));
}

}  // namespace

std::string RunFolder::name() const { return folder.filename().string(); }

std::string RunFolder::said(const std::string& pointer) const {
  return cell_text(summary["scene"]["source"].value(json::json_pointer(pointer), json("-")));
}

RunFolder open_run(const std::filesystem::path& folder) {
  std::filesystem::path path = std::filesystem::absolute(folder).lexically_normal();
  if (!path.has_filename()) path = path.parent_path();
  std::ifstream stream(path / "summary.json");
  json summary = json::parse(stream, nullptr, false);
  if (!summary.is_object() || !summary.contains("/scene/source"_json_pointer))
    throw InputError((path / "summary.json").string() +
                     ": found no summary, expected that of a run in this folder: `ilaw run SCENE --out " +
                     folder.string() + "` writes it");
  return {path, std::move(summary)};
}

std::vector<RunFolder> open_runs(const std::vector<std::string>& folders) {
  std::vector<RunFolder> runs;
  for (const std::string& folder : folders)
    if (folders.size() == 1 || !std::filesystem::is_regular_file(folder)) runs.push_back(open_run(folder));
  if (runs.empty()) throw InputError("found files alone, expected folders that `ilaw run` wrote");
  return runs;
}

std::vector<std::string> differences(const std::vector<RunFolder>& runs) {
  std::vector<json> scenes;
  std::vector<std::string> pointers;
  scenes.reserve(runs.size());
  for (const RunFolder& run : runs) scenes.push_back(run.summary["scene"]["source"].flatten());
  for (const json& scene : scenes)
    for (const auto& [pointer, value] : scene.items()) {
      const bool differs =
          std::any_of(scenes.begin(), scenes.end(), [&key = pointer, &own = value](const json& other) {
            return !other.contains(key) || other[key] != own;
          });
      const bool is_text = pointer == "/title" || pointer == "/doc";
      if (differs && !is_text && std::find(pointers.begin(), pointers.end(), pointer) == pointers.end())
        pointers.push_back(pointer);
    }
  return pointers;
}

Rows table_of(const std::vector<RunFolder>& runs, const std::vector<std::string>& columns) {
  const std::vector<std::string> different = differences(runs);
  const std::vector<std::string> shown = columns.empty() ? all_columns(runs) : columns;
  Rows rows(1, {"run"});
  rows[0].insert(rows[0].end(), different.begin(), different.end());
  rows[0].insert(rows[0].end(), shown.begin(), shown.end());
  for (const RunFolder& run : runs) {
    std::vector<std::string>& row = rows.emplace_back(1, run.name());
    for (const std::string& pointer : different) row.push_back(run.said(pointer));
  }
  for (const std::string& column : shown) {
    bool found = false;
    for (std::size_t k = 0; k < runs.size(); ++k) {
      const std::optional<std::string> value = cell(runs[k], column);
      found = found || value;
      rows[k + 1].push_back(value.value_or(""));
    }
    if (!found) refuse_column(column, runs);
  }
  return rows;
}

void write_csv(std::ostream& out, const Rows& rows) {
  CsvWriter table(out);
  for (const auto& row : rows) {
    for (const std::string& text : row) table << text;
    table.end_row();
  }
}

}  // namespace ilaw::host
