// warnings.hpp - what a scene can run with, but can hardly mean.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "scene/scene.hpp"

namespace ilaw::host {

// Times at which nothing can happen any more.
void warn_of_times(Scene& scene);
// Nodes that start inside a rigid obstacle or beyond their partners: most laws throw them out of it.
void warn_of_start(Scene& scene);
// Bodies on the wrong side of a plane.
void warn_of_side(Scene& scene);
// Bonds across a gap, which pull from afar.
void warn_of_open_bonds(Scene& scene);
// Partners of nodes that stand twice in a list, or that do not face their nodes.
void warn_of_partners(Scene& scene);
// Bonds that remember less than two steps.
void warn_of_memory(Scene& scene);
// Blocks that can hardly bend: full elements close to incompressibility.
void warn_of_locking(Scene& scene);
// Temperatures of obstacles that no law reads.
void warn_of_temperatures(Scene& scene);

}  // namespace ilaw::host
