// SPDX-License-Identifier: BSD-3-Clause
#include "check/inputs.hpp"

#include <algorithm>
#include <cmath>

namespace ilaw::check {
namespace {

// Places of the entries of a full H: its diagonal, then 01, 02, 12.
constexpr std::array<std::array<std::size_t, 2>, 3> off_diagonal{{{0, 1}, {0, 2}, {1, 2}}};

std::size_t couplings(std::size_t d) { return d * (d - 1) / 2; }

Matrix outer(const Vector& n, double normal, double tangential) {
  Matrix m{};
  for (std::size_t a = 0; a < 3; ++a)
    for (std::size_t b = 0; b < 3; ++b)
      m[a][b] = (normal - tangential) * n[a] * n[b] + (a == b ? tangential : 0.0);
  return m;
}

void set_full(Inputs& in, std::size_t node, const Matrix& m) {
  const std::size_t d = in.dimension;
  double* values = &in.delassus[node * in.form_width];
  for (std::size_t c = 0; c < d; ++c) values[c] = m[c][c];
  for (std::size_t k = 0; k < couplings(d); ++k) values[d + k] = m[off_diagonal[k][0]][off_diagonal[k][1]];
}

// Vectors of the motion, in the axes of each node or of the host.
constexpr std::array motions{&Inputs::v_free, &Inputs::v_smooth, &Inputs::v_previous, &Inputs::spin_free,
                             &Inputs::spin_previous};

void turn(Inputs& in, std::vector<double> Inputs::*of, std::size_t node, const Matrix& by) {
  if (!(in.*of).empty()) in.set_vector(in.*of, node, times(by, in.vector(in.*of, node)));
}

// Q^T m Q for the rows of Q as axes.
Matrix from_axes(const Matrix& m, const Matrix& axes) {
  Matrix out{};
  for (std::size_t a = 0; a < 3; ++a)
    for (std::size_t b = 0; b < 3; ++b)
      for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j) out[a][b] += axes[i][a] * m[i][j] * axes[j][b];
  return out;
}

}  // namespace

Matrix transposed(const Matrix& m) {
  return {Vector{m[0][0], m[1][0], m[2][0]}, {m[0][1], m[1][1], m[2][1]}, {m[0][2], m[1][2], m[2][2]}};
}

Vector times(const Matrix& m, const Vector& a) { return {dot(m[0], a), dot(m[1], a), dot(m[2], a)}; }
double length(const Vector& a) { return std::sqrt(dot(a, a)); }
Vector sum(const Vector& a, const Vector& b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }
Vector scaled(double factor, const Vector& a) { return {factor * a[0], factor * a[1], factor * a[2]}; }
Vector cross(const Vector& a, const Vector& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

Vector vector_of(const std::vector<double>& values, std::size_t node, std::size_t dimension) {
  Vector a{};
  for (std::size_t c = 0; c < dimension; ++c) a[c] = values[node * dimension + c];
  return a;
}
void Inputs::set_vector(std::vector<double>& of, std::size_t node, const Vector& value) const {
  for (std::size_t c = 0; c < dimension; ++c) of[node * dimension + c] = value[c];
}

Vector Inputs::normal_at(std::size_t node) const {
  return normal.empty() ? Vector{1.0, 0.0, 0.0} : vector(normal, node);
}

Matrix Inputs::h(std::size_t node) const {
  const double* values = &delassus[node * form_width];
  if (form == ILAW_DELASSUS_TRANSVERSE || spins()) return outer(normal_at(node), values[0], values[1]);
  Matrix m{};
  for (std::size_t c = 0; c < 3; ++c)
    m[c][c] = form == ILAW_DELASSUS_SCALAR ? values[0] : c < dimension ? values[c] : 1.0;
  if (form == ILAW_DELASSUS_FULL)
    for (std::size_t k = 0; k < couplings(dimension); ++k) {
      const auto [a, b] = off_diagonal[k];
      m[a][b] = m[b][a] = values[dimension + k];
    }
  return m;
}

Vector Inputs::spin(const std::vector<double>& of, std::size_t node) const {
  return of.empty() ? Vector{} : vector(of, node);
}

Matrix Inputs::j(std::size_t node) const {
  const double* values = &delassus[node * form_width];
  return spins() ? outer(normal_at(node), values[3], values[4]) : Matrix{};
}

double Inputs::k(std::size_t node) const { return spins() ? delassus[node * form_width + 2] : 0.0; }

Motion Inputs::gained(std::size_t node, const Vector& r, const Vector& m) const {
  Motion gain{times(h(node), r), {}};
  if (!spins()) return gain;
  const Vector n = normal_at(node);
  gain.velocity = sum(gain.velocity, scaled(k(node), cross(n, m)));
  gain.spin = sum(times(j(node), m), scaled(-k(node), cross(n, r)));
  return gain;
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
  const Vector m{axes[0][0] + normal[0], axes[0][1] + normal[1], axes[0][2] + normal[2]};
  Matrix out{normal, axes[1], axes[2]};
  for (std::size_t row = 1; row < 3; ++row) {
    const double part = 2.0 * dot(axes[row], m) / dot(m, m);
    for (std::size_t c = 0; c < 3; ++c) out[row][c] -= part * m[c];
  }
  return out;
}

Inputs turned(Inputs in, const std::vector<Matrix>& axes) {
  std::vector<Matrix> h;
  for (std::size_t i = 0; i < in.count; ++i) h.push_back(from_axes(in.h(i), axes[i]));
  if (in.form == ILAW_DELASSUS_DIAGONAL) {
    in.form = ILAW_DELASSUS_FULL;
    in.form_width = in.dimension * (in.dimension + 1) / 2;
    in.delassus.assign(in.count * in.form_width, 0.0);
  }
  in.normal.resize(in.count * in.dimension);
  in.tangent.resize(in.count * in.dimension);
  for (std::size_t i = 0; i < in.count; ++i) {
    const Matrix to_host = transposed(axes[i]);
    for (const auto of : motions) turn(in, of, i, to_host);
    in.set_vector(in.normal, i, axes[i][0]);
    in.set_vector(in.tangent, i, axes[i][1]);
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
      std::fill_n(values, in.form_width, h[i][0][0]);
  }
  in.round_to(setup);
  return in;
}

Inputs turned_as_a_whole(Inputs in, const Matrix& rotation) {
  const Matrix back = transposed(rotation);
  for (std::size_t i = 0; i < in.count; ++i) {
    for (const auto of : motions) turn(in, of, i, rotation);
    for (const auto of : {&Inputs::normal, &Inputs::tangent}) turn(in, of, i, rotation);
    if (in.form == ILAW_DELASSUS_FULL) set_full(in, i, from_axes(in.h(i), back));
  }
  return in;
}

}  // namespace ilaw::check
