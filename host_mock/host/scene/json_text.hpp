// json_text.hpp - pointers into a scene and words about what is wrong there, the same throughout.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/scene_error.hpp"

#include <nlohmann/json.hpp>

#include <cstddef>
#include <filesystem>
#include <string>

namespace ilaw::host {

// JSON pointer of an element.
std::string at(const std::string& pointer, std::size_t index);

// "found <found>, expected <expected>", at the pointer.
SceneError mistake(const std::string& pointer, const std::string& found, const std::string& expected);

// Exactly one of two keys must be there; allowed says what they are.
void require_one_of(const nlohmann::json& object, const char* one, const char* other,
                    const std::string& allowed, const std::string& pointer);

// A path of a scene: relative to it, not to wherever the user happens to be.
std::filesystem::path beside(const std::filesystem::path& scene_file, const std::string& path);

}  // namespace ilaw::host
