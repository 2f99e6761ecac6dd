// commands.hpp - the commands of the program: their options, and their actions. They throw
// InputError or ilaw::error for bad input and any other exception where they fail, or say themselves on
// stderr what goes wrong, and give an ExitCode.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/scene_error.hpp"

#include <CLI/CLI.hpp>

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace ilaw::host {

// Each adds a command, which runs while the command line is parsed, where the user gave it.
void add_run(CLI::App& app, int& code);
void add_plot(CLI::App& app, int& code);
void add_view(CLI::App& app, int& code);
void add_table(CLI::App& app, int& code);
void add_converge(CLI::App& app, int& code);
void add_study(CLI::App& app, int& code);
void add_list(CLI::App& app, int& code);
void add_describe(CLI::App& app, int& code);
void add_check(CLI::App& app, int& code);
void add_stress(CLI::App& app, int& code);
void add_bench(CLI::App& app, int& code);

// The option --threads, for commands that run scenes.
void add_threads(CLI::App& command, int& threads);
void set_threads(int threads);

// Runs work; a mistake in a scene names its file.
template <class Work>
auto in_scene(const std::filesystem::path& file, Work work) {
  try {
    return work();
  } catch (const SceneError& error) {
    throw InputError(file.string() + ": " + error.what());
  }
}

// Removes the pictures in a folder that `ilaw plot` drew of earlier results.
void remove_pictures(const std::filesystem::path& folder);

// "-" where there is no number.
std::string text_of(const char* format, double value);

// Columns as wide as their longest entry; the last one is free.
using Row = std::vector<std::string>;
void print_rows(const std::vector<Row>& rows, const char* indent);

}  // namespace ilaw::host
