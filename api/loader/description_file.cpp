// SPDX-License-Identifier: BSD-3-Clause
#include "description_file.hpp"

#include "description_text.hpp"
#include "file.hpp"
#include "readable.hpp"
#include "refusal.hpp"

#include <nlohmann/json.hpp>

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

std::string content_of(const std::string& file) {
  const open_file opened(file);
  const file_status status = opened.status();
  if (!status.regular) refuse(file, "not a regular file, expected a description of a library");
  if (status.size > max_bytes) refuse(file, "larger than 1 MiB, expected a description of a library");
  std::string text(status.size, '\0');
  if (!opened.is_open() || !opened.copy(0, text.data(), text.size())) refuse(file, "the file cannot be read");
  return text;
}

// Builds the value as nlohmann reads it.
class builder : public nlohmann::json_sax<json> {
 public:
  explicit builder(const std::string& file) : file_(file) {}
  json_value take() { return std::move(root_); }

  bool null() override { return add({}), true; }
  bool boolean(bool truth) override { return add({json_value::boolean, truth, 0.0, {}, {}, {}}), true; }
  bool number_integer(number_integer_t value) override { return add_number(static_cast<double>(value)); }
  bool number_unsigned(number_unsigned_t value) override { return add_number(static_cast<double>(value)); }
  bool number_float(number_float_t value, const string_t&) override { return add_number(value); }
  bool string(string_t& letters) override {
    return add({json_value::text, false, 0.0, std::move(letters), {}, {}}), true;
  }
  bool binary(binary_t&) override { return false; }  // not in JSON
  bool start_object(std::size_t) override { return start(json_value::object); }
  bool start_array(std::size_t) override { return start(json_value::list); }
  bool end_object() override { return open_.pop_back(), true; }
  bool end_array() override { return open_.pop_back(), true; }
  bool key(string_t& name) override { return open_.back()->keys.push_back(std::move(name)), true; }
  bool parse_error(std::size_t byte, const std::string&, const json::exception& error) override {
    if (dynamic_cast<const json::out_of_range*>(&error))
      refuse(file_, "a number beyond the range of double, expected infinity as \"inf\"");
    refuse(file_, "no JSON at byte " + std::to_string(byte));
  }

 private:
  json_value& add(json_value&& made) {
    if (open_.empty()) return root_ = std::move(made);
    return open_.back()->elements.emplace_back(std::move(made));
  }
  bool add_number(double value) { return add({json_value::number, false, value, {}, {}, {}}), true; }
  bool start(json_value::kind type) {
    if (open_.size() == max_depth)
      refuse(file_, "nested deeper than " + std::to_string(max_depth) + " levels, expected a description");
    json_value made;
    made.type = type;
    open_.push_back(&add(std::move(made)));
    return true;
  }

  const std::string& file_;
  json_value root_;
  std::vector<json_value*> open_;  // lists and objects that are not complete
};

json_value parsed(const std::string& file, const std::string& text) {
  builder value(file);
  json::sax_parse(text, &value);
  return value.take();
}

// Texts may be printed: UTF-8 without control characters; a doc may have several lines.
void check_texts(const json_value& found, bool lines_allowed, const std::string& file) {
  if (!clean_text(found.letters, lines_allowed)) refuse(file, "a text has control characters");
  for (const std::string& key : found.keys)
    if (!clean_text(key, false)) refuse(file, "a name has control characters");
  for (std::size_t i = 0; i < found.elements.size(); ++i)
    check_texts(found.elements[i], found.type == json_value::object && found.keys[i] == "doc", file);
}

// Every member of a description, each list with one element: 0 stands for a number or "inf", null for any
// text, number or null.
const json_value& model() {
  static const json_value& made = *new json_value(parsed("", R"({
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

const char* name_of(json_value::kind type) {
  static constexpr const char* all[] = {"text or number", "boolean", "number", "text", "list", "object"};
  return all[type];
}

bool is_like(const json_value& found, const json_value& model) {
  const bool is_number = found.type == json_value::number;
  if (model.type == json_value::null)
    return is_number || found.type == json_value::text || found.type == json_value::null;
  if (model.type == json_value::number) return is_number || found.is("inf") || found.is("-inf");
  return found.type == model.type;
}

// ---- comparison -----------------------------------------------------------------------------------------

std::string shown(const json_value& found) {
  constexpr std::size_t max_letters = 60;
  switch (found.type) {
    case json_value::null:
      return "null";
    case json_value::boolean:
      return found.truth ? "true" : "false";
    case json_value::number:
      return number_text(found.value);
    case json_value::text: {
      const std::string text = quoted_text(found.letters);
      return text.size() > max_letters ? text.substr(0, max_letters) + "..." : text;
    }
    case json_value::list:
      return "a list of " + std::to_string(found.elements.size());
    default:
      return "an object";
  }
}

void check_like(const json_value& found, const json_value& model, const std::string& at,
                const std::string& file) {
  if (!is_like(found, model)) refuse(file, at + " is " + shown(found) + ", expected " + name_of(model.type));
  if (model.type == json_value::list)
    for (std::size_t i = 0; i < found.elements.size(); ++i)
      check_like(found.elements[i], model.elements[0], at + "/" + std::to_string(i), file);
  for (std::size_t i = 0; i < model.keys.size(); ++i) {
    const std::string inner = at + "/" + model.keys[i];
    const json_value* member = found.find(model.keys[i]);
    if (!member) refuse(file, inner + " is missing");
    check_like(*member, model.elements[i], inner, file);
  }
}

std::string unequal(const std::string& at, const std::string& found, const std::string& expected) {
  return (at.empty() ? "it" : at) + " is " + found + ", the library says " + expected;
}

std::string difference(const json_value& found, const json_value& library, bool newer, const std::string& at);

std::string difference_of_objects(const json_value& found, const json_value& library, bool newer,
                                  const std::string& at) {
  for (std::size_t i = 0; i < library.keys.size(); ++i) {
    const std::string inner = at + "/" + library.keys[i];
    const json_value* member = found.find(library.keys[i]);
    if (!member) return unequal(inner, "missing", shown(library.elements[i]));
    if (std::string text = difference(*member, library.elements[i], newer, inner); !text.empty()) return text;
  }
  for (std::size_t i = 0; i < found.keys.size(); ++i)
    if (!newer && !library.find(found.keys[i]))
      return unequal(at + "/" + found.keys[i], shown(found.elements[i]), "nothing");
  return "";
}

std::string difference_of_lists(const json_value& found, const json_value& library, bool newer,
                                const std::string& at) {
  // Names of bits: the loader leaves out those that it does not know.
  if (newer && (library.elements.empty() || library.elements[0].type == json_value::text)) {
    for (const json_value& name : library.elements)
      if (std::none_of(found.elements.begin(), found.elements.end(),
                       [&name](const json_value& other) { return other.is(name.letters); }))
        return unequal(at, shown(found) + " without " + shown(name), shown(library));
    return "";
  }
  for (std::size_t i = 0; i < library.elements.size() && i < found.elements.size(); ++i)
    if (std::string text =
            difference(found.elements[i], library.elements[i], newer, at + "/" + std::to_string(i));
        !text.empty())
      return text;
  return found.elements.size() == library.elements.size() ? "" : unequal(at, shown(found), shown(library));
}

// The first difference; empty where there is none. newer: the library has a newer minor version than this
// loader, and its file may have members and names that the loader does not know.
std::string difference(const json_value& found, const json_value& library, bool newer,
                       const std::string& at) {
  if (newer && library.type == json_value::null) return "";
  if (found.type != library.type) return unequal(at, shown(found), shown(library));
  if (found.type == json_value::object) return difference_of_objects(found, library, newer, at);
  if (found.type == json_value::list) return difference_of_lists(found, library, newer, at);
  const bool same =
      found.truth == library.truth && found.value == library.value && found.letters == library.letters;
  return same ? "" : unequal(at, shown(found), shown(library));
}

}  // namespace

const json_value* json_value::find(std::string_view key) const {
  for (std::size_t i = keys.size(); i-- > 0;)
    if (keys[i] == key) return &elements[i];
  return nullptr;
}

std::string description_path(const std::string& library) {
  return library.ends_with(".so") ? library.substr(0, library.size() - 3) + ".json" : "";
}

std::optional<description> parse_description(const std::string& file, const std::string& text) {
  json_value found = parsed(file, text);
  const json_value* format = found.find("format");
  if (!format || !format->is(description_format)) return {};
  check_texts(found, false, file);
  return description{text, std::move(found)};
}

std::optional<description> read_description(const std::string& library) {
  const std::string file = description_path(library);
  if (file.empty() || !status_of(file).exists) return {};
  return parse_description(file, content_of(file));
}

void check_members(const json_value& found, const std::string& file) {
  check_like(found, model(), "", file);
  if (found.find("abi")->elements.size() != 2) refuse(file, "/abi has not two numbers");
}

void check_same(const json_value& found, const ilaw_plugin& plugin, const std::string& library) {
  const std::string text =
      difference(found, parsed(library, description_text(plugin)), plugin.abi_minor > ILAW_ABI_MINOR, "");
  if (!text.empty())
    refuse(description_path(library),
           text + ": remove the file, or write it anew by ilaw-describe " + library);
}

}  // namespace ilaw::loading
