// plot.hpp - `ilaw plot`: the history of a run as a picture, drawn by gnuplot.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

namespace ilaw::host {

// Reads history.csv and summary.json of a run's folder and writes history.png and history.svg beside them.
// Returns an ExitCode; says on stderr what is missing.
int plot(const std::filesystem::path& folder);

}  // namespace ilaw::host
