// python.hpp - commands that are written in Python: modules of the package beside the program.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace ilaw::host {

// Becomes a module of share/ilaw/python with arguments, in the first Python that has the packages it imports.
// Throws if there is none, with the Debian packages to install.
[[noreturn]] void run_python(const std::string& module, const std::vector<std::string>& arguments,
                             const std::string& imports, const std::string& debian_packages);

}  // namespace ilaw::host
