// box.hpp - boxes of equal hexahedra, as bodies with a mesh.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "model/solids.hpp"

namespace ilaw::host {

struct BoxSetup {
  std::string name;
  Eigen::Vector3d corner, size, velocity;
  std::array<int, 3> elements;
  Material material;
  Element element;
};

// Sets of box "b": "b", and its faces "b.x_min", "b.x_max", ... "b.z_max" with their areas and facets.
MeshSetup box_of(const BoxSetup& setup);

}  // namespace ilaw::host
