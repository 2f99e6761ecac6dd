// comparison.hpp - columns of one or several histories in one picture, over time or over another
// column, drawn by gnuplot.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "plot/run_table.hpp"

#include <filesystem>
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

// Draws picture.png and .svg; picture: an absolute path without extension. Every run has all columns.
// Says on stderr why it failed.
bool draw_comparison(const std::filesystem::path& picture, const std::vector<RunFolder>& runs,
                     const ComparisonSetup& setup);

}  // namespace ilaw::host
