// SPDX-License-Identifier: BSD-3-Clause
#include "scene/packed_points.hpp"

#include <algorithm>
#include <cstring>

namespace ilaw::host {

using nlohmann::json;

// A point is its mass, area, position and velocity; the number of its components stands before all.

bool PointPacker::start_point() {
  std::fill(std::begin(sizes_), std::end(sizes_), 0);
  field_ = field_count;
  return !std::exchange(in_point_, true);
}

bool PointPacker::key(const std::string& name) {
  static const std::string names[field_count] = {"mass", "area", "position", "velocity"};
  field_ = static_cast<int>(std::find(std::begin(names), std::end(names), name) - std::begin(names));
  return in_point_ && field_ < field_count && sizes_[field_] == 0;
}

bool PointPacker::start_vector() {
  return field_ != field_count && field_ >= position && !std::exchange(in_vector_, true);
}

bool PointPacker::number(double value) {
  if (field_ == field_count || in_vector_ != (field_ >= position) || sizes_[field_] == 3) return false;
  values_[field_][sizes_[field_]++] = value;
  return true;
}

bool PointPacker::end_vector() {
  field_ = field_count;
  return std::exchange(in_vector_, false);
}

bool PointPacker::end_point() {
  in_point_ = false;
  const auto append = [this](const double* values, std::size_t count) {
    const std::size_t end = bytes_.size(), more = count * sizeof(double);
    bytes_.resize(end + more);
    std::memcpy(bytes_.data() + end, values, more);
  };
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
