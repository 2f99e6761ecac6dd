// The one translation unit that compiles valijson, which takes its time.
// SPDX-License-Identifier: BSD-3-Clause
#include "scene/validation.hpp"

#include "scene/json_text.hpp"

#include <valijson/adapters/nlohmann_json_adapter.hpp>
#include <valijson/schema.hpp>
#include <valijson/schema_parser.hpp>
#include <valijson/validation_results.hpp>
#include <valijson/validator.hpp>

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <vector>

namespace ilaw::host {
namespace {

using nlohmann::json;
using Adapter = valijson::adapters::NlohmannJsonAdapter;

// Fewest edits that turn one word into another, to suggest the key that was meant (Levenshtein
// 1966).
std::size_t edits(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0]++;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t above = row[j];
      row[j] = std::min({above + 1, row[j - 1] + 1, diagonal + (a[i - 1] == b[j - 1] ? 0 : 1)});
      diagonal = above;
    }
  }
  return row[b.size()];
}

std::string shortened(const json& value) {
  const std::string text = value.dump();
  return text.size() <= 60 ? text : text.substr(0, 57) + "...";
}

const json& schema() {
  static const json parsed = json::parse(scene_schema_text);
  return parsed;
}

const json& resolved(const json& part) {
  if (!part.contains("$ref")) return part;
  return schema().at(json::json_pointer(part["$ref"].get<std::string>().substr(1)));
}

// The schema of a member or element, null where the schema says nothing of it.
const json& child(const json& part, const std::string& token, bool is_index) {
  static const json nothing;
  if (part.contains("anyOf"))
    for (const json& one : part["anyOf"])
      if (const json& found = child(resolved(one), token, is_index); !found.is_null()) return found;
  if (is_index) return part.contains("items") ? resolved(part["items"]) : nothing;
  return part.contains("properties") && part["properties"].contains(token)
             ? resolved(part["properties"][token])
             : nothing;
}

// What the schema allows for a value, in words.
std::string allowed(const json& part) {
  if (part.contains("anyOf")) {
    std::string text;
    for (const json& one : part["anyOf"]) text += (text.empty() ? "" : " or ") + allowed(resolved(one));
    return text;
  }
  if (part.contains("enum")) {
    std::vector<std::string> values;
    for (const json& one : part["enum"]) values.push_back(one.dump());
    return "one of " + joined(values);
  }
  std::string text = part.value("type", "a value");
  if (part.contains("items") && resolved(part["items"]).contains("type"))
    text += " of " + resolved(part["items"])["type"].get<std::string>() + "s";
  for (const auto& [key, words] :
       {std::pair{"minimum", " >= "}, std::pair{"exclusiveMinimum", " > "}, std::pair{"maximum", " <= "},
        std::pair{"exclusiveMaximum", " < "}, std::pair{"minItems", " of at least "},
        std::pair{"maxItems", " of at most "}, std::pair{"pattern", " matching "}})
    if (part.contains(key))
      text += words + part[key].dump() + (std::string(key).ends_with("Items") ? " entries" : "");
  return text;
}

void explain_keys(const json& value, const json& part, const std::string& pointer) {
  std::vector<std::string> keys;
  for (const auto& [key, ignored] : part["properties"].items()) keys.push_back(key);
  for (const auto& [key, ignored] : value.items()) {
    if (part["properties"].contains(key)) continue;
    std::string nearest;
    for (const auto& [candidate, also_ignored] : part["properties"].items())
      if (edits(key, candidate) <= 2 && (nearest.empty() || edits(key, candidate) < edits(key, nearest)))
        nearest = candidate;
    throw SceneError(pointer + "/" + key, "unknown key, expected one of: " + joined(keys) +
                                              (nearest.empty() ? "" : " (did you mean '" + nearest + "'?)"));
  }
}

// Says in words what valijson found wrong at a value; the pointer is known, the words come from the
// schema.
[[noreturn]] void explain(const json& value, const json& part, const std::string& pointer,
                          const std::string& description) {
  if (value.is_object() && part.contains("properties")) {
    for (const json& key : part.value("required", json::array()))
      if (!value.contains(key.get<std::string>()))
        throw SceneError(pointer,
                         "key '" + key.get<std::string>() + "' is missing, found " + shortened(value));
    if (part.contains("additionalProperties")) explain_keys(value, part, pointer);
  }
  if (part.is_null()) throw SceneError(pointer, description + " Found " + shortened(value));
  throw mistake(pointer, shortened(value), allowed(part));
}

// valijson names a value as <root>, [3], ["key"].
std::string token_of(const std::string& context) {
  const std::string inside = context.substr(1, context.size() - 2);
  return inside.front() == '"' || inside.front() == '\'' ? inside.substr(1, inside.size() - 2) : inside;
}

[[noreturn]] void explain_error(const json& scene, const json& root, const std::string& base,
                                const valijson::ValidationResults::Error& error) {
  const json* value = &scene;
  const json* part = &root;
  std::string pointer = base;
  for (std::size_t k = 1; k < error.context.size(); ++k) {
    const std::string token = token_of(error.context[k]);
    part = &child(*part, token, value->is_array());
    value = value->is_array() ? &value->at(std::stoul(token)) : &value->at(token);
    pointer += "/" + token;
  }
  explain(*value, *part, pointer, error.description);
}

void validate(const json& value, const json& part, const std::string& base) {
  // A schema of its own for each part, with the shared definitions beside it.
  json standalone = part;
  standalone["definitions"] = schema()["definitions"];
  valijson::Schema compiled;
  valijson::SchemaParser parser;
  parser.populateSchema(Adapter(standalone), compiled);
  valijson::Validator validator;
  valijson::ValidationResults results;
  if (validator.validate(compiled, Adapter(value), &results)) return;
  std::optional<valijson::ValidationResults::Error> deepest;
  for (valijson::ValidationResults::Error error; results.popError(error);)
    if (!deepest || error.context.size() > deepest->context.size()) deepest = error;
  explain_error(value, part, base, *deepest);
}

// Looks for keys that come twice, which JSON leaves undefined, and for values within values deeper than
// a scene ever is, which what goes through them by recursion could not stand. A reader of its own:
// nlohmann's parser with a callback goes through all of an array after each of its objects.
class Structure : public nlohmann::json_sax<json> {
 public:
  bool start_object(std::size_t /*size*/) override {
    enter();
    seen_.emplace_back();
    return true;
  }
  bool end_object() override {
    seen_.pop_back();
    --depth_;
    return true;
  }
  bool key(string_t& key) override {
    if (!seen_.back().insert(key).second)
      throw SceneError("", "key '" + key + "' appears twice in one object, expected once");
    if (seen_.size() == 1) part_ = "/" + key;
    return true;
  }
  bool null() override { return true; }
  bool boolean(bool /*value*/) override { return true; }
  bool number_integer(number_integer_t /*value*/) override { return true; }
  bool number_unsigned(number_unsigned_t /*value*/) override { return true; }
  bool number_float(number_float_t /*value*/, const string_t& /*text*/) override { return true; }
  bool string(string_t& /*value*/) override { return true; }
  bool binary(binary_t& /*value*/) override { return true; }
  bool start_array(std::size_t /*size*/) override {
    enter();
    return true;
  }
  bool end_array() override {
    --depth_;
    return true;
  }
  bool parse_error(std::size_t /*at*/, const std::string& /*token*/,
                   const json::exception& /*error*/) override {
    return false;  // left to parse
  }

 private:
  void enter() {
    constexpr int deepest = 64;
    if (++depth_ > deepest)
      throw SceneError(
          part_, "values are nested more than " + std::to_string(deepest) + " deep, expected at most that");
  }

  std::vector<std::set<std::string>> seen_;
  std::string part_;  // of the scene, that is read
  int depth_ = 0;
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

void validate_scene(const json& scene) {
  validate(scene, schema(), "");
  // Parts that come in types have a schema per type.
  const auto validate_typed = [](const json& value, const std::string& kind, const std::string& pointer) {
    validate(value, schema()["definitions"][kind + "_" + value["type"].get<std::string>()], pointer);
  };
  validate_typed(scene["model"], "model", "/model");
  for (std::size_t i = 0; scene.contains("loads") && i < scene["loads"].size(); ++i)
    validate_typed(scene["loads"][i], "load", at("/loads", i));
  for (std::size_t i = 0; i < scene["interfaces"].size(); ++i)
    if (scene["interfaces"][i].contains("obstacle"))
      validate_typed(scene["interfaces"][i]["obstacle"], "obstacle", at("/interfaces", i) + "/obstacle");
}

}  // namespace ilaw::host
