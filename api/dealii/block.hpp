// block.hpp - an elastic block for explicit dynamics in deal.II: lumped masses and internal forces on ranks
// of MPI.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <deal.II/distributed/tria.h>
#include <deal.II/dofs/dof_handler.h>
#include <deal.II/fe/fe_system.h>
#include <deal.II/lac/affine_constraints.h>
#include <deal.II/lac/la_parallel_vector.h>
#include <deal.II/matrix_free/matrix_free.h>

#include <array>
#include <string>
#include <vector>

using dealii::Point;
using dealii::types::boundary_id;
using distributed_vector = dealii::LinearAlgebra::distributed::Vector<double>;

struct block_options {
  Point<3> size{2.0, 1.0, 0.5}, corner;
  unsigned cells = 4;        // along an edge of length 1
  unsigned refinements = 0;  // of the cells at the plane; the nodes between fine and coarse cells hang
  double young = 100.0, poisson = 0.3, density = 1.0;
};

// Hexahedra of 8 nodes, small strains. Every rank calls every function.
class block {
 public:
  static constexpr boundary_id pulled_side = 1, lower_side = 4, upper_side = 5;  // largest x; along z

  explicit block(const block_options& options);

  // A node that this rank owns: its first degree of freedom in the local vectors (y and z follow), and its
  // place.
  struct node {
    unsigned dof;
    Point<3> place;
  };
  const std::vector<node>& nodes() const { return nodes_; }
  const distributed_vector& mass() const { return mass_; }                  // 0 at hanging nodes
  const distributed_vector& inverse_mass() const { return inverse_mass_; }  // 0 at hanging nodes

  distributed_vector make_vector() const;
  void forces(const distributed_vector& u, distributed_vector& internal) const;
  distributed_vector areas(boundary_id side) const;  // integral of each shape function over a side
  // Places of the corners of the facets of the lower or upper side that this rank has, each on one rank,
  // counterclockwise as seen from outside.
  std::vector<std::array<Point<3>, 4>> facets(boundary_id side) const;
  double critical_step() const;
  // FOLDER/block.vtu: displacements, and a nodal vector whose components have the given names.
  void write(const distributed_vector& u, const distributed_vector& nodal,
             const std::vector<std::string>& names, const std::string& folder) const;

 private:
  using tensor = dealii::SymmetricTensor<2, 3, dealii::VectorizedArray<double>>;
  template <typename Operation>
  void on_cells(Operation operation, distributed_vector& out, const distributed_vector& in) const;
  void make_mesh();
  void make_nodes();

  block_options options_;
  dealii::parallel::distributed::Triangulation<3> mesh_;
  dealii::FESystem<3> element_;
  dealii::DoFHandler<3> dofs_;
  dealii::AffineConstraints<double> constraints_;
  dealii::MatrixFree<3> cells_;
  distributed_vector mass_, inverse_mass_;
  std::vector<node> nodes_;
};
