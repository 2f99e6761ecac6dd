// sweep.hpp - a scene run with several values of its keys: `ilaw run --set`.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "cli/run.hpp"

#include <string>
#include <vector>

namespace ilaw::host {

// settings: "/pointer=value,value,...". Every combination runs into a folder of its own in
// options.folder, options.threads at a time; sweep.csv there has a row for each. Nothing runs if
// one of them is refused. Returns an ExitCode.
int sweep(const RunOptions& options, const std::vector<std::string>& settings);

}  // namespace ilaw::host
