// elements.hpp - what the elements of a mesh tell where something goes wrong.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/vector.hpp"
#include "model/model.hpp"

#include <string>

namespace ilaw::host {

// Of the undeformed mesh; infinite without one.
double shortest_edge(const Model& model);

// Elements that are turned inside out at the displacements u, by number.
std::vector<int> inverted_elements(const Model& model, const Dofs& u);

// The first element that is turned inside out at the displacements u, and where it was; -1: none.
struct InvertedElement {
  int number = -1;
  Vector centre;  // undeformed
};
InvertedElement first_inverted(const Model& model, const Dofs& u);

// What a motion that diverged with a step tells of its cause and of the cure: the beginning of a
// sentence is there already.
std::string advice_on_divergence(const Model& model, const Dofs& u, double dt);

}  // namespace ilaw::host
