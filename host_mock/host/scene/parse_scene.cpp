// A scene's text to JSON. JSON leaves undefined what a key that comes twice means, and what reads a scene
// goes through it by recursion, so both duplicate keys and deep nesting are refused here.
// SPDX-License-Identifier: BSD-3-Clause
#include "scene/validation.hpp"

#include <set>
#include <string>
#include <vector>

namespace ilaw::host {

using nlohmann::json;

json parse_scene(const std::string& text) {
  constexpr int deepest = 64;
  std::vector<std::set<std::string>> keys;  // of the objects that are open
  std::string part;                         // of the scene, that is read
  const auto check = [&](int depth, json::parse_event_t event, json& parsed) {
    const bool opens =
        event == json::parse_event_t::object_start || event == json::parse_event_t::array_start;
    if (opens && depth == deepest)
      throw SceneError(
          part, "values are nested more than " + std::to_string(deepest) + " deep, expected at most that");
    if (event == json::parse_event_t::object_start) keys.emplace_back();
    if (event == json::parse_event_t::object_end) keys.pop_back();
    if (event != json::parse_event_t::key) return true;
    const std::string& key = parsed.get_ref<const std::string&>();
    if (!keys.back().insert(key).second)
      throw SceneError("", "key '" + key + "' appears twice in one object, expected once");
    if (depth == 1) part = "/" + key;
    return true;
  };
  try {
    return json::parse(text, check);
  } catch (const json::exception& error) {
    throw SceneError(std::string("not valid JSON: ") + error.what());
  }
}

}  // namespace ilaw::host
