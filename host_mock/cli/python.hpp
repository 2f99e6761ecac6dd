// python.hpp - commands that are written in Python: modules of the package beside the program.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <CLI/CLI.hpp>

#include <memory>
#include <string>

namespace ilaw::host {

// Makes a command become a module of share/ilaw/python with the options and arguments that the user gave, in
// the first Python that has the packages. Throws if there is none, with the Debian packages to install. kept:
// what the options are bound to.
void run_in_python(CLI::App& command, const std::string& module, const std::string& packages,
                   const std::string& debian_packages, const std::shared_ptr<void>& kept);

}  // namespace ilaw::host
