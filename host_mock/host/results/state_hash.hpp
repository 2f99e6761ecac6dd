// state_hash.hpp - a hash of the state that a run has reached, to compare runs on different computers.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "scene/scene.hpp"
#include "step/integrator.hpp"

#include <string>

namespace ilaw::host {

// FNV-1a (Fowler, Noll, Vo) of 64 bits, as 16 hexadecimal digits, over the bytes of doubles, the least
// significant first: displacements, velocities, temperatures, and per interface the nodes and states of the
// contacts whose state may have changed. -0 counts as 0, and every NaN as the same one.
std::string state_hash(const Scene& scene, const Integrator& integrator);

}  // namespace ilaw::host
