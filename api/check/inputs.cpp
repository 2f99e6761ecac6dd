// SPDX-License-Identifier: BSD-3-Clause
#include "check/inputs.hpp"

#include <algorithm>

namespace ilaw::check {
namespace {

// Places of the entries of a full H: its diagonal, then 01, 02, 12.
constexpr std::array<std::array<std::size_t, 2>, 3> off_diagonal{{{0, 1}, {0, 2}, {1, 2}}};

std::size_t couplings(std::size_t d) { return d * (d - 1) / 2; }

Matrix transverse(const Vector& n, double normal, double tangential) {
  return tangential * Matrix::Identity() + (normal - tangential) * n * n.transpose();
}

void set_full(Inputs& in, std::size_t node, const Matrix& m) {
  const std::size_t d = in.dimension;
  double* values = &in.delassus[node * in.form_width];
  for (std::size_t c = 0; c < d; ++c) values[c] = m(c, c);
  for (std::size_t k = 0; k < couplings(d); ++k) values[d + k] = m(off_diagonal[k][0], off_diagonal[k][1]);
}

void turn(Inputs& in, std::vector<double> Inputs::*of, std::size_t node, const Matrix& by) {
  if (!(in.*of).empty()) in.set_vector(in.*of, node, by * in.vector(in.*of, node));
}

double handedness(const Matrix& axes) { return axes.determinant() < 0.0 ? -1.0 : 1.0; }

// Spins are axial.
void turn_motion(Inputs& in, std::size_t node, const Matrix& by) {
  for (const auto of : {&Inputs::v_free, &Inputs::v_smooth, &Inputs::v_previous}) turn(in, of, node, by);
  for (const auto of : {&Inputs::spin_free, &Inputs::spin_previous}) turn(in, of, node, handedness(by) * by);
}

}  // namespace

Vector vector_of(const std::vector<double>& values, std::size_t node, std::size_t dimension) {
  Vector a = Vector::Zero();
  for (std::size_t c = 0; c < dimension; ++c) a[c] = values[node * dimension + c];
  return a;
}

Wrench wrench_of(const std::vector<double>& linear, const std::vector<double>& angular, std::size_t node,
                 std::size_t dimension) {
  Wrench both = Wrench::Zero();
  both.head<3>() = vector_of(linear, node, dimension);
  if (!angular.empty()) both.tail<3>() = vector_of(angular, node, dimension);
  return both;
}

void Inputs::set_vector(std::vector<double>& of, std::size_t node, const Vector& value) const {
  for (std::size_t c = 0; c < dimension; ++c) of[node * dimension + c] = value[c];
}

Vector Inputs::normal_at(std::size_t node) const {
  return normal.empty() ? Vector(Vector::UnitX()) : vector(normal, node);
}

Matrix Inputs::h(std::size_t node) const {
  const double* values = &delassus[node * form_width];
  if (form == ILAW_DELASSUS_TRANSVERSE || spins()) return transverse(normal_at(node), values[0], values[1]);
  Matrix m = Matrix::Identity();
  for (std::size_t c = 0; c < 3; ++c)
    if (form == ILAW_DELASSUS_SCALAR || c < dimension) m(c, c) = values[form == ILAW_DELASSUS_SCALAR ? 0 : c];
  if (form == ILAW_DELASSUS_FULL)
    for (std::size_t k = 0; k < couplings(dimension); ++k) {
      const auto [a, b] = off_diagonal[k];
      m(a, b) = m(b, a) = values[dimension + k];
    }
  return m;
}

Eigen::Matrix<double, 6, 6> Inputs::gain(std::size_t node) const {
  Eigen::Matrix<double, 6, 6> all = Eigen::Matrix<double, 6, 6>::Zero();
  all.topLeftCorner<3, 3>() = h(node);
  if (!spins()) return all;
  const double* values = &delassus[node * form_width];
  const Vector n = normal_at(node), kn = values[2] * n;
  all.bottomRightCorner<3, 3>() = transverse(n, values[3], values[4]);
  all.topRightCorner<3, 3>() << 0.0, -kn[2], kn[1], kn[2], 0.0, -kn[0], -kn[1], kn[0], 0.0;
  all.bottomLeftCorner<3, 3>() = -all.topRightCorner<3, 3>();
  return all;
}

double Inputs::slack(std::size_t node) const {
  return gap_offset.empty() ? gap[node] : gap[node] - gap_offset[node];
}

bool Inputs::is_out_of_reach(std::size_t node) const {
  const double g = slack(node);
  const Vector n = normal_at(node);
  const auto stays_open = [&](const Vector& v) {
    const double along = normal.empty() ? v[0] : (n[0] * v[0] + n[1] * v[1]) + n[2] * v[2];
    return g > 0.0 && g + position_step * along > 0.0;
  };
  return stays_open(vector(v_free, node)) && (v_smooth.empty() || stays_open(vector(v_smooth, node)));
}

void Inputs::round_to(const Setup& setup) {
  for (const NodeArray& array : node_arrays)
    for (double& value : this->*array.values) value = setup.rounded(value);
}

std::vector<NamedArray> Inputs::arrays_of(std::size_t node) const {
  std::vector<NamedArray> arrays{
      {"time, velocity_step, position_step", {time, velocity_step, position_step}}};
  const auto add = [&](const char* name, const std::vector<double>& values) {
    if (!values.empty()) arrays.push_back({name, picked(values, {node}, count)});
  };
  for (const NodeArray& array : node_arrays) add(array.name, this->*array.values);
  for (const std::vector<double>& values : per_node) add("per_node_parameters", values);
  return arrays;
}

Inputs Inputs::of_nodes(const std::vector<std::size_t>& nodes) const {
  Inputs own = *this;
  own.count = nodes.size();
  for (const NodeArray& array : node_arrays) own.*array.values = picked(this->*array.values, nodes, count);
  for (std::vector<double>& values : own.per_node) values = picked(values, nodes, count);
  return own;
}

Matrix carried(const Matrix& axes, const Vector& normal) {
  const Vector middle = axes.col(0) + normal;
  Matrix out = axes - (2.0 / middle.squaredNorm()) * middle * (middle.transpose() * axes);
  out.col(0) = normal;
  return out;
}

Inputs turned(Inputs in, const std::vector<Matrix>& axes) {
  std::vector<Matrix> h;
  for (std::size_t i = 0; i < in.count; ++i) h.push_back(axes[i] * in.h(i) * axes[i].transpose());
  if (in.form == ILAW_DELASSUS_DIAGONAL) {
    in.form = ILAW_DELASSUS_FULL;
    in.form_width = in.dimension * (in.dimension + 1) / 2;
    in.delassus.assign(in.count * in.form_width, 0.0);
  }
  in.normal.resize(in.count * in.dimension);
  in.tangent.resize(in.count * in.dimension);
  for (std::size_t i = 0; i < in.count; ++i) {
    turn_motion(in, i, axes[i]);
    in.set_vector(in.normal, i, axes[i].col(0));
    in.set_vector(in.tangent, i, axes[i].col(1));
    if (in.form == ILAW_DELASSUS_FULL) set_full(in, i, h[i]);
  }
  return in;
}

Inputs in_form(Inputs in, const Setup& setup) {
  std::vector<Matrix> h;
  for (std::size_t i = 0; i < in.count; ++i) h.push_back(in.h(i));
  in.form = setup.form;
  in.form_width = setup.form_width();
  in.delassus.assign(in.count * in.form_width, 0.0);
  for (std::size_t i = 0; i < in.count; ++i) {
    double* values = &in.delassus[i * in.form_width];
    if (in.form == ILAW_DELASSUS_FULL)
      set_full(in, i, h[i]);
    else  // of a scalar H: all entries are alike
      std::fill_n(values, in.form_width, h[i](0, 0));
  }
  in.round_to(setup);
  return in;
}

Inputs turned_as_a_whole(Inputs in, const Matrix& rotation) {
  for (std::size_t i = 0; i < in.count; ++i) {
    turn_motion(in, i, rotation);
    for (const auto of : {&Inputs::normal, &Inputs::tangent}) turn(in, of, i, rotation);
    if (in.form == ILAW_DELASSUS_FULL) set_full(in, i, rotation * in.h(i) * rotation.transpose());
  }
  return in;
}

Wrench turned(const Matrix& rotation, const Wrench& wrench) {
  Wrench image;
  image << rotation * wrench.head<3>(), handedness(rotation) * rotation * wrench.tail<3>();
  return image;
}

}  // namespace ilaw::check
