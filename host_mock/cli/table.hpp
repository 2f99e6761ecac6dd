// table.hpp - `ilaw table`.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "cli/commands.hpp"

namespace ilaw::host {

void add_table(CLI::App& app, Action& chosen);

}  // namespace ilaw::host
