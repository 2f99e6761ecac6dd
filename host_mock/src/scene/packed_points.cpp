// SPDX-License-Identifier: BSD-3-Clause
#include "scene/packed_points.hpp"

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <iterator>
#include <string>
#include <utility>

namespace ilaw::host {
namespace {

using nlohmann::json;

bool is_digit(char c) { return c >= '0' && c <= '9'; }

// A point is its mass, area, position and velocity; the number of its components stands before all.
class PointPacker {
 public:
  explicit PointPacker(std::string_view text) : text_(text) {}

  // Whether all elements up to the end of the array are points that can be packed.
  bool pack() {
    const std::size_t length = text_.size();
    if (!take_point() || !append_point()) return false;
    bytes_.reserve(bytes_.size() * (1 + length / (length - text_.size())));  // all are as long as the first
    while (take(','))
      if (!take_point() || !append_point()) return false;
    return take_space() == ']';
  }

  std::string_view rest() const { return text_; }
  std::vector<std::uint8_t> bytes() && { return std::move(bytes_); }

 private:
  enum Field { mass, area, position, velocity, field_count };

  // Gives what follows white space; 0 at the end.
  char take_space() {
    std::size_t k = 0;
    while (k < text_.size() && (text_[k] == ' ' || text_[k] == '\n' || text_[k] == '\t' || text_[k] == '\r'))
      ++k;
    text_.remove_prefix(k);
    return text_.empty() ? '\0' : text_.front();
  }
  bool take(char sign) {
    if (take_space() != sign) return false;
    text_.remove_prefix(1);
    return true;
  }

  bool take_point() {
    std::fill(std::begin(sizes_), std::end(sizes_), 0);
    if (!take('{')) return false;
    do {
      const int field = take_key();
      if (field == field_count || sizes_[field] > 0 || !take(':')) return false;
      if (!(field < position ? take_number(field) : take_vector(field))) return false;
    } while (take(','));
    return take('}');
  }

  // field_count: it is none that a packed point has.
  int take_key() {
    static constexpr std::string_view names[field_count] = {"mass", "area", "position", "velocity"};
    if (!take('"')) return field_count;
    const std::string_view name = text_.substr(0, text_.find('"'));
    text_.remove_prefix(std::min(text_.size(), name.size() + 1));
    return static_cast<int>(std::find(std::begin(names), std::end(names), name) - std::begin(names));
  }

  bool take_vector(int field) {
    if (!take('[')) return false;
    do
      if (sizes_[field] == 3 || !take_number(field)) return false;
    while (take(','));
    return take(']');
  }

  // JSON (RFC 8259, section 6) has fewer forms of numbers than from_chars, and -0 is an integer.
  bool take_number(int field) {
    take_space();
    double& value = values_[field][sizes_[field]++];
    const auto [end, error] = std::from_chars(text_.data(), text_.data() + text_.size(), value);
    if (error != std::errc()) return false;
    const std::string_view form = text_.substr(0, static_cast<std::size_t>(end - text_.data()));
    const std::string_view digits = form.substr(form.front() == '-' ? 1 : 0);
    if (!is_digit(digits.front()) || (digits.size() > 1 && digits[0] == '0' && is_digit(digits[1])))
      return false;
    const std::size_t dot = form.find('.');
    if (dot != std::string_view::npos && (dot + 1 == form.size() || !is_digit(form[dot + 1]))) return false;
    if (form == "-0") value = 0.0;
    text_.remove_prefix(form.size());
    return true;
  }

  void append(const double* values, std::size_t count) {
    const std::size_t end = bytes_.size(), more = count * sizeof(double);
    bytes_.resize(end + more);
    std::memcpy(bytes_.data() + end, values, more);
  }

  bool append_point() {
    if (bytes_.empty()) {
      width_ = sizes_[position];
      const auto width = static_cast<double>(width_);
      append(&width, 1);
    }
    if (sizes_[area] == 0) values_[area][0] = 1.0;
    if (sizes_[velocity] == 0) std::fill_n(values_[velocity], 3, 0.0);
    const bool is_whole = sizes_[mass] == 1 && width_ > 0 && sizes_[position] == width_ &&
                          (sizes_[velocity] == 0 || sizes_[velocity] == width_);
    if (!is_whole || !(values_[mass][0] > 0.0) || !(values_[area][0] >= 0.0)) return false;
    append(values_[mass], 1);
    append(values_[area], 1);
    append(values_[position], width_);
    append(values_[velocity], width_);
    return true;
  }

  std::string_view text_;
  std::vector<std::uint8_t> bytes_;
  std::size_t width_ = 0;  // components of a vector
  std::size_t sizes_[field_count] = {};
  double values_[field_count][3] = {};
};

}  // namespace

json packed_points(std::string_view& text) {
  PointPacker packer(text);
  if (!packer.pack()) return {};
  text = packer.rest();
  return json::binary(std::move(packer).bytes());
}

bool are_packed(const json& points) { return points.is_binary(); }

std::vector<PointMass> unpacked(const json& points) {
  const std::vector<std::uint8_t>& bytes = points.get_binary();
  std::size_t next = 0;
  const auto take = [&] {
    double value = 0.0;
    std::memcpy(&value, &bytes[next], sizeof value);
    next += sizeof value;
    return value;
  };
  const auto width = static_cast<Eigen::Index>(take());
  const auto take_vector = [&] {
    Vector vector(width);
    for (double& component : vector) component = take();
    return vector;
  };
  std::vector<PointMass> all;
  all.reserve(bytes.size() / (sizeof(double) * (2 + 2 * static_cast<std::size_t>(width))));
  while (next < bytes.size()) {
    const double mass = take(), area = take();
    const Vector position = take_vector();
    all.push_back({mass, area, position, take_vector(), Vector()});
  }
  return all;
}

json with_packed_points_as(const json& scene, const json& stand_in) {
  if (!scene.is_object() || !scene.contains("model") || !scene["model"].contains("points") ||
      !are_packed(scene["model"]["points"]))
    return scene;
  json copy = json::object();
  for (const auto& [key, value] : scene.items())
    if (key != "model") copy[key] = value;
  for (const auto& [key, value] : scene["model"].items())
    copy["model"][key] = key == "points" ? stand_in : value;
  return copy;
}

}  // namespace ilaw::host
