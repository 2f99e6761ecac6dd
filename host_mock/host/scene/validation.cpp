// The one translation unit that compiles valijson, which takes its time.
// SPDX-License-Identifier: BSD-3-Clause
#include "scene/validation.hpp"

#include "base/words.hpp"
#include "scene/json_text.hpp"

#include <valijson/adapters/nlohmann_json_adapter.hpp>
#include <valijson/schema.hpp>
#include <valijson/schema_parser.hpp>
#include <valijson/validation_results.hpp>
#include <valijson/validator.hpp>

#include <algorithm>
#include <set>
#include <string>
#include <vector>

namespace ilaw::host {
namespace {

using nlohmann::json;
using Adapter = valijson::adapters::NlohmannJsonAdapter;

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
  if (part.contains("properties") && part["properties"].contains(token))
    return resolved(part["properties"][token]);
  const json others = part.value("additionalProperties", json());
  return others.is_object() ? resolved(part["additionalProperties"]) : nothing;
}

// "array of 1 to 3 numbers".
std::string array_in_words(const json& part) {
  const json least = part.value("minItems", json()), most = part.value("maxItems", json());
  std::string count = least.is_null() ? "" : " " + least.dump();
  if (!least.is_null() && most.is_null()) count += " or more";
  if (!least.is_null() && !most.is_null() && least != most) count += " to " + most.dump();
  const json items = part.contains("items") ? resolved(part["items"]) : json::object();
  if (count.empty() && !items.contains("type")) return "array";
  return "array of" + count + " " +
         (items.contains("type") ? items["type"].get<std::string>() + "s" : "entries");
}

// "object with model, time".
std::string object_in_words(const json& part) {
  if (!part.contains("required")) return "object";
  return "object with " + joined(part["required"].get<std::vector<std::string>>());
}

// "number > 0 and <= 1".
std::string value_in_words(const json& part) {
  std::string limits;
  for (const auto& [key, words] :
       {std::pair{"minimum", " >= "}, std::pair{"exclusiveMinimum", " > "}, std::pair{"maximum", " <= "},
        std::pair{"exclusiveMaximum", " < "}, std::pair{"pattern", " matching "}})
    if (part.contains(key)) limits += (limits.empty() ? "" : " and") + (words + part[key].dump());
  return part.value("type", std::string("a value")) + limits;
}

// The values that the schema allows, in words.
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
  const std::string type = part.value("type", "");
  if (type == "array") return array_in_words(part);
  return type == "object" ? object_in_words(part) : value_in_words(part);
}

using Mistakes = std::vector<std::string>;

// The one place of a key in a scene, of some type of a part or of any.
std::string place_of(const std::string& key) {
  std::set<std::string> places;
  const auto add = [&](const json& part, const std::string& pointer) {
    if (part.value("properties", json::object()).contains(key)) places.insert(pointer + key);
  };
  add(schema(), "/");
  for (const auto& [name, given] : schema()["properties"].items()) {
    const json& part = resolved(given);
    part.contains("items") ? add(resolved(part["items"]), "/" + name + "/.../") : add(part, "/" + name + "/");
  }
  for (const auto& [kind, pointer] : {std::pair{"model_", "/model/"}, std::pair{"load_", "/loads/.../"},
                                      std::pair{"obstacle_", "/interfaces/.../obstacle/"}})
    for (const auto& [name, part] : schema()["definitions"].items())
      if (name.starts_with(kind)) add(part, pointer);
  return places.size() == 1 ? "; '" + key + "' is a key of another place, " + *places.begin() : "";
}

void explain_keys(const json& value, const json& part, const std::string& pointer, Mistakes& mistakes) {
  std::vector<std::string> keys;
  for (const auto& [key, ignored] : part["properties"].items()) keys.push_back(key);
  for (const auto& [key, ignored] : value.items())
    if (!part["properties"].contains(key))
      mistakes.emplace_back(SceneError(pointer + "/" + key, "unknown key, expected one of: " + joined(keys) +
                                                                suggestion(key, keys) + place_of(key))
                                .what());
}

// Says in words what valijson found wrong at a value; the pointer is known, the words come from the
// schema.
void explain(const json& value, const json& part, const std::string& pointer, const std::string& description,
             Mistakes& mistakes) {
  const std::size_t before = mistakes.size();
  if (value.is_object() && part.contains("properties")) {
    for (const json& key : part.value("required", json::array()))
      if (!value.contains(key.get<std::string>()))
        mistakes.emplace_back(
            SceneError(pointer, "key '" + key.get<std::string>() + "' is missing, found " + shortened(value))
                .what());
    if (part.contains("additionalProperties")) explain_keys(value, part, pointer, mistakes);
  }
  if (value.is_object() && part.contains("anyOf")) {
    json either = {{"properties", json::object()}};
    for (const json& one : part["anyOf"])
      either["properties"].update(resolved(one).value("properties", json::object()));
    explain_keys(value, either, pointer, mistakes);
  }
  if (mistakes.size() > before) return;
  if (part.is_null())
    mistakes.emplace_back(SceneError(pointer, description + " Found " + shortened(value)).what());
  else
    mistakes.emplace_back(mistake(pointer, shortened(value), allowed(part)).what());
}

// valijson names a value as <root>, [3], ["key"].
std::string token_of(const std::string& context) {
  const std::string inside = context.substr(1, context.size() - 2);
  return inside.front() == '"' || inside.front() == '\'' ? inside.substr(1, inside.size() - 2) : inside;
}

using Context = std::vector<std::string>;

void explain_error(const json& scene, const json& root, const std::string& base,
                   const valijson::ValidationResults::Error& error, Mistakes& mistakes) {
  const json* value = &scene;
  const json* part = &root;
  std::string pointer = base;
  for (std::size_t k = 1; k < error.context.size(); ++k) {
    const std::string token = token_of(error.context[k]);
    part = &child(*part, token, value->is_array());
    value = value->is_array() ? &value->at(std::stoul(token)) : &value->at(token);
    pointer += "/" + token;
  }
  explain(*value, *part, pointer, error.description, mistakes);
}

bool begins_with(const Context& context, const Context& beginning) {
  return context.size() >= beginning.size() &&
         std::equal(beginning.begin(), beginning.end(), context.begin());
}

// valijson also reports all that a mistake is inside of: the most deeply nested ones count.
void validate(const json& value, const json& part, const std::string& base, Mistakes& mistakes) {
  // A schema of its own for each part, with the shared definitions beside it.
  json standalone = part;
  standalone["definitions"] = schema()["definitions"];
  valijson::Schema compiled;
  valijson::SchemaParser parser;
  parser.populateSchema(Adapter(standalone), compiled);
  valijson::Validator validator;
  valijson::ValidationResults results;
  if (validator.validate(compiled, Adapter(value), &results)) return;
  std::vector<valijson::ValidationResults::Error> innermost;
  for (valijson::ValidationResults::Error error; results.popError(error);) {
    if (std::any_of(innermost.begin(), innermost.end(),
                    [&](const auto& other) { return begins_with(other.context, error.context); }))
      continue;
    std::erase_if(innermost, [&](const auto& other) { return begins_with(error.context, other.context); });
    innermost.push_back(error);
  }
  std::stable_sort(innermost.begin(), innermost.end(),
                   [](const auto& a, const auto& b) { return a.context.size() > b.context.size(); });
  for (const auto& error : innermost) explain_error(value, part, base, error, mistakes);
  const bool tells_of_whole = std::any_of(innermost.begin(), innermost.end(),
                                          [](const auto& error) { return error.context.size() == 1; });
  if (!tells_of_whole && value.is_object() && part.contains("additionalProperties"))
    explain_keys(value, part, base, mistakes);
}

// All at once, as far as they help.
void refuse(const Mistakes& mistakes) {
  constexpr std::size_t most = 10;
  if (mistakes.empty()) return;
  std::string text = mistakes.front();
  for (std::size_t k = 1; k < std::min(most, mistakes.size()); ++k) text += "\n  " + mistakes[k];
  if (mistakes.size() > most) text += "\n  and " + std::to_string(mistakes.size() - most) + " more";
  throw SceneError(text);
}

// Parts that come in types have a schema per type. Parts that the schema of the whole refused
// are left out.
void validate_typed(const json& value, const std::string& kind, const std::string& pointer,
                    Mistakes& mistakes) {
  if (!value.is_object() || !value.contains("type") || !value["type"].is_string()) return;
  const json& definitions = schema()["definitions"];
  const std::string name = kind + "_" + value["type"].get<std::string>();
  if (definitions.contains(name)) validate(value, definitions[name], pointer, mistakes);
}

// Before any pattern of the schema: std::regex recurses once per character.
constexpr std::size_t max_text_length = 4096;

void check_lengths(const json& value, const std::string& pointer, Mistakes& mistakes) {
  const auto check = [&](const std::string& text, const std::string& where) {
    if (text.size() > max_text_length)
      mistakes.push_back(where + ": found a text of " + std::to_string(text.size()) +
                         " bytes, expected at most " + std::to_string(max_text_length));
  };
  if (value.is_string()) check(value.get_ref<const std::string&>(), pointer);
  if (value.is_array())
    for (std::size_t k = 0; k < value.size(); ++k) check_lengths(value[k], at(pointer, k), mistakes);
  if (value.is_object())
    for (const auto& [key, member] : value.items()) {
      check(key, pointer + "/" + key.substr(0, 32));
      check_lengths(member, pointer + "/" + key.substr(0, 32), mistakes);
    }
}

}  // namespace

void validate_scene(const json& scene) {
  Mistakes mistakes;
  check_lengths(scene, "", mistakes);
  refuse(mistakes);
  validate(scene, schema(), "", mistakes);
  if (!scene.is_object()) refuse(mistakes);
  const auto list = [&](const char* key) -> json {
    return scene.contains(key) && scene[key].is_array() ? scene[key] : json::array();
  };
  if (scene.contains("model")) validate_typed(scene["model"], "model", "/model", mistakes);
  const json loads = list("loads"), interfaces = list("interfaces");
  for (std::size_t i = 0; i < loads.size(); ++i) validate_typed(loads[i], "load", at("/loads", i), mistakes);
  for (std::size_t i = 0; i < interfaces.size(); ++i)
    if (interfaces[i].is_object() && interfaces[i].contains("obstacle"))
      validate_typed(interfaces[i]["obstacle"], "obstacle", at("/interfaces", i) + "/obstacle", mistakes);
  refuse(mistakes);
}

}  // namespace ilaw::host
