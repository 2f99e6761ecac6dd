// python.hpp - commands that are written in Python: modules of the package beside the program.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace ilaw::host {

// Runs a module of share/ilaw/python with arguments, in the first Python that has the packages it imports.
// Gives the exit code; throws if there is none, with the Debian packages to install.
int run_python(const std::string& module, const std::vector<std::string>& arguments,
               const std::string& imports, const std::string& debian_packages);

}  // namespace ilaw::host
