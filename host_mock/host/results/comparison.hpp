// comparison.hpp - columns of one or several histories in one picture, over time or over another
// column, as a script for gnuplot.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "results/run_table.hpp"

#include <filesystem>
#include <ostream>
#include <string>
#include <vector>

namespace ilaw::host {

struct ComparisonSetup {
  std::string x;               // a column, "time" for instance
  std::vector<std::string> y;  // a panel each
};

// Panels that a picture of several runs has where none are asked for.
constexpr std::size_t most_panels = 12;

// The columns that all runs have and that are not zero throughout: forces and energies first, then
// motion.
std::vector<std::string> comparable_columns(const std::vector<RunFolder>& runs);

// A legend per run: what differs between their scenes, or its name.
std::vector<std::string> legends_of(const std::vector<RunFolder>& runs);

// A script that draws picture.png and .svg; picture: an absolute path without extension. Every run
// has all columns.
void write_comparison(std::ostream& script, const std::filesystem::path& picture,
                      const std::vector<RunFolder>& runs, const ComparisonSetup& setup);

}  // namespace ilaw::host
