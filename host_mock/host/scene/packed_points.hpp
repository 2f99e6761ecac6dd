// packed_points.hpp - the points of a large scene as numbers in a row. As JSON objects a million of
// them take 600 MB and seconds to check; packed, they stand in the scene as one binary value.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "model/points.hpp"

#include <nlohmann/json.hpp>

#include <cstdint>
#include <string>
#include <vector>

namespace ilaw::host {

// Takes what a parser finds inside the array "points" of a model. Every function returns whether it
// is what the schema allows, in the form that most scenes have: the same number of components
// throughout, and no springs. Where it is not, the scene is read in the plain way, which also says
// what is wrong.
class PointPacker {
 public:
  bool start_point();
  bool key(const std::string& name);
  bool start_vector();
  bool number(double value);
  bool end_vector();
  bool end_point();

  nlohmann::json packed() && { return nlohmann::json::binary(std::move(bytes_)); }

 private:
  enum Field { mass, area, position, velocity, field_count };

  std::vector<std::uint8_t> bytes_;
  std::size_t width_ = 0;  // components of a vector
  bool in_point_ = false, in_vector_ = false;
  int field_ = field_count;
  std::size_t sizes_[field_count] = {};
  double values_[field_count][3] = {};
};

// Whether points, as they stand in a scene, are packed; then they can be had as objects again.
bool are_packed(const nlohmann::json& points);
std::vector<PointMass> unpacked(const nlohmann::json& points);
// The scene with this in the place of its packed points; as it is where none are.
nlohmann::json with_packed_points_as(const nlohmann::json& scene, const nlohmann::json& stand_in);

}  // namespace ilaw::host
