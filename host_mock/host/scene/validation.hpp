// validation.hpp - scenes are checked against the JSON schema before anything runs.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/scene_error.hpp"

#include <nlohmann/json.hpp>

#include <string>

namespace ilaw::host {

extern const char* const scene_schema_text;

// Parses text; refuses duplicate keys and numbers that are too large. Throws SceneError with line
// and column.
nlohmann::json parse_scene(const std::string& text);

// Checks against the schema; throws SceneError for the most deeply nested mistake.
void validate_scene(const nlohmann::json& source);

}  // namespace ilaw::host
