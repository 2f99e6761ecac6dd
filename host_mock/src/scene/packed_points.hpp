// packed_points.hpp - the points of a large scene as numbers in a row. As JSON objects a million of
// them take 600 MB and seconds to check; packed, they stand in the scene as one binary value.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "model/points.hpp"

#include <nlohmann/json.hpp>

#include <string_view>
#include <vector>

namespace ilaw::host {

// Takes the elements of an array "points" from the beginning of a text, and leaves its "]" there.
// They must be what the schema allows, in the form that most scenes have: the same number of
// components throughout, and no springs. Where they are not, null comes back: the scene is then
// read in the plain way, which also says what is wrong.
nlohmann::json packed_points(std::string_view& text);

// Whether points, as they stand in a scene, are packed; then they can be had as objects again.
bool are_packed(const nlohmann::json& points);
std::vector<PointMass> unpacked(const nlohmann::json& points);
// The scene with this in the place of its packed points; as it is where none are.
nlohmann::json with_packed_points_as(const nlohmann::json& scene, const nlohmann::json& stand_in);

}  // namespace ilaw::host
