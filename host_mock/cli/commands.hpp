// commands.hpp - the commands of the program, one file each: its options, and what it does. They
// say on stderr what goes wrong, and return an ExitCode.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "study/sweep.hpp"

#include <CLI/CLI.hpp>

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace ilaw::host {

using Action = std::function<int()>;

// Each adds a command; chosen becomes what it does where it is the one that the user gave.
void add_run(CLI::App& app, Action& chosen);
void add_plot(CLI::App& app, Action& chosen);
void add_converge(CLI::App& app, Action& chosen);
void add_study(CLI::App& app, Action& chosen);
void add_list(CLI::App& app, Action& chosen);
void add_describe(CLI::App& app, Action& chosen);
void add_check(CLI::App& app, Action& chosen);
void add_stress(CLI::App& app, Action& chosen);
void add_bench(CLI::App& app, Action& chosen);

// A finite number of a range, both ends included; CLI::Range lets nan pass.
CLI::Validator number_from(double least, double most);

// The option --threads, for commands that run scenes.
void add_threads(CLI::App& command, int& threads);
void set_threads(int threads);

// What a scene says of a sweep, unless given on the command line.
struct SweepOptions {
  std::optional<int> levels;
  std::optional<double> factor;
  std::optional<std::string> refine;  // "time" or "mesh"

  Sweep over(Sweep said) const;
};
// The options --levels, --factor and --refine.
void add_sweep(CLI::App& command, SweepOptions& options, const std::string& levels,
               const CLI::Range& allowed);

// "-" where there is no number.
std::string text_of(const char* format, double value);

// Columns as wide as their longest entry; the last one is free.
using Row = std::vector<std::string>;
void print_rows(const std::vector<Row>& rows, const char* indent);

}  // namespace ilaw::host
