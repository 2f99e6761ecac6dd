// arguments.hpp - the parameters of a law, as a scene gives them.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "contact/law_arguments.hpp"

#include <nlohmann/json.hpp>

#include <cstddef>
#include <string>

namespace ilaw::host {

// Reads the "parameters" of an interface of node_count nodes. Throws SceneError at the pointer.
Arguments read_arguments(const nlohmann::json& parameters, std::size_t node_count,
                         const std::string& pointer);

}  // namespace ilaw::host
