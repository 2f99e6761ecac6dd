// work_precision_files.hpp - what a study leaves in its folder.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "study/work_precision.hpp"

#include <filesystem>
#include <string>

namespace ilaw::host {

// study.csv with all runs, study_needed.csv with what errors cost, study.json with the laws and their
// largest stable steps.
void write_study(const Study& study, const std::string& title, const std::filesystem::path& folder);

// study.png and .svg, by gnuplot: errors over the number of steps and over the run time. The folder is
// absolute. Says on stderr why there are none.
bool draw_study(const Study& study, const std::string& title, const std::filesystem::path& folder);

}  // namespace ilaw::host
