// SPDX-License-Identifier: BSD-3-Clause
#include "block.hpp"

#include <deal.II/base/quadrature_lib.h>
#include <deal.II/dofs/dof_tools.h>
#include <deal.II/fe/fe_q.h>
#include <deal.II/fe/fe_values.h>
#include <deal.II/fe/mapping_q1.h>
#include <deal.II/grid/grid_generator.h>
#include <deal.II/matrix_free/fe_evaluation.h>
#include <deal.II/numerics/data_out.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <set>
#include <stdexcept>
#include <utility>

using namespace dealii;

namespace {
using evaluation = FEEvaluation<3, 1, 2, 3, double>;
}

block::block(const block_options& options)
    : options_(options), mesh_(MPI_COMM_WORLD), element_(FE_Q<3>(1), 3), dofs_(mesh_) {
  make_mesh();
  dofs_.distribute_dofs(element_);
  IndexSet relevant;
  DoFTools::extract_locally_relevant_dofs(dofs_, relevant);
  constraints_.reinit(relevant);
  DoFTools::make_hanging_node_constraints(dofs_, constraints_);
  constraints_.close();
  MatrixFree<3>::AdditionalData data;
  data.tasks_parallel_scheme = decltype(data)::none;
  data.mapping_update_flags = update_gradients | update_values | update_JxW_values;
  cells_.reinit(MappingQ1<3>(), dofs_, constraints_, QGauss<1>(2), data);
  make_nodes();

  // Row sums; hanging nodes give theirs to the nodes between which they hang.
  mass_ = make_vector();
  const double density = options_.density;
  on_cells(
      [density](evaluation& cell) {
        Tensor<1, 3, VectorizedArray<double>> ones;
        for (unsigned c = 0; c < 3; ++c) ones[c] = density;
        for (unsigned q = 0; q < cell.n_q_points; ++q) cell.submit_value(ones, q);
        return EvaluationFlags::values;
      },
      mass_, mass_);
  inverse_mass_ = make_vector();
  for (unsigned i = 0; i < mass_.locally_owned_size(); ++i)
    if (mass_.local_element(i) > 0.0) inverse_mass_.local_element(i) = 1.0 / mass_.local_element(i);
}

void block::make_mesh() {
  std::vector<unsigned> repetitions;
  for (unsigned c = 0; c < 3; ++c)
    repetitions.push_back(std::max(1L, std::lround(options_.size[c] * options_.cells)));
  GridGenerator::subdivided_hyper_rectangle(mesh_, repetitions, options_.corner,
                                            options_.corner + options_.size, true);
  for (unsigned n = 0; n < options_.refinements; ++n) {
    for (const auto& cell : mesh_.active_cell_iterators())
      if (cell->is_locally_owned() && cell->at_boundary(lower_side)) cell->set_refine_flag();
    mesh_.execute_coarsening_and_refinement();
  }
}

// Each owned node once. The three degrees of freedom of a node follow one another and have the same owner.
void block::make_nodes() {
  const IndexSet& owned = dofs_.locally_owned_dofs();
  std::set<unsigned> seen;
  for (const auto& cell : dofs_.active_cell_iterators()) {
    if (!cell->is_locally_owned()) continue;
    for (const unsigned vertex : cell->vertex_indices()) {
      const auto first = cell->vertex_dof_index(vertex, 0);
      if (!owned.is_element(first)) continue;
      if (cell->vertex_dof_index(vertex, 2) != first + 2)
        throw std::logic_error("x, y, z of a node are apart");
      const auto dof = static_cast<unsigned>(owned.index_within_set(first));
      if (seen.insert(dof).second) nodes_.push_back({dof, cell->vertex(vertex)});
    }
  }
}

distributed_vector block::make_vector() const {
  distributed_vector made;
  cells_.initialize_dof_vector(made);
  return made;
}

// Adds over all cells: `operation` submits to the test functions and returns what it submitted.
template <typename Operation>
void block::on_cells(Operation operation, distributed_vector& out, const distributed_vector& in) const {
  const std::function<void(const MatrixFree<3>&, distributed_vector&, const distributed_vector&,
                           const std::pair<unsigned, unsigned>&)>
      local = [&](const auto& cells, auto& sum, const auto& from, const auto& range) {
        evaluation cell(cells);
        for (unsigned k = range.first; k < range.second; ++k) {
          cell.reinit(k);
          cell.read_dof_values(from);
          cell.integrate_scatter(operation(cell), sum);
        }
      };
  distributed_vector source = in;
  cells_.cell_loop(local, out, source, true);
}

void block::forces(const distributed_vector& u, distributed_vector& internal) const {
  const double mu = options_.young / (2.0 * (1.0 + options_.poisson));
  const double lame =
      options_.young * options_.poisson / ((1.0 + options_.poisson) * (1.0 - 2.0 * options_.poisson));
  on_cells(
      [mu, lame](evaluation& cell) {
        cell.evaluate(EvaluationFlags::gradients);
        for (unsigned q = 0; q < cell.n_q_points; ++q) {
          const tensor strain = cell.get_symmetric_gradient(q);
          tensor stress = 2.0 * mu * strain;
          for (unsigned c = 0; c < 3; ++c) stress[c][c] += lame * trace(strain);
          cell.submit_symmetric_gradient(stress, q);
        }
        return EvaluationFlags::gradients;
      },
      internal, u);
}

distributed_vector block::areas(boundary_id side) const {
  distributed_vector sum = make_vector();
  const QGauss<2> points(2);
  FEFaceValues<3> face(element_, points, update_values | update_JxW_values);
  Vector<double> of_cell(element_.dofs_per_cell);
  std::vector<types::global_dof_index> indices(element_.dofs_per_cell);
  for (const auto& cell : dofs_.active_cell_iterators()) {
    if (!cell->is_locally_owned()) continue;
    for (const unsigned f : cell->face_indices()) {
      if (!cell->face(f)->at_boundary() || cell->face(f)->boundary_id() != side) continue;
      face.reinit(cell, f);
      of_cell = 0.0;
      for (unsigned i = 0; i < of_cell.size(); ++i)
        for (unsigned q = 0; q < points.size(); ++q) of_cell[i] += face.shape_value(i, q) * face.JxW(q);
      cell->get_dof_indices(indices);
      constraints_.distribute_local_to_global(of_cell, indices, sum);
    }
  }
  sum.compress(VectorOperation::add);
  return sum;
}

std::vector<std::array<Point<3>, 4>> block::facets(boundary_id side) const {
  std::vector<std::array<Point<3>, 4>> found;
  for (const auto& cell : dofs_.active_cell_iterators()) {
    if (!cell->is_locally_owned()) continue;
    for (const unsigned f : cell->face_indices()) {
      const auto face = cell->face(f);
      if (!face->at_boundary() || face->boundary_id() != side) continue;
      std::array<Point<3>, 4> around{{face->vertex(0), face->vertex(1), face->vertex(3), face->vertex(2)}};
      const double up = cross_product_3d(around[1] - around[0], around[3] - around[0])[2];
      if ((up > 0.0) != (side == upper_side)) std::reverse(around.begin(), around.end());
      found.push_back(around);
    }
  }
  return found;
}

// 2/omega of the fastest oscillation by the power method, to two digits: the same on any number of ranks.
double block::critical_step() const {
  distributed_vector w = make_vector(), forced = make_vector();
  for (const node& at : nodes_)
    for (unsigned c = 0; c < 3; ++c)
      w.local_element(at.dof + c) = std::sin(1e3 * (at.place[0] + 2 * at.place[1] + 3 * at.place[2]) + c);
  double square = 0.0;
  for (int n = 0; n < 60; ++n) {
    forces(w, forced);
    forced.scale(inverse_mass_);
    square = forced.l2_norm();
    w.equ(1.0 / square, forced);
  }
  char digits[32];
  std::snprintf(digits, sizeof digits, "%.1e", 1.96 / std::sqrt(square));
  return std::strtod(digits, nullptr);
}

void block::write(const distributed_vector& u, const distributed_vector& nodal,
                  const std::vector<std::string>& names, const std::string& folder) const {
  IndexSet relevant;
  DoFTools::extract_locally_relevant_dofs(dofs_, relevant);
  const auto ghosted = [&](const distributed_vector& owned) {
    distributed_vector made(dofs_.locally_owned_dofs(), relevant, MPI_COMM_WORLD);
    made.copy_locally_owned_data_from(owned);
    constraints_.distribute(made);
    made.update_ghost_values();
    return made;
  };
  const distributed_vector shown = ghosted(u), values = ghosted(nodal);
  using kind = DataComponentInterpretation::DataComponentInterpretation;
  const std::vector<kind> is_vector(3, DataComponentInterpretation::component_is_part_of_vector);
  const std::vector<kind> is_scalar(3, DataComponentInterpretation::component_is_scalar);
  DataOut<3> out;
  out.attach_dof_handler(dofs_);
  out.add_data_vector(shown, std::vector<std::string>(3, "displacement"), DataOut<3>::type_dof_data,
                      is_vector);
  out.add_data_vector(values, names, DataOut<3>::type_dof_data, is_scalar);
  out.build_patches();
  out.write_vtu_in_parallel(folder + "/block.vtu", MPI_COMM_WORLD);
}
