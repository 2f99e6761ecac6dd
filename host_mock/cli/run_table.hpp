// run_table.hpp - several runs side by side: what differs between their scenes, and what came of it.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nlohmann/json.hpp>

#include <filesystem>
#include <ostream>
#include <string>
#include <vector>

namespace ilaw::host {

// The folder of a run, as its summary tells it.
struct RunFolder {
  std::filesystem::path folder;
  nlohmann::json summary;

  std::string name() const;
  // The value that the scene has at a JSON pointer, in words.
  std::string said(const std::string& pointer) const;
};

// Throws InputError where the folder has no summary.
RunFolder open_run(const std::filesystem::path& folder);
// The runs of all folders. Files among them, as a sweep and its pictures leave beside its runs, are passed
// over.
std::vector<RunFolder> open_runs(const std::vector<std::string>& folders);

// JSON pointers of the scenes' numbers and words that are not the same in all runs.
std::vector<std::string> differences(const std::vector<RunFolder>& runs);

// A row per run: its name, what differs, then the columns: numbers of the summary (energy.kinetic),
// or of the history (n0.u0:max; :last, :min, :max, :mean, last where none is given). Without
// columns all numbers of the summary. Throws InputError for a column that no run has.
using Rows = std::vector<std::vector<std::string>>;
Rows table_of(const std::vector<RunFolder>& runs, const std::vector<std::string>& columns);

void write_csv(std::ostream& out, const Rows& rows);

}  // namespace ilaw::host
