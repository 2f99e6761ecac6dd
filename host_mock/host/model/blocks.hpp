// blocks.hpp - boxes of 8-node hexahedra (3D), linear elastic or compressible neo-Hookean with
// large displacements.
//
// Full 2x2x2 integration: it has no zero-energy modes, so no hourglass stiffness to choose, whose
// value would show in every convergence table. It locks as Poisson's ratio goes to 1/2; with the
// element's mean dilatation in place of that of each integration point it does not. All elements of
// a box are alike, so shape gradients are computed once; a linear box keeps one 24x24 stiffness for
// all its elements. Matrix-free otherwise.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "model/material.hpp"
#include "model/model.hpp"

#include <cstdint>

namespace ilaw::host {

struct BlockSetup {
  std::string name;
  Eigen::Vector3d corner, size, velocity;
  std::array<int, 3> elements;
  Material material;
  Element element;
};

// Sets of block "b": "b", and its faces "b.x_min", "b.x_max", ... "b.z_max" with their areas and
// facets.
class Blocks : public Model {
 public:
  explicit Blocks(const std::vector<BlockSetup>& blocks);

  bool has_internal_forces() const override { return true; }
  bool is_linear() const override;
  // Threads give the bits of one: every second layer of elements at a time, each layer by one
  // thread.
  void add_internal_forces(const Dofs& u, Dofs& force) const override;
  double potential(const Dofs& u) const override;
  std::vector<Eigen::Matrix3d> stresses(const Dofs& u) const override;
  // From the largest eigenvalue of one element, which bounds that of the whole (Irons and Treharne
  // 1971). Mean dilatation makes it no smaller: it lowers the energy of every motion (Jensen).
  double critical_step() const override { return critical_step_; }
  bool critical_step_is_exact() const override { return false; }

 private:
  using ElementVector = Eigen::Matrix<double, 24, 1>;
  using ElementMatrix = Eigen::Matrix<double, 24, 24>;
  using Gradients = Eigen::Matrix<double, 3, 8>;  // of the shape functions at an integration point

  // State of an element with mean dilatation: F at the integration points, det F, and s of material.hpp.
  struct Deformation {
    std::array<Eigen::Matrix3d, 8> gradients;
    std::array<double, 8> volumes, scales;
    MeanDilatation solid;

    double distortion(std::size_t g) const { return scales[g] * gradients[g].squaredNorm(); }
  };

  struct Block {
    int first;                    // node
    std::array<int, 3> elements;  // along x, y, z
    int layer_axis;               // the longest, for threads
    Material material;
    Element element;
    std::array<Gradients, 8> gradients;
    double weight;  // volume of an integration point
    ElementMatrix stiffness;
    std::array<int, 8> corners;  // nodes of an element, from its first

    std::int64_t element_count() const { return std::int64_t{elements[0]} * elements[1] * elements[2]; }
    int element_first(const std::array<int, 3>& at) const;
    // Displacements relative to the first node: rounding then grows with strain, not with how far a
    // block has moved.
    ElementVector gather(const Dofs& u, int element_first) const;
    ElementVector internal_force(const ElementVector& u) const;
    double energy(const ElementVector& u) const;
    ElementVector mean_dilatation_force(const ElementVector& u) const;
    Deformation deformation(const ElementVector& u) const;
    Eigen::Matrix3d mean_stress(const ElementVector& u) const;
    // Calls visit(first node) for the elements of a layer.
    template <class Visit>
    void for_each_element(int layer, Visit visit) const;
  };

  static Block make_block(const BlockSetup& setup, int first);
  static double critical_step_of(const Block& block);
  void add_cells(const Block& block);

  std::vector<Block> blocks_;
  double critical_step_;
};

}  // namespace ilaw::host
