// sharp_nodes.hpp - the nodes of a face at which constraints of another face that are averaged over facets do
// not hold it: at its border, and where its facets meet at a large angle.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "model/model.hpp"

namespace ilaw::host {

struct SharpNodes {
  NodeSet set;                 // without facets
  double shortest_edge = 0.0;  // of the face
};
SharpNodes sharp_nodes_of(const NodeSet& face, const Model& model);

}  // namespace ilaw::host
