// read_thermal.hpp - temperatures of bodies, and what interfaces have of them.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "model/thermal_model.hpp"
#include "scene/scene.hpp"

#include <nlohmann/json.hpp>

#include <memory>
#include <string>

namespace ilaw::host {

// From the `thermal` of the bodies; null where none has it.
std::shared_ptr<const ThermalModel> read_thermal(const nlohmann::json& given, const Model& model);

// Throws where a node has no temperature.
void require_temperatures(const std::vector<int>& nodes, const Model& model, const std::string& pointer);

// The temperatures that an interface hands to its law, where its nodes have any.
void read_contact_heat(const nlohmann::json& interface, const Scene& scene, const std::string& pointer,
                       InterfaceSetup& setup);
// Throws where the law reads the temperature of an obstacle that has none.
void check_obstacle_temperature(const Interface& interface, const std::string& pointer);

}  // namespace ilaw::host
