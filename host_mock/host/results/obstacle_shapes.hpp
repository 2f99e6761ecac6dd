// obstacle_shapes.hpp - the rigid obstacles of a scene as surfaces to look at.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "scene/scene.hpp"

#include <vtkUnstructuredGrid.h>

namespace ilaw::host {

bool has_obstacles(const Scene& scene);
bool has_moving_obstacles(const Scene& scene);

// Planes as squares of twice the size of all bodies, spheres, and cylinders of that length, each
// where it is at a time; in 2D lines and circles, in 1D points. The cell array "interface" has the
// number of the interface that a cell belongs to.
void add_obstacles(vtkUnstructuredGrid& grid, const Scene& scene, double time);

}  // namespace ilaw::host
