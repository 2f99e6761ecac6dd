// SPDX-License-Identifier: BSD-3-Clause
#include "scene/json_text.hpp"

namespace ilaw::host {

std::string at(const std::string& pointer, std::size_t index) {
  return pointer + "/" + std::to_string(index);
}

SceneError mistake(const std::string& pointer, const std::string& found, const std::string& expected) {
  return {pointer, "found " + found + ", expected " + expected};
}

void require_one_of(const nlohmann::json& object, const char* one, const char* other,
                    const std::string& allowed, const std::string& pointer) {
  if (object.contains(one) != object.contains(other)) return;
  const std::string both = std::string("both '") + one + "' and '" + other + "'";
  throw mistake(pointer, object.contains(one) ? both : "neither", "one of " + allowed);
}

std::filesystem::path beside(const std::filesystem::path& scene_file, const std::string& path) {
  return std::filesystem::absolute(scene_file).parent_path() / path;
}

}  // namespace ilaw::host
