// exact_parts.hpp - what exact solutions are made of.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "study/exact.hpp"

#include <string>
#include <vector>

namespace ilaw::host {

// Throws SceneError where a solution does not cover the scene.
[[noreturn]] void refuse(const std::string& expected);
void require(bool good, const std::string& expected);

// Velocity that is constant between instants; displacement is its integral from 0.
ExactNode piecewise(const std::vector<double>& instants, const std::vector<double>& velocities);

}  // namespace ilaw::host
