// elements.hpp - what the elements of a mesh tell where something goes wrong.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/vector.hpp"
#include "model/model.hpp"

#include <string>

namespace ilaw::host {

// The least scaled Jacobian of the corners of a tetrahedron or hexahedron (4 or 8 corners, in VTK's order),
// and its corner: the triple product of the unit vectors along the edges there, times sqrt(2) in a
// tetrahedron.
struct CornerQuality {
  double scaled_jacobian;
  int corner;
};
CornerQuality worst_corner(const Eigen::Vector3d* corners, int count);

// The shortest edge of the undeformed mesh; infinite without a mesh.
double shortest_edge(const Model& model);

// Elements that are turned inside out at the displacements u, by number.
std::vector<int> inverted_elements(const Model& model, const Dofs& u);

// The first element that is turned inside out at the displacements u, and where it was; -1: none.
struct InvertedElement {
  int number = -1;
  Vector centre;  // undeformed
};
InvertedElement first_inverted(const Model& model, const Dofs& u);

// Cause and cure of a motion that diverged with a step, as the end of a sentence: its beginning is
// there already.
std::string advice_on_divergence(const Model& model, const Dofs& u, double dt);

}  // namespace ilaw::host
