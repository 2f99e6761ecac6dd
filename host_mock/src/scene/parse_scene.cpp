// A scene's text to JSON. A reader of its own, because JSON leaves undefined what a key that comes twice
// means, because of values nested deeper than what goes through them by recursion could stand, and because of
// the points of large scenes (packed_points.hpp).
// SPDX-License-Identifier: BSD-3-Clause
#include "scene/packed_points.hpp"
#include "scene/validation.hpp"

#include <cstddef>
#include <iterator>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace ilaw::host {
namespace {

using nlohmann::json;

// Characters that a parser takes from a text one by one, while its events may take more of them; the
// default is the end of any text.
class Characters {
 public:
  using iterator_category = std::input_iterator_tag;
  using value_type = char;
  using difference_type = std::ptrdiff_t;
  using pointer = const char*;
  using reference = char;

  Characters() = default;
  explicit Characters(std::string_view& rest) : rest_(&rest) {}
  char operator*() const { return rest_->front(); }
  Characters& operator++() {
    rest_->remove_prefix(1);
    return *this;
  }
  // Of which one is the end.
  bool operator!=(const Characters& end) const { return rest_ != end.rest_ && !rest_->empty(); }

 private:
  std::string_view* rest_ = nullptr;
};

class Reader : public nlohmann::json_sax<json> {
 public:
  // packable: the rest of the text that is read, null where points are not to be packed.
  explicit Reader(std::string_view* packable) : packable_(packable) {}

  json take() { return std::move(root_); }
  // Whether the text must be read in the plain way.
  bool must_read_plainly() const { return must_read_plainly_; }

  bool null() override { return add(json()); }
  bool boolean(bool value) override { return add(value); }
  bool number_integer(number_integer_t value) override { return add(value); }
  bool number_unsigned(number_unsigned_t value) override { return add(value); }
  bool number_float(number_float_t value, const string_t& /*text*/) override { return add(value); }
  bool string(string_t& value) override { return add(std::move(value)); }
  bool binary(binary_t& value) override { return add(std::move(value)); }

  bool start_object(std::size_t /*size*/) override { return open(json::object()); }
  bool key(string_t& key) override {
    json& object = *open_.back();
    if (object.contains(key))
      throw SceneError("", "key '" + key + "' appears twice in one object, expected once");
    slot_ = &object[key];
    key_ = key;
    if (open_.size() == 1) part_ = "/" + key;
    return true;
  }
  bool end_object() override { return close(); }

  // The parser has taken the "[" and no more.
  bool start_array(std::size_t /*size*/) override {
    if (!packable_ || open_.size() != 2 || open_[1] != model_ || key_ != "points") return open(json::array());
    json points = packed_points(*packable_);
    must_read_plainly_ = points.is_null();
    return !must_read_plainly_ && open(std::move(points));
  }
  bool end_array() override { return close(); }

  // The parser counts no lines of what is packed.
  bool parse_error(std::size_t /*at*/, const std::string& /*token*/, const json::exception& error) override {
    if (!packable_) throw SceneError(std::string("not valid JSON: ") + error.what());
    must_read_plainly_ = true;
    return false;
  }

 private:
  bool add(json value) {
    place(std::move(value));
    return true;
  }
  json* place(json value) {
    if (open_.empty()) return &(root_ = std::move(value));
    if (open_.back()->is_array()) return &open_.back()->emplace_back(std::move(value));
    return &(*slot_ = std::move(value));
  }
  bool open(json value) {
    constexpr std::size_t deepest = 64;
    if (open_.size() == deepest)
      throw SceneError(
          part_, "values are nested more than " + std::to_string(deepest) + " deep, expected at most that");
    const bool is_model = open_.size() == 1 && open_.back()->is_object() && key_ == "model";
    open_.push_back(place(std::move(value)));
    if (is_model) model_ = open_.back();
    return true;
  }
  bool close() {
    open_.pop_back();
    return true;
  }

  json root_;
  std::vector<json*> open_;  // objects and arrays, from the outermost on
  json *slot_ = nullptr, *model_ = nullptr;
  std::string key_, part_;  // part_: of the scene, that is read
  std::string_view* packable_;
  bool must_read_plainly_ = false;
};

}  // namespace

json parse_scene(const std::string& text) {
  constexpr std::size_t large = 1 << 18;
  for (const bool packs : {text.size() >= large, false}) {
    std::string_view rest = text;
    Reader reader(packs ? &rest : nullptr);
    if (json::sax_parse(Characters(rest), Characters(), &reader) || !reader.must_read_plainly())
      return reader.take();
  }
  return {};
}

}  // namespace ilaw::host
