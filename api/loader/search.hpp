// search.hpp - where libraries are looked for. See ilaw/loader.h for the rules.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace ilaw::loading {

// Folders in the order in which they are searched; always absolute.
std::vector<std::string> search_folders();

// The file that a name or explicit path stands for; throws refusal when there is none.
std::string find_library(const std::string& name_or_path);

// All *.so files of the search path, those hidden by an earlier folder left out.
std::vector<std::string> library_files();

}  // namespace ilaw::loading
