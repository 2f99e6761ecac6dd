// python.hpp - commands that are written in Python: modules of the package beside the program.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <CLI/CLI.hpp>

#include <string>

namespace ilaw::host {

struct PythonModule {
  std::string name, packages, debian_packages;
};

// Becomes a module of share/ilaw/python with the options and arguments that the user gave to the command, in
// the first Python that has the packages. Throws if there is none, with the Debian packages to install.
[[noreturn]] void become_python(const CLI::App& command, const PythonModule& module);
// Makes a command do so.
void run_in_python(CLI::App& command, const PythonModule& module);

}  // namespace ilaw::host
