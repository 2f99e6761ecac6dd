// read_pairs.hpp - parameters that depend on which two materials meet, from a table of the scene.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "contact/interface.hpp"

#include <nlohmann/json.hpp>

#include <string>

namespace ilaw::host {

// Adds to the arguments of a setup, whose nodes and counterpart are set, the parameters that the table
// interface["pairs"] of the scene has for the two sides of each node. A side is a set of nodes, or the name
// of the obstacle. Does nothing without that key. Throws SceneError at the pointer of the interface.
void read_pairs(const nlohmann::json& interface, const nlohmann::json& scene, const Model& model,
                const std::string& pointer, InterfaceSetup& setup);

}  // namespace ilaw::host
