// random_parameters.hpp - parameters of a law, drawn from what it says of itself: a new law needs
// no edit.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "stress/draw.hpp"

#include <ilaw/ilaw.h>

#include <nlohmann/json.hpp>

namespace ilaw::host {

// As a scene gives them. Times are drawn around the time step dt.
nlohmann::json random_parameters(const ilaw_law& law, double dt, Draw& draw);

}  // namespace ilaw::host
