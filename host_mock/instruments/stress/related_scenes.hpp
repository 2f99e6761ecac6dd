// related_scenes.hpp - scenes made from another one, whose motion follows from the motion there.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "scene/scene.hpp"

#include <nlohmann/json.hpp>

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace ilaw::host {

// Its components along axis[c] with sign[c] are the components c of the first scene, in these units.
struct RelatedScene {
  nlohmann::json source;
  std::vector<std::vector<int>> nodes = {{}};  // images of all nodes; an empty one keeps their numbers
  std::array<int, 3> axis = {0, 1, 2};
  std::array<double, 3> sign = {1.0, 1.0, 1.0};
  double length = 1.0, time = 1.0;  // units
  double begin = 0.0;               // time of its start
  double farthest = 0.0;            // how far it lies from the first one
  std::string excuse = {};          // a refusal of the related scene that says so is right

  bool is_excused(const std::string& refusal) const {
    return !excuse.empty() && refusal.find(excuse) != std::string::npos;
  }
};

struct Relation {
  const char* name;
  bool rounds_places;  // gaps of nothing may become some by rounding, and the other way round
  // read: the same scene, read. Nothing if the scene cannot be written so.
  std::optional<RelatedScene> (*make)(const nlohmann::json& source, const Scene& read);
};

std::span<const Relation> relations();

// Masses, positions, velocities, loads and radii off by one rounding: what follows from that tells how well a
// scene determines its motion. Places are off by a rounding of the farthest one, or by more than those that
// the host takes for none (even seeds); if that is 0, each by its own, so that zeros stay.
nlohmann::json nudged(nlohmann::json source, double farthest, std::uint64_t seed);

}  // namespace ilaw::host
