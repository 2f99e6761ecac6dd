// A scene's text to JSON. A reader of its own, because JSON leaves undefined what a key that comes twice
// means, because of values nested deeper than what goes through them by recursion could stand, and because of
// the points of large scenes (packed_points.hpp).
// SPDX-License-Identifier: BSD-3-Clause
#include "scene/packed_points.hpp"
#include "scene/validation.hpp"

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace ilaw::host {
namespace {

using nlohmann::json;

class Reader : public nlohmann::json_sax<json> {
 public:
  explicit Reader(bool packs) : packs_(packs) {}

  json take() { return std::move(root_); }
  // Whether reading stopped at points that cannot be packed.
  bool cannot_pack() const { return cannot_pack_; }

  bool null() override { return add(json()); }
  bool boolean(bool value) override { return add(value); }
  bool number_integer(number_integer_t value) override { return add_number(value); }
  bool number_unsigned(number_unsigned_t value) override { return add_number(value); }
  bool number_float(number_float_t value, const string_t& /*text*/) override { return add_number(value); }
  bool string(string_t& value) override { return add(std::move(value)); }
  bool binary(binary_t& value) override { return add(std::move(value)); }

  bool start_object(std::size_t /*size*/) override {
    return packer_ ? packed(packer_->start_point()) : open(json::object());
  }
  bool key(string_t& key) override {
    if (packer_) return packed(packer_->key(key));
    json& object = *open_.back();
    if (object.contains(key))
      throw SceneError("", "key '" + key + "' appears twice in one object, expected once");
    slot_ = &object[key];
    key_ = key;
    if (open_.size() == 1) part_ = "/" + key;
    return true;
  }
  bool end_object() override { return packer_ ? packed(packer_->end_point()) : close(); }

  bool start_array(std::size_t /*size*/) override {
    if (packer_) {
      is_in_vector_ = true;
      return packed(packer_->start_vector());
    }
    const bool are_points = packs_ && open_.size() == 2 && open_[1] == model_ && key_ == "points";
    if (are_points) packer_.emplace();
    return open(json::array());
  }
  bool end_array() override {
    if (packer_ && std::exchange(is_in_vector_, false)) return packed(packer_->end_vector());
    if (packer_) *open_.back() = std::move(*std::exchange(packer_, std::nullopt)).packed();
    return close();
  }

  bool parse_error(std::size_t /*at*/, const std::string& /*token*/, const json::exception& error) override {
    throw SceneError(std::string("not valid JSON: ") + error.what());
  }

 private:
  bool packed(bool is_fit) {
    cannot_pack_ = !is_fit;
    return is_fit;
  }
  template <class Number>
  bool add_number(Number value) {
    return packer_ ? packed(packer_->number(static_cast<double>(value))) : add(value);
  }
  bool add(json value) {
    if (packer_) return packed(false);
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
  bool packs_, cannot_pack_ = false, is_in_vector_ = false;
  std::optional<PointPacker> packer_;
};

}  // namespace

json parse_scene(const std::string& text) {
  constexpr std::size_t large = 1 << 18;
  for (const bool packs : {text.size() >= large, false}) {
    Reader reader(packs);
    if (json::sax_parse(text, &reader) || !reader.cannot_pack()) return reader.take();
  }
  return {};
}

}  // namespace ilaw::host
