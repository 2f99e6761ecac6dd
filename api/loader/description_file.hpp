// description_file.hpp - the description of a library as JSON, in the file <library>.json beside
// <library>.so: programs read it without running any code of the library.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/ilaw.h>

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace ilaw::loading {

// A JSON value. nlohmann's would do, but its destructor allocates, and ends the program where memory runs
// out.
struct json_value {
  enum kind { null, boolean, number, text, list, object };

  kind type = null;
  bool truth = false;
  double value = 0.0;
  std::string letters;
  std::vector<std::string> keys;  // of an object, one per element
  std::vector<json_value> elements;

  bool is(std::string_view wanted) const { return type == text && letters == wanted; }
  // Null where there is none; the last one of a name counts.
  const json_value* find(std::string_view key) const;
};

// "contact.json" for "contact.so"; empty for a file of another name.
std::string description_path(const std::string& library);

struct description {
  std::string text;
  json_value parsed;
};

// The file beside a library. None where there is no such file, or where it is some other JSON, such
// as a scene. Throws refusal where the file is too large, too deep or no JSON, or has texts unfit to print.
std::optional<description> read_description(const std::string& library);

// The same for the content of a file.
std::optional<description> parse_description(const std::string& file, const std::string& text);

// Throws refusal unless the JSON has all members that description_text writes, with the right types.
void check_members(const json_value& found, const std::string& file);

// Throws refusal unless the file says the same as the library, naming the first difference. A library of a
// newer minor version may have more of everything.
void check_same(const json_value& found, const ilaw_plugin& plugin, const std::string& library);

}  // namespace ilaw::loading
