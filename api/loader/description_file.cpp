// SPDX-License-Identifier: BSD-3-Clause
#include "description_file.hpp"

#include "description_text.hpp"
#include "file.hpp"
#include "readable.hpp"
#include "refusal.hpp"

#include <algorithm>
#include <utility>
#include <vector>

namespace ilaw::loading {
namespace {

using nlohmann::json;

constexpr std::uint64_t max_bytes = std::uint64_t{1} << 20;
constexpr std::size_t max_depth = 16;

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

// Builds the value as nlohmann reads it. json::parse would do, but for a newer C++ library than the loader
// may need, and without a limit of depth.
class builder : public nlohmann::json_sax<json> {
 public:
  explicit builder(const std::string& file) : file_(file) {}
  json take() { return std::move(root_); }

  bool null() override { return add(json()); }
  bool boolean(bool value) override { return add(json(value)); }
  bool number_integer(number_integer_t value) override { return add(json(value)); }
  bool number_unsigned(number_unsigned_t value) override { return add(json(value)); }
  bool number_float(number_float_t value, const string_t&) override { return add(json(value)); }
  bool string(string_t& value) override { return add(json(std::move(value))); }
  bool binary(binary_t&) override { return false; }
  bool start_object(std::size_t) override { return start(json(json::value_t::object)); }
  bool start_array(std::size_t) override { return start(json(json::value_t::array)); }
  bool end_object() override { return end(); }
  bool end_array() override { return end(); }
  bool key(string_t& value) override {
    key_ = std::move(value);
    return true;
  }
  bool parse_error(std::size_t byte, const std::string&, const json::exception& error) override {
    if (dynamic_cast<const json::out_of_range*>(&error))
      refuse(file_, "a number beyond the range of double, expected infinity as \"inf\"");
    refuse(file_, "no JSON at byte " + std::to_string(byte));
  }

 private:
  json& place(json&& value) {
    if (open_.empty()) return root_ = std::move(value);
    json& parent = *open_.back();
    if (parent.is_object()) return parent[key_] = std::move(value);
    parent.push_back(std::move(value));
    return parent.back();
  }
  bool add(json&& value) {
    place(std::move(value));
    return true;
  }
  bool start(json&& value) {
    if (open_.size() == max_depth)
      refuse(file_, "nested deeper than " + std::to_string(max_depth) + " levels, expected a description");
    open_.push_back(&place(std::move(value)));
    return true;
  }
  bool end() {
    open_.pop_back();
    return true;
  }

  const std::string& file_;
  json root_;
  std::vector<json*> open_;  // lists and objects that are not complete
  std::string key_;
};

json parsed(const std::string& file, const std::string& text) {
  builder value(file);
  json::sax_parse(text, &value);
  return value.take();
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
  static const json& made = *new json(parsed("", R"({
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

bool is_infinity(const json& value) {
  if (!value.is_string()) return false;
  const auto& text = value.get_ref<const std::string&>();
  return text == "inf" || text == "-inf";
}

bool is_like(const json& found, const json& model) {
  if (model.is_null()) return found.is_primitive() && !found.is_boolean();
  if (model.is_number()) return found.is_number() || is_infinity(found);
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
  if (value.is_structured()) return value.is_array() ? "a list" : "an object";
  if (value.is_boolean()) return value.get<bool>() ? "true" : "false";
  if (value.is_number()) return number_text(value.get<double>());
  if (!value.is_string()) return "null";
  const std::string text = quoted_text(value.get_ref<const std::string&>());
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

std::string description_path(const std::string& library) {
  return library.ends_with(".so") ? library.substr(0, library.size() - 3) + ".json" : "";
}

std::optional<description> parse_description(const std::string& file, const std::string& text) {
  json found = parsed(file, text);
  if (!found.is_object() || !found.contains("format") || found["format"] != json(description_format))
    return {};
  check_texts(found, false, file);
  return description{text, std::move(found)};
}

std::optional<description> read_description(const std::string& library) {
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
  const std::string text =
      difference(found, parsed(library, description_text(plugin)), plugin.abi_minor > ILAW_ABI_MINOR, "");
  if (!text.empty())
    refuse(description_path(library),
           text + ": remove the file, or write it anew by ilaw-describe " + library);
}

}  // namespace ilaw::loading
