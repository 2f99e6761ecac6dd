// inputs.hpp - what a batch is given at one step, node by node; the same in other axes and forms of H.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "check/trial.hpp"

#include <Eigen/Dense>

#include <array>
#include <cstddef>
#include <numeric>
#include <vector>

namespace ilaw::check {

using Vector = Eigen::Vector3d;
using Matrix = Eigen::Matrix3d;
// A velocity and a spin, or an impulse and a moment.
using Wrench = Eigen::Matrix<double, 6, 1>;

Vector vector_of(const std::vector<double>& values, std::size_t node, std::size_t dimension);
// 0 without spins.
Wrench wrench_of(const std::vector<double>& linear, const std::vector<double>& angular, std::size_t node,
                 std::size_t dimension);

// Values of each node in turn: d components of a vector, as many of H as its form has, one of the others.
// Spins are empty if the form of H has none, v_smooth if this step is not given it.
struct Inputs {
  std::size_t count = 0, dimension = 3, form_width = 1;
  std::uint32_t form = ILAW_DELASSUS_SCALAR;
  double time = 0.0, velocity_step = 0.0, position_step = 0.0;
  std::vector<double> v_free, v_smooth, delassus, gap, gap_offset, v_previous, area, normal, tangent,
      spin_free, spin_previous;
  std::vector<std::vector<double>> per_node;

  Vector vector(const std::vector<double>& of, std::size_t node) const {
    return vector_of(of, node, dimension);
  }
  void set_vector(std::vector<double>& of, std::size_t node, const Vector& value) const;
  bool spins() const { return form == ILAW_DELASSUS_TRANSVERSE_SPIN; }
  Wrench free(std::size_t node) const { return wrench_of(v_free, spin_free, node, dimension); }
  Wrench previous(std::size_t node) const { return wrench_of(v_previous, spin_previous, node, dimension); }
  Matrix h(std::size_t node) const;  // in the axes of the vectors
  // From (r, m) to (H r + k n x m, J m - k n x r), the last 0 without spins.
  Eigen::Matrix<double, 6, 6> gain(std::size_t node) const;
  Vector normal_at(std::size_t node) const;
  // g of "out of reach", and whether the node is, by v_free and by v_smooth if given (ilaw.h).
  double slack(std::size_t node) const;
  bool is_out_of_reach(std::size_t node) const;
  std::vector<NamedArray> arrays_of(std::size_t node) const;
  Inputs of_nodes(const std::vector<std::size_t>& nodes) const;
  // To the numbers of the setup, so that a batch has what stands here.
  void round_to(const Setup& setup);
};

// The arrays of a batch with numbers of each node, but for parameters; asked: by which bit of the inputs.
// Some steps may be given an optional one and others not.
struct NodeArray {
  const char* name;
  std::vector<double> Inputs::*values;
  ilaw_input ilaw_batch::*given;
  std::uint32_t asked = 0;
  bool is_optional = false;
};
inline constexpr std::array node_arrays{
    NodeArray{"v_free", &Inputs::v_free, &ilaw_batch::v_free},
    NodeArray{"v_smooth", &Inputs::v_smooth, &ilaw_batch::v_smooth, ILAW_INPUT_V_SMOOTH, true},
    NodeArray{"delassus", &Inputs::delassus, &ilaw_batch::delassus},
    NodeArray{"gap", &Inputs::gap, &ilaw_batch::gap, ILAW_INPUT_GAP},
    NodeArray{"gap_offset", &Inputs::gap_offset, &ilaw_batch::gap_offset, ILAW_INPUT_GAP, true},
    NodeArray{"v_previous", &Inputs::v_previous, &ilaw_batch::v_previous, ILAW_INPUT_V_PREVIOUS},
    NodeArray{"area", &Inputs::area, &ilaw_batch::area, ILAW_INPUT_AREA},
    NodeArray{"normal", &Inputs::normal, &ilaw_batch::normal, ILAW_INPUT_NORMAL},
    NodeArray{"tangent", &Inputs::tangent, &ilaw_batch::tangent, ILAW_INPUT_TANGENT},
    NodeArray{"spin_free", &Inputs::spin_free, &ilaw_batch::spin_free},
    NodeArray{"spin_previous", &Inputs::spin_previous, &ilaw_batch::spin_previous, ILAW_INPUT_V_PREVIOUS}};

inline std::vector<std::size_t> numbers_below(std::size_t count) {
  std::vector<std::size_t> all(count);
  std::iota(all.begin(), all.end(), std::size_t{0});
  return all;
}

// The values of some nodes out of those of "count".
template <class Number>
std::vector<Number> picked(const std::vector<Number>& values, const std::vector<std::size_t>& nodes,
                           std::size_t count) {
  std::vector<Number> own;
  const std::size_t width = count > 0 ? values.size() / count : 0;
  for (const std::size_t node : nodes)
    for (std::size_t c = 0; c < width; ++c) own.push_back(values[node * width + c]);
  return own;
}

// Axes are the columns of a matrix: a normal and its tangents.

// The axes carried to another normal by the shortest rotation.
Matrix carried(const Matrix& axes, const Vector& normal);
// From local axes to axes of which each node has its own, with normals and tangents; the form of H becomes
// full where it was diagonal.
Inputs turned(Inputs local, const std::vector<Matrix>& axes);
// The same H in a form that holds it.
Inputs in_form(Inputs given, const Setup& setup);
// All vectors and H turned by one matrix, or mirrored, which changes the sign of axial vectors.
Inputs turned_as_a_whole(Inputs given, const Matrix& rotation);
Wrench turned(const Matrix& rotation, const Wrench& wrench);

}  // namespace ilaw::check
