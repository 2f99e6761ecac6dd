// description_file.hpp - the description of a library as JSON, in the file <library>.json beside
// <library>.so: programs read it without running any code of the library.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/ilaw.h>

#include <nlohmann/json.hpp>

#include <optional>
#include <string>

namespace ilaw::loading {

// "contact.json" for "contact.so"; empty for a file of another name.
std::string description_path(const std::string& library);

struct description {
  std::string text;
  nlohmann::json parsed;
};

// The file beside a library. None where there is no such file, or where it is some other JSON, such
// as a scene. Throws refusal where the file is too large, too deep or no JSON, or has texts unfit to print.
std::optional<description> read_description(const std::string& library);

// The same for the content of a file.
std::optional<description> parse_description(const std::string& file, const std::string& text);

// Throws refusal unless the JSON has all members that description_text writes, with the right types.
void check_members(const nlohmann::json& found, const std::string& file);

// Throws refusal unless the file says the same as the library, naming the first difference. A library of a
// newer minor version may have more of everything.
void check_same(const nlohmann::json& found, const ilaw_plugin& plugin, const std::string& library);

}  // namespace ilaw::loading
