// A scene's text to JSON. JSON leaves undefined what a key that comes twice means, and what reads a scene
// goes through it by recursion, so both duplicate keys and deep nesting are refused here. They are looked for
// before the text is read: a callback of json::parse would search each list from its start at each entry.
// SPDX-License-Identifier: BSD-3-Clause
#include "scene/validation.hpp"

#include <cstddef>
#include <cstdint>
#include <set>
#include <string>
#include <vector>

namespace ilaw::host {
namespace {

using nlohmann::json;

// Ends at text that is no JSON, whose error json::parse tells.
class Structure : public json::json_sax_t {
 public:
  bool start_object(std::size_t /*size*/) override {
    keys_.emplace_back();
    return open();
  }
  bool end_object() override {
    keys_.pop_back();
    return close();
  }
  bool start_array(std::size_t /*size*/) override { return open(); }
  bool end_array() override { return close(); }
  bool key(std::string& key) override {
    if (!keys_.back().insert(key).second)
      throw SceneError("", "key '" + key + "' appears twice in one object, expected once");
    if (depth_ == 1) part_ = "/" + key;
    return true;
  }
  bool null() override { return true; }
  bool boolean(bool /*value*/) override { return true; }
  bool number_integer(std::int64_t /*value*/) override { return true; }
  bool number_unsigned(std::uint64_t /*value*/) override { return true; }
  bool number_float(double /*value*/, const std::string& /*text*/) override { return true; }
  bool string(std::string& /*value*/) override { return true; }
  bool binary(json::binary_t& /*value*/) override { return true; }
  bool parse_error(std::size_t /*place*/, const std::string& /*token*/,
                   const json::exception& /*error*/) override {
    return false;
  }

 private:
  static constexpr int deepest = 64;

  bool open() {
    if (depth_++ < deepest) return true;
    throw SceneError(
        part_, "values are nested more than " + std::to_string(deepest) + " deep, expected at most that");
  }
  bool close() {
    --depth_;
    return true;
  }

  int depth_ = 0;
  std::vector<std::set<std::string>> keys_;  // of the objects that are open
  std::string part_;                         // of the scene, that is read
};

}  // namespace

json parse_scene(const std::string& text) {
  try {
    Structure structure;
    json::sax_parse(text, &structure);
    return json::parse(text);
  } catch (const json::exception& error) {
    throw SceneError(std::string("not valid JSON: ") + error.what());
  }
}

}  // namespace ilaw::host
