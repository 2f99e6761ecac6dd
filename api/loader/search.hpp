// search.hpp - where libraries are looked for. See ilaw/loader.h for the rules.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace ilaw::loading {

struct search_path {
  std::vector<std::string> folders;   // in the order in which they are searched; always absolute
  std::vector<std::string> left_out;  // those that every user may write to
  std::vector<std::string> relative;  // entries of ILAW_PATH that are no absolute paths
};

search_path folders_searched();

// The file that a name, or a name or explicit path, stands for; throw refusal when there is none.
std::string find_named(const std::string& name);
std::string find_library(const std::string& name_or_path);

// All *.so files of the search path, those hidden by an earlier folder left out.
std::vector<std::string> library_files();

// The texts with ':' between them.
std::string joined(const std::vector<std::string>& texts);

}  // namespace ilaw::loading
