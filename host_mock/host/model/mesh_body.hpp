// mesh_body.hpp - the elements of one solid body: 8-node hexahedra and 4-node tetrahedra with constant
// strain.
//
// Hexahedra have full 2x2x2 integration: it has no zero-energy modes, so no hourglass stiffness to choose,
// whose value would show in every convergence table. They lock as Poisson's ratio goes to 1/2; with the
// element's mean dilatation in place of that of each integration point they do not. In a box all are equal:
// shape gradients are computed once, and a linear box keeps one 24x24 stiffness.
//
// With mean dilatation a hexahedron has the mean of its element, a tetrahedron the means at its nodes: the
// volume of the elements around a node, over the undeformed one, replaces that of the element,
//   E = sum_a sum_e V_e/4 W((J_a/J_e)^(1/3) F_e),  J_a = sum_e V_e J_e / sum_e V_e,
// over the nodes a of each element e (Bonet and Burton 1998, average nodal pressure; here by the same energy
// as a hexahedron's). Constant strain alone locks as Poisson's ratio goes to 1/2.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "model/material.hpp"
#include "model/mesh_topology.hpp"
#include "model/model.hpp"

#include <array>
#include <vector>

namespace ilaw::host {

// Gradients of the shape functions at the integration points of an undeformed element, and their volumes.
template <int N, int P>
struct SolidElement {
  std::array<int, N> nodes;  // of the model
  std::array<Eigen::Matrix<double, 3, N>, P> gradients;
  std::array<double, P> weights;
  double volume;
};
using Hexahedron = SolidElement<8, 8>;
using Tetrahedron = SolidElement<4, 1>;

// The element of nodes in VTK's order. Throws MeshError where it is inverted.
Hexahedron hexahedron_of(const std::array<int, 8>& nodes, const Dofs& position);
Tetrahedron tetrahedron_of(const std::array<int, 4>& nodes, const Dofs& position);

template <int N, int P>
class DeformedElement;

class MeshBody {
 public:
  // position: of the whole model, where the body's nodes begin at first. Throws MeshError.
  MeshBody(const MeshTopology& topology, const Dofs& position, int first, const Material& material,
           Element element);

  bool is_linear() const { return material_.law == MaterialLaw::linear; }
  // Adds the lumped mass of the elements.
  void add_mass(Dofs& mass) const;
  // Threads give the bits of one: in a box every second layer of elements at a time, each layer by one
  // thread; else elements write forces of their own, which nodes sum in a fixed order.
  void add_internal_forces(const Dofs& u, Dofs& force) const;
  void add_potential(const Dofs& u, double& sum) const;
  // Cauchy's stress of each element, appended.
  void add_stresses(const Dofs& u, std::vector<Eigen::Matrix3d>& of_hexahedra,
                    std::vector<Eigen::Matrix3d>& of_tetrahedra) const;
  void add_volume_elements(std::vector<VolumeElement>& all) const;
  // From the largest eigenvalue of each element, which bounds that of the whole (Irons and Treharne 1971).
  // Mean dilatation makes it no smaller: it lowers the energy of every motion (Jensen).
  double critical_step() const;

  // Their nodes in the model.
  const std::vector<std::array<int, 8>>& hexahedra() const { return hexahedra_; }
  const std::vector<Tetrahedron>& tetrahedra() const { return tetrahedra_; }

 private:
  // A dilatation, its pressure and the distortion that belongs to it, at a node.
  struct NodalDilatation {
    double dilatation = 0.0, pressure = 0.0;
  };
  using CornerForces = Eigen::Matrix<double, 3, 8>;
  bool is_box() const { return layer_ > 0; }
  bool keeps_stiffness() const { return is_box() && is_linear(); }
  const Hexahedron& shape(std::size_t hexahedron) const { return shapes_[is_box() ? 0 : hexahedron]; }
  DeformedElement<8, 8> deformed_hexahedron(std::size_t number, const Dofs& u) const;
  CornerForces hexahedron_force(std::size_t number, const Dofs& u) const;
  double hexahedron_energy(std::size_t number, const Dofs& u) const;
  void add_box_forces(const Dofs& u, Dofs& force) const;
  bool averages_at_nodes() const { return element_ == Element::mean_dilatation && !tetrahedra_.empty(); }
  template <class Visit>
  void for_each_corner(int node, Visit visit) const;
  void find_nodal_dilatations(const Dofs& u) const;
  double mean_distortion(int node) const;
  Eigen::Matrix3d nodal_stress(std::size_t tetrahedron) const;
  double nodal_energy(const Dofs& u) const;
  void index_corners();

  int first_;
  Material material_;
  Element element_;
  std::size_t layer_;  // elements of a layer of a box; 0: no box
  int node_count_;
  std::vector<std::array<int, 8>> hexahedra_;
  std::vector<Hexahedron> shapes_;           // of each hexahedron; in a box one for all
  Eigen::Matrix<double, 24, 24> stiffness_;  // of a hexahedron of a box
  std::vector<Tetrahedron> tetrahedra_;
  // Columns of corner_forces_ by node: those of hexahedra, then those of tetrahedra.
  std::vector<std::size_t> first_corner_, corners_;
  // Scratch of add_internal_forces, which one thread calls at a time.
  mutable Eigen::Matrix3Xd corner_forces_;
  mutable std::vector<NodalDilatation> nodal_;
  mutable std::vector<Eigen::Matrix3d> tetrahedron_gradients_;  // F, or the displacement gradient if linear
};

}  // namespace ilaw::host
