// pressure.hpp - a pressure on the surface of a body, which follows the surface as it moves.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "model/load.hpp"

#include <array>
#include <vector>

namespace ilaw::host {

// On facets of four nodes, counter-clockwise seen from outside. A node a takes
//   -p int N_a (dx/dxi x dx/deta) dxi deta
// of the deformed facet (Hibbitt 1979): the force is p times the derivative of the volume that a closed
// surface encloses, so that its work is that of p on the volume.
using FacetCorners = Eigen::Matrix<double, 3, 4>;

// The integral of each shape function times the normal over a bilinear facet. A triangle has its last corner
// twice, and both parts of it belong together.
FacetCorners facet_area_vectors(const FacetCorners& x);

class Pressure : public Load {
 public:
  using Facet = std::array<int, 4>;
  Pressure(const Model& model, std::vector<Facet> facets, Table history);
  void add_force(double time, const Dofs& u, Dofs& force) const override;

 private:
  const Model& model_;
  std::vector<Facet> facets_;
  Table history_;
};

}  // namespace ilaw::host
