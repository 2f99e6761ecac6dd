// description.hpp - what a library says of itself, for `ilaw list` and `ilaw describe`.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nlohmann/json.hpp>

#include <string>

namespace ilaw::host {

// The JSON beside the library, without running any of its code. A library without such a file is opened in a
// child process. Throws ilaw::error where the loader refuses it, std::runtime_error where its code crashes.
nlohmann::json description_of(const std::string& name_or_path);

}  // namespace ilaw::host
