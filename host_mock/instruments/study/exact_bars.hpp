// exact_bars.hpp - elastic bars on walls, on planes, on each other, glued.
// Derivations: docs/theory/shipped_scenes.md.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "study/exact.hpp"

#include <vector>

namespace ilaw::host {

ExactNode bar_on_wall(const Scene& scene);
ExactNode bouncing_bar(const Scene& scene);
ExactNode held_rod(const Scene& scene);
ExactNode glued_bar(const Scene& scene);
std::vector<ExactNode> two_bars(const Scene& scene);

}  // namespace ilaw::host
