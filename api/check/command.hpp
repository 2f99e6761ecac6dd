// command.hpp - the command line of the checker: that of `ilaw check`, and of ilaw-check.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <CLI/CLI.hpp>

#include <functional>

namespace ilaw::check {

// A finite number of a range, both ends included; CLI::Range lets nan pass.
CLI::Validator within(double least, double most);

// Adds the options to a command. The function that comes back is called once they are parsed: it checks,
// prints, and gives the exit code, 0 where no rule is broken and else 1. It throws UsageError where there is
// nothing to check, and std::runtime_error where the report cannot be written.
std::function<int()> add_options(CLI::App& command);

}  // namespace ilaw::check
