// inputs.hpp - what a batch is given at one step, node by node; the same in other axes and forms of H.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "check/trial.hpp"

#include <array>
#include <cstddef>
#include <vector>

namespace ilaw::check {

using Vector = std::array<double, 3>;
using Matrix = std::array<Vector, 3>;  // rows

inline double dot(const Vector& a, const Vector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Vector times(const Matrix& m, const Vector& a);
Matrix transposed(const Matrix& m);
Vector sum(const Vector& a, const Vector& b);
Vector scaled(double factor, const Vector& a);
Vector cross(const Vector& a, const Vector& b);
double length(const Vector& a);

// Velocity and spin, or what an impulse and a moment add to them.
struct Motion {
  Vector velocity{}, spin{};
};

// Values of each node in turn: d components of a vector, as many of H as its form has, one of the others.
// Spins are empty if the form of H has none, v_smooth if this step is not given it.
struct Inputs {
  std::size_t count = 0, dimension = 3, form_width = 1;
  std::uint32_t form = ILAW_DELASSUS_SCALAR;
  double time = 0.0, velocity_step = 0.0, position_step = 0.0;
  std::vector<double> v_free, v_smooth, delassus, gap, gap_offset, v_previous, area, normal, tangent,
      spin_free, spin_previous;
  std::vector<std::vector<double>> per_node;

  Vector vector(const std::vector<double>& of, std::size_t node) const;
  void set_vector(std::vector<double>& of, std::size_t node, const Vector& value) const;
  bool spins() const { return form == ILAW_DELASSUS_TRANSVERSE_SPIN; }
  Vector spin(const std::vector<double>& of, std::size_t node) const;  // 0 without spins
  Matrix h(std::size_t node) const;                                    // in the axes of the vectors
  Matrix j(std::size_t node) const;  // J and k of the form with spins, 0 without
  double k(std::size_t node) const;
  // H r + k n x m, and J m - k n x r.
  Motion gained(std::size_t node, const Vector& r, const Vector& m) const;
  Vector normal_at(std::size_t node) const;
  // g of "out of reach", and whether the node is, by v_free and by v_smooth if given (ilaw.h).
  double slack(std::size_t node) const;
  bool is_out_of_reach(std::size_t node) const;
  std::vector<NamedArray> arrays_of(std::size_t node) const;
  // To the numbers of the setup, so that a batch has what stands here.
  void round_to(const Setup& setup);
};

// The axes carried to another normal by the shortest rotation.
Matrix carried(const Matrix& axes, const Vector& normal);
// From local axes to axes of which each node has its own, with normals and tangents; the form of H becomes
// full where it was diagonal.
Inputs turned(Inputs local, const std::vector<Matrix>& axes);
// The same H in a form that holds it.
Inputs in_form(Inputs given, const Setup& setup);
// All vectors and H turned by one matrix whose rows are orthonormal.
Inputs turned_as_a_whole(Inputs given, const Matrix& rotation);

}  // namespace ilaw::check
