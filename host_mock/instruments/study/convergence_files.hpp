// convergence_files.hpp - what a study of convergence leaves in its folder.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "study/convergence.hpp"

#include <filesystem>
#include <string>

namespace ilaw::host {

// converge.csv with the errors, converge.json with their orders.
void write_convergence(const ErrorTable& table, const Sweep& sweep, const std::string& title,
                       const std::filesystem::path& folder);

// converge.png and .svg, by gnuplot: errors over the time step, and over the run time. The folder
// is absolute. Says on stderr why there are none.
bool draw_convergence(const ErrorTable& table, const std::string& title, const std::filesystem::path& folder);

}  // namespace ilaw::host
