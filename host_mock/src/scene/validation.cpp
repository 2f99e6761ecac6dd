// The one translation unit that compiles valijson, which takes its time.
// SPDX-License-Identifier: BSD-3-Clause
#include "scene/validation.hpp"

#include "scene/json_text.hpp"
#include "scene/packed_points.hpp"

#include <valijson/adapters/nlohmann_json_adapter.hpp>
#include <valijson/schema.hpp>
#include <valijson/schema_parser.hpp>
#include <valijson/validation_results.hpp>
#include <valijson/validator.hpp>

#include <algorithm>
#include <cmath>
#include <optional>
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

}  // namespace

void validate_scene(const json& source) {
  // Packed points were checked as they were read: one that is right stands in for them.
  const json scene = with_packed_points_as(source, {{{"mass", 1.0}, {"position", {0.0}}}});
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
