// read_counterpart.hpp - what the nodes of an interface touch.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "contact/counterpart.hpp"

#include <nlohmann/json.hpp>

#include <memory>
#include <string>

namespace ilaw::host {

// "obstacle" or "against" of an interface between its own nodes and that. Throws SceneError at the
// pointer.
std::unique_ptr<Counterpart> read_counterpart(const nlohmann::json& interface, const NodeSet& own,
                                              const Model& model, const std::string& pointer);

}  // namespace ilaw::host
