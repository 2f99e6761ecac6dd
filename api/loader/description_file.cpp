// SPDX-License-Identifier: BSD-3-Clause
#include "description_file.hpp"

#include "file.hpp"
#include "readable.hpp"
#include "refusal.hpp"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <string_view>
#include <vector>

namespace ilaw::loading {
namespace {

using nlohmann::json;

constexpr const char* format = "ilaw-description/1";
constexpr std::uint64_t max_bytes = std::uint64_t{1} << 20;
constexpr int max_depth = 16;

// ---- from the structs -----------------------------------------------------------------------------------

// Names of bits, the lowest first; of kinds, from 0.
using names = std::initializer_list<const char*>;
constexpr names dimension_names = {"", "1", "2", "3"};
constexpr names form_names = {"scalar", "diagonal", "full", "transverse"};
constexpr names frame_names = {"local", "global"};
constexpr names number_names = {"double", "float"};
constexpr names input_names = {"gap", "v_previous", "area", "normal", "tangent"};
constexpr names output_names = {"velocity", "status", "energy"};
constexpr names capability_names = {"adhere", "store_energy"};
constexpr names permission_names = {"skip_fresh", "skip_free"};
constexpr names parameter_flag_names = {"is_required", "excludes_minimum", "allows_infinity",
                                        "allows_per_node", "is_field"};
constexpr names variable_flag_names = {"internal"};
constexpr names parameter_kinds = {"number", "count", "choice"};
constexpr names state_kinds = {"scalar", "vector", "history", "axis", "tangential"};

json bits(std::uint32_t mask, const names& known) {
  json list = json::array();
  for (std::size_t i = 0; i < known.size(); ++i)
    if ((mask >> i & 1U) != 0 && *known.begin()[i]) list.push_back(known.begin()[i]);
  return list;
}

json kind(std::uint32_t value, const names& known) {
  return value < known.size() ? json(known.begin()[value]) : json();
}

json number(double value) {
  if (std::isfinite(value)) return value;
  return std::isnan(value) ? json() : json(value > 0 ? "inf" : "-inf");
}

// No limit is written as infinity.
json limit(double value) {
  return std::abs(value) == std::numeric_limits<double>::max() ? number(std::copysign(INFINITY, value))
                                                               : number(value);
}

json texts(const char* const* list, std::uint32_t count) {
  return std::vector<std::string>(list, list + count);
}

json default_of(const ilaw_parameter& p) {
  if ((p.flags & ILAW_PARAMETER_IS_REQUIRED) != 0) return {};
  if (p.kind == ILAW_PARAMETER_CHOICE) return p.choices[static_cast<std::size_t>(p.default_value)];
  return number(p.default_value);
}

json json_of_parameter(const ilaw_parameter& p) {
  return {{"name", p.name},
          {"symbol", p.symbol},
          {"unit", p.unit},
          {"doc", p.doc},
          {"kind", kind(p.kind, parameter_kinds)},
          {"minimum", limit(p.minimum)},
          {"maximum", limit(p.maximum)},
          {"default", default_of(p)},
          {"flags", bits(p.flags, parameter_flag_names)},
          {"choices", texts(p.choices, p.choice_count)},
          {"axes", texts(p.axes, p.axis_count)}};
}

json json_of_variable(const ilaw_state_variable& v) {
  return {{"name", v.name},   {"unit", v.unit},
          {"doc", v.doc},     {"kind", kind(v.kind, state_kinds)},
          {"count", v.count}, {"flags", bits(v.flags, variable_flag_names)}};
}

json json_of_amount(const ilaw_amount& a) { return {{"name", a.name}, {"unit", a.unit}, {"doc", a.doc}}; }

template <class Element>
json list(const Element* const* elements, std::uint32_t count, json (*json_of_one)(const Element&)) {
  json made = json::array();
  for (std::uint32_t i = 0; i < count; ++i) made.push_back(json_of_one(*elements[i]));
  return made;
}

json json_of_law(const ilaw_law& law) {
  return {{"id", law.id},
          {"title", law.title},
          {"doc", law.doc},
          {"references", texts(law.references, law.reference_count)},
          {"dimensions", bits(law.dimensions, dimension_names)},
          {"delassus_forms", bits(law.delassus_forms, form_names)},
          {"frames", bits(law.frames, frame_names)},
          {"numbers", bits(law.numbers, number_names)},
          {"inputs", bits(law.inputs, input_names)},
          {"outputs", bits(law.outputs, output_names)},
          {"capabilities", bits(law.capabilities, capability_names)},
          {"permissions", bits(law.permissions, permission_names)},
          {"parameters", list(law.parameters, law.parameter_count, json_of_parameter)},
          {"state_variables", list(law.state_variables, law.state_variable_count, json_of_variable)},
          {"amounts", list(law.amounts, law.amount_count, json_of_amount)}};
}

// ---- from the file --------------------------------------------------------------------------------------

[[noreturn]] void refuse(const std::string& file, const std::string& found_and_expected) {
  throw refusal(ILAW_BAD_LIBRARY, file + ": " + found_and_expected);
}

std::string content_of(const std::string& file, const file_status& status) {
  if (!status.regular) refuse(file, "not a regular file, expected a description of a library");
  if (status.size > max_bytes) refuse(file, "larger than 1 MiB, expected a description of a library");
  std::string text(status.size, '\0');
  const open_file opened(file);
  if (!opened.is_open() || !opened.copy(0, text.data(), text.size())) refuse(file, "the file cannot be read");
  return text;
}

json parsed(const std::string& file, const std::string& text) {
  const auto limited = [&file](int depth, json::parse_event_t, json&) {
    if (depth > max_depth)
      refuse(file, "nested deeper than " + std::to_string(max_depth) + " levels, expected a description");
    return true;
  };
  try {
    return json::parse(text, limited);
  } catch (const json::parse_error& error) {
    refuse(file, "no JSON at byte " + std::to_string(error.byte));
  } catch (const json::out_of_range&) {
    refuse(file, "a number beyond the range of double, expected infinity as \"inf\"");
  }
}

// Texts may be printed: UTF-8 without control characters; a doc may have several lines.
void check_texts(const json& value, bool lines_allowed, const std::string& file) {
  if (value.is_string() && !clean_text(value.get_ref<const std::string&>(), lines_allowed))
    refuse(file, "a text has control characters");
  if (value.is_object()) {
    for (const auto& [key, member] : value.items()) {
      if (!clean_text(key, false)) refuse(file, "a name has control characters");
      check_texts(member, key == "doc", file);
    }
  } else if (value.is_array()) {
    for (const json& element : value) check_texts(element, false, file);
  }
}

// Every member of a description, each list with one element: 0 stands for a number or "inf", null for any
// text, number or null.
const json& model() {
  static const json& made = *new json(json::parse(R"({
    "format": "", "name": "", "version": "", "vendor": "", "licence": "", "abi": [0],
    "laws": [{
      "id": "", "title": "", "doc": "", "references": [""], "dimensions": [""], "delassus_forms": [""],
      "frames": [""], "numbers": [""], "inputs": [""], "outputs": [""], "capabilities": [""],
      "permissions": [""],
      "parameters": [{"name": "", "symbol": "", "unit": "", "doc": "", "kind": "", "minimum": 0, "maximum": 0,
                      "default": null, "flags": [""], "choices": [""], "axes": [""]}],
      "state_variables": [{"name": "", "unit": "", "doc": "", "kind": "", "count": 0, "flags": [""]}],
      "amounts": [{"name": "", "unit": "", "doc": ""}]}]})"));
  return made;
}

bool is_like(const json& found, const json& model) {
  if (model.is_null()) return found.is_primitive() && !found.is_boolean();
  if (model.is_number()) return found.is_number() || found == "inf" || found == "-inf";
  return found.type() == model.type();
}

void check_like(const json& found, const json& model, const std::string& at, const std::string& file) {
  if (!is_like(found, model))
    refuse(file, at + " is a JSON " + found.type_name() + ", expected " +
                     (model.is_null() ? "a text or number" : model.type_name()));
  if (model.is_array())
    for (std::size_t i = 0; i < found.size(); ++i)
      check_like(found[i], model[0], at + "/" + std::to_string(i), file);
  if (!model.is_object()) return;
  for (const auto& [key, member] : model.items()) {
    if (!found.contains(key)) refuse(file, at + "/" + key + " is missing");
    check_like(found[key], member, at + "/" + key, file);
  }
}

// ---- both -----------------------------------------------------------------------------------------------

std::string shown(const json& value) {
  constexpr std::size_t max_letters = 60;
  const std::string text = value.dump(-1, ' ', true, json::error_handler_t::replace);
  return text.size() > max_letters ? text.substr(0, max_letters) + "..." : text;
}

std::string unequal(const std::string& at, const std::string& found, const std::string& expected) {
  return (at.empty() ? "it" : at) + " is " + found + ", the library says " + expected;
}

// The first difference; empty where there is none. newer: the library has a newer minor version than this
// loader, and its file may have members, elements and names that the loader does not know.
std::string difference(const json& found, const json& library, bool newer, const std::string& at) {
  if (newer && library.is_null()) return "";
  if (found.is_object() && library.is_object()) {
    for (const auto& [key, member] : library.items()) {
      if (!found.contains(key)) return unequal(at + "/" + key, "missing", shown(member));
      std::string text = difference(found[key], member, newer, at + "/" + key);
      if (!text.empty()) return text;
    }
    for (const auto& [key, member] : found.items())
      if (!newer && !library.contains(key)) return unequal(at + "/" + key, shown(member), "nothing");
    return "";
  }
  if (!found.is_array() || !library.is_array())
    return found == library ? "" : unequal(at, shown(found), shown(library));
  if (newer && !library.empty() && library[0].is_string()) {
    for (const json& name : library)
      if (std::find(found.begin(), found.end(), name) == found.end())
        return unequal(at, shown(found), shown(library));
    return "";
  }
  for (std::size_t i = 0; i < library.size() && i < found.size(); ++i) {
    std::string text = difference(found[i], library[i], newer, at + "/" + std::to_string(i));
    if (!text.empty()) return text;
  }
  if (found.size() == library.size() || (newer && library.empty())) return "";
  return unequal(at, "a list of " + std::to_string(found.size()), std::to_string(library.size()));
}

}  // namespace

json json_of(const ilaw_plugin& plugin) {
  return {{"format", format},
          {"name", plugin.name},
          {"version", plugin.version},
          {"vendor", plugin.vendor},
          {"licence", plugin.licence},
          {"abi", {plugin.abi_major, plugin.abi_minor}},
          {"laws", list(plugin.laws, plugin.law_count, json_of_law)}};
}

std::string description_path(const std::string& library) {
  return library.ends_with(".so") ? library.substr(0, library.size() - 3) + ".json" : "";
}

std::optional<json> parse_description(const std::string& file, const std::string& text) {
  json found = parsed(file, text);
  if (!found.is_object() || found.value("format", json()) != format) return {};
  check_texts(found, false, file);
  return found;
}

std::optional<json> parsed_description(const std::string& library) {
  const std::string file = description_path(library);
  const file_status status = status_of(file);
  if (file.empty() || !status.exists) return {};
  return parse_description(file, content_of(file, status));
}

void check_members(const json& found, const std::string& file) {
  check_like(found, model(), "", file);
  if (found["abi"].size() != 2) refuse(file, "/abi has not two numbers");
}

void check_same(const json& found, const ilaw_plugin& plugin, const std::string& library) {
  const std::string text = difference(found, json_of(plugin), plugin.abi_minor > ILAW_ABI_MINOR, "");
  if (!text.empty())
    refuse(description_path(library),
           text + ": remove the file, or write it anew by ilaw-describe " + library);
}

}  // namespace ilaw::loading
