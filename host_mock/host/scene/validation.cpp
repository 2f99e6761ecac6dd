// SPDX-License-Identifier: BSD-3-Clause
#include "scene/validation.hpp"

#include "base/words.hpp"
#include "scene/json_text.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <iterator>
#include <regex>
#include <set>
#include <string>
#include <vector>

namespace ilaw::host {
namespace {

using nlohmann::json;

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

// The schema of a member of an object, null where the schema says nothing of it.
const json& member_of(const json& part, const std::string& key) {
  static const json nothing;
  const auto properties = part.find("properties"), others = part.find("additionalProperties");
  if (properties != part.end() && properties->contains(key)) return (*properties)[key];
  return others != part.end() && others->is_object() ? *others : nothing;
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

// Mistakes and how deep in the scene they are: the deepest are told first.
struct Mistake {
  std::size_t depth;
  std::string text;
};
using Mistakes = std::vector<Mistake>;

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

// Keys that the object lacks or may not have.
void check_keys(const json& value, const json& part, const std::string& pointer, std::size_t depth,
                Mistakes& mistakes) {
  for (const json& key : part.value("required", json::array()))
    if (!value.contains(key.get<std::string>()))
      mistakes.push_back({depth, SceneError(pointer, "key '" + key.get<std::string>() +
                                                         "' is missing, found " + shortened(value))
                                     .what()});
  if (part.value("additionalProperties", json()) != false) return;
  std::vector<std::string> keys;
  for (const auto& [key, ignored] : part["properties"].items()) keys.push_back(key);
  for (const auto& [key, ignored] : value.items())
    if (!part["properties"].contains(key))
      mistakes.push_back(
          {depth, SceneError(pointer + "/" + key, "unknown key, expected one of: " + joined(keys) +
                                                      suggestion(key, keys) + place_of(key))
                      .what()});
}

// The keys of all kinds that a value may be of.
json keys_of_kinds(const json& kinds) {
  json either = {{"properties", json::object()}, {"additionalProperties", false}};
  for (const json& one : kinds)
    either["properties"].update(resolved(one).value("properties", json::object()));
  return either;
}

bool has_type(const json& value, const std::string& type) {
  if (type == "integer") return value.is_number_integer();
  return type == (value.is_number() ? "number" : value.type_name());
}

// Without what is in it.
bool is_allowed(const json& value, const json& part) {
  const auto within = [&](const char* least, const char* most, std::size_t size) {
    return size >= part.value(least, std::size_t{0}) && size <= part.value(most, SIZE_MAX);
  };
  if (part.contains("type") && !has_type(value, part["type"])) return false;
  if (part.contains("enum") && std::ranges::find(part["enum"], value) == part["enum"].end()) return false;
  if (value.is_array()) return within("minItems", "maxItems", value.size());
  if (value.is_string()) {
    const auto& text = value.get_ref<const std::string&>();
    const auto begins = [](char byte) { return (byte & 0xC0) != 0x80; };  // a character of UTF-8
    const auto pattern = part.find("pattern");
    return (pattern == part.end() ||
            std::regex_search(text, std::regex(pattern->get_ref<const std::string&>()))) &&
           within("minLength", "maxLength", static_cast<std::size_t>(std::ranges::count_if(text, begins)));
  }
  if (!value.is_number()) return true;
  const auto number = value.get<double>();
  return number >= part.value("minimum", -HUGE_VAL) && number <= part.value("maximum", HUGE_VAL) &&
         number > part.value("exclusiveMinimum", -HUGE_VAL) &&
         number < part.value("exclusiveMaximum", HUGE_VAL);
}

// Of a value that is none of several kinds, the mistakes within it count, whichever kind was meant.
void check(const json& value, const json& given, const std::string& pointer, std::size_t depth,
           Mistakes& mistakes) {
  const json& part = resolved(given);
  const std::size_t before = mistakes.size();
  const auto kinds = part.find("anyOf");
  for (std::size_t k = 0; kinds != part.end() && k < kinds->size(); ++k) {
    const json& one = (*kinds)[k];
    Mistakes own;
    check(value, one, pointer, depth, own);
    if (own.empty()) {
      mistakes.resize(before);
      return;
    }
    std::ranges::copy_if(own, std::back_inserter(mistakes), [&](const Mistake& a) {
      return a.depth > depth &&
             std::ranges::none_of(mistakes, [&](const Mistake& b) { return a.text == b.text; });
    });
  }
  for (std::size_t k = 0; value.is_array() && part.contains("items") && k < value.size(); ++k)
    check(value[k], part["items"], at(pointer, k), depth + 1, mistakes);
  if (value.is_object())
    for (const auto& [key, member] : value.items())
      if (const json& known = member_of(part, key); !known.is_null())
        check(member, known, pointer + "/" + key, depth + 1, mistakes);
  if (value.is_object() && part.contains("properties")) check_keys(value, part, pointer, depth, mistakes);
  if (kinds != part.end() && mistakes.size() == before) {
    if (value.is_object()) check_keys(value, keys_of_kinds(*kinds), pointer, depth, mistakes);
    if (mistakes.size() > before) return;
  } else if (is_allowed(value, part)) {
    return;
  }
  mistakes.push_back({depth, mistake(pointer, shortened(value), allowed(part)).what()});
}

void validate(const json& value, const json& part, const std::string& base, Mistakes& mistakes) {
  Mistakes own;
  check(value, part, base, 0, own);
  std::ranges::stable_sort(own, std::greater<>(), &Mistake::depth);
  mistakes.insert(mistakes.end(), own.begin(), own.end());
}

// All at once, as far as they help.
void refuse(const Mistakes& mistakes) {
  constexpr std::size_t most = 10;
  if (mistakes.empty()) return;
  std::string text = mistakes.front().text;
  for (std::size_t k = 1; k < std::min(most, mistakes.size()); ++k) text += "\n  " + mistakes[k].text;
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
      mistakes.push_back({0, where + ": found a text of " + std::to_string(text.size()) +
                                 " bytes, expected at most " + std::to_string(max_text_length)});
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
