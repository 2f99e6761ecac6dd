// validation.hpp - scenes are checked against the JSON schema before anything runs.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nlohmann/json.hpp>

#include <stdexcept>
#include <string>

namespace ilaw::host {

extern const char* const scene_schema_text;

// A mistake in a scene: JSON pointer, what was found, what is allowed. Without pointer: one of the whole
// file.
class SceneError : public std::runtime_error {
 public:
  explicit SceneError(const std::string& found_and_expected) : std::runtime_error(found_and_expected) {}
  SceneError(const std::string& pointer, const std::string& found_and_expected)
      : std::runtime_error((pointer.empty() ? "/" : pointer) + ": " + found_and_expected) {}
};

// Parses text; refuses duplicate keys and numbers that are too large. Throws SceneError with line and column.
nlohmann::json parse_scene(const std::string& text);

// Checks against the schema; throws SceneError for the most deeply nested mistake.
void validate_scene(const nlohmann::json& scene);

}  // namespace ilaw::host
