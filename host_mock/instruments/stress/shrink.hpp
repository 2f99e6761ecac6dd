// shrink.hpp - a small scene from a large one that fails.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nlohmann/json.hpp>

#include <functional>

namespace ilaw::host {

// Tries to leave out loads, points, interfaces and parameters, to shorten the run and to round numbers,
// as long as the scene still fails. Ends where nothing can be left out, or after that many tries.
nlohmann::json shrink(nlohmann::json scene, const std::function<bool(const nlohmann::json&)>& fails,
                      int most_tries);

}  // namespace ilaw::host
