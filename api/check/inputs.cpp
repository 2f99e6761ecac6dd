// SPDX-License-Identifier: BSD-3-Clause
#include "check/inputs.hpp"

#include "check/sandbox.hpp"

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

// Q^T m Q for the rows of Q as axes.
Matrix from_axes(const Matrix& m, const Matrix& axes) {
  Matrix out{};
  for (std::size_t a = 0; a < 3; ++a)
    for (std::size_t b = 0; b < 3; ++b)
      for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j) out[a][b] += axes[i][a] * m[i][j] * axes[j][b];
  return out;
}

Vector unit(const Vector& a) {
  const double size = length(a);
  return {a[0] / size, a[1] / size, a[2] / size};
}

// Positive definite: a diagonal with couplings smaller than its least entry over two.
void draw_delassus(Inputs& in, std::size_t node, bool isotropic, Draw& draw) {
  double* values = &in.delassus[node * in.form_width];
  const std::size_t d = in.form == ILAW_DELASSUS_SCALAR ? 1 : in.dimension;
  const double one = draw.within(0.5, 2.0);
  if (in.form == ILAW_DELASSUS_TRANSVERSE || in.spins()) {
    values[0] = one;
    values[1] = isotropic ? one : draw.within(0.5, 2.0);
    if (!in.spins()) return;
    values[3] = draw.within(0.5, 2.0);
    values[4] = draw.within(0.5, 2.0);
    values[2] = draw.within(-0.95, 0.95) * std::sqrt(values[1] * values[4]);  // k^2 < h_T j_T
    return;
  }
  for (std::size_t c = 0; c < d; ++c) values[c] = isotropic ? one : draw.within(0.5, 2.0);
  for (std::size_t c = d; c < in.form_width; ++c) values[c] = isotropic ? 0.0 : draw.within(-0.2, 0.2);
}

double draw_gap(double step, Draw& draw) {
  if (draw.one_in(10)) return 0.0;
  return draw.one_in(8) ? draw.within(5.0, 2000.0) * step : draw.within(-2.0, 2.0) * step;
}

// In which steps a law that asks for it is given v_smooth.
enum class Smooth { in_none, in_all, in_every_second };
Smooth draw_smooth_steps(const Trial& trial, Draw& draw) {
  if (!trial.reads(ILAW_INPUT_V_SMOOTH)) return Smooth::in_none;
  return std::array{Smooth::in_none, Smooth::in_all, Smooth::in_every_second}[draw.below(3)];
}

Inputs empty_inputs(const Trial& trial, std::size_t count) {
  Inputs in;
  in.count = count;
  in.dimension = trial.setup.dimension;
  in.form = trial.setup.form;
  in.form_width = trial.setup.form_width();
  const std::size_t vectors = count * in.dimension;
  for (std::vector<double>* values : {&in.v_free, &in.v_previous}) values->resize(vectors);
  if (trial.setup.spins())
    for (std::vector<double>* values : {&in.spin_free, &in.spin_previous}) values->resize(vectors);
  in.delassus.resize(count * in.form_width);
  for (std::vector<double>* values : {&in.gap, &in.gap_offset, &in.area}) values->resize(count);
  if (trial.setup.global()) in.normal.resize(vectors);
  if (trial.setup.has_tangent) in.tangent.resize(vectors);
  in.per_node.assign(trial.info.per_node_parameter_count, std::vector<double>(count));
  return in;
}

// Most values are of the size of the constant, so that nodes differ, but not in all that happens to them.
double draw_near(const ilaw_parameter& p, double constant, Draw& draw) {
  const double value = constant * draw.within(0.5, 2.0);
  const bool anywhere = draw.one_in(4) || !std::isfinite(constant) || constant == 0.0;
  if (anywhere || p.kind == ILAW_KIND_INTEGER || !in_range(p, value)) return draw_value(p, draw).number;
  return value;
}

// Parameters of a node that the law accepts as constants, or those of the trial.
void draw_parameters(Inputs& in, std::size_t node, const Trial& trial, Draw& draw) {
  constexpr int attempts = 8;
  const auto set = [&](const auto& value_of) {
    for (std::uint32_t k = 0; k < trial.info.per_node_parameter_count; ++k) {
      const char* name = trial.info.per_node_parameters[k];
      in.per_node[k][node] = trial.setup.rounded(
          value_of(*parameter_of(trial.law, name), number_of(trial.law, trial.values, name)));
    }
  };
  for (int k = 0; k < attempts; ++k) {
    set([&](const ilaw_parameter& p, double constant) { return draw_near(p, constant, draw); });
    if (create(trial.law, trial.setup, constants_of(trial, in, node))) return;
  }
  set([](const ilaw_parameter&, double constant) { return constant; });
}

// Draws the inputs that belong to the nodes and stay the same.
void draw_fixed(Inputs& in, const Trial& trial, Draw& draw) {
  const bool has_offset = draw.one_in(2);
  for (std::size_t i = 0; i < in.count; ++i) {
    in.area[i] = draw.within(0.5, 2.0);
    in.gap_offset[i] = has_offset ? draw.within(-1e-2, 1e-2) : 0.0;
    const Matrix axes = draw_axes(in.dimension, draw);
    if (!in.normal.empty()) in.set_vector(in.normal, i, axes[0]);
    if (!in.tangent.empty()) in.set_vector(in.tangent, i, axes[1]);
  }
  if (trial.info.per_node_parameter_count == 0) return;
  constexpr std::size_t most_drawn = 32;  // each is an instance made; further nodes have them again
  for (std::size_t i = 0; i < std::min(in.count, most_drawn); ++i) draw_parameters(in, i, trial, draw);
  for (std::vector<double>& values : in.per_node)
    for (std::size_t i = most_drawn; i < in.count; ++i) values[i] = values[i - most_drawn];
  set_setting(trial.text());  // which create has changed
}

// In the host's axes normals turn, and tangents with them.
void turn_axes(Inputs& in, Draw& draw) {
  for (std::size_t i = 0; !in.normal.empty() && i < in.count; ++i) {
    const Vector turned = draw_turned(in.normal_at(i), in.dimension, draw);
    if (!in.tangent.empty())
      in.set_vector(in.tangent, i, carried({in.normal_at(i), in.vector(in.tangent, i), Vector{}}, turned)[1]);
    in.set_vector(in.normal, i, turned);
  }
}

void draw_spin(Inputs& in, std::size_t node, double part, bool without_force, Draw& draw) {
  const Vector last = in.vector(in.spin_free, node);
  Vector w{}, before{};
  for (std::size_t c = 0; c < in.dimension; ++c) {
    w[c] = part != 0.0 ? part * last[c] : draw.within(-1.0, 1.0);
    before[c] = without_force ? w[c] : draw.within(-1.0, 1.0);
  }
  in.set_vector(in.spin_free, node, w);
  in.set_vector(in.spin_previous, node, before);
}

// A node of a path goes on as it did, or turns back, or anywhere.
void draw_motion(Inputs& in, bool isotropic, bool without_force, bool is_path, Draw& draw) {
  for (std::size_t i = 0; i < in.count; ++i) {
    const Vector n = in.normal_at(i), last = in.vector(in.v_free, i);
    const double part = !is_path || draw.one_in(4) ? 0.0 : draw.one_in(3) ? -1.0 : 1.0;
    Vector v{}, before{};
    for (std::size_t c = 0; c < in.dimension; ++c) {
      v[c] = part != 0.0 ? part * last[c] : draw.within(-1.0, 1.0) - 0.2 * n[c];
      before[c] = without_force ? v[c] : draw.within(-1.0, 1.0);
    }
    in.set_vector(in.v_free, i, v);
    in.set_vector(in.v_previous, i, before);
    if (in.spins()) draw_spin(in, i, part, without_force, draw);
    in.gap[i] = in.gap_offset[i] + draw_gap(in.position_step, draw);
    draw_delassus(in, i, isotropic, draw);
  }
}

}  // namespace

void draw_smooth(Inputs& in, Draw& draw) {
  in.v_smooth = in.v_free;
  for (std::size_t i = 0; i < in.count; ++i) {
    if (draw.one_in(4)) continue;
    Vector v = in.vector(in.v_previous, i);
    if (!draw.one_in(4)) {
      const Vector n = in.normal_at(i);
      for (std::size_t c = 0; c < in.dimension; ++c) v[c] = draw.within(-1.0, 1.0) - 0.2 * n[c];
    }
    in.set_vector(in.v_smooth, i, v);
  }
}

Values constants_of(const Trial& trial, const Inputs& in, std::size_t node) {
  Values values = trial.values;
  for (std::uint32_t k = 0; k < trial.info.per_node_parameter_count; ++k)
    values = with(values, {trial.info.per_node_parameters[k], ILAW_KIND_VALUE_NUMBER, in.per_node[k][node]});
  return values;
}

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

Vector Inputs::vector(const std::vector<double>& of, std::size_t node) const {
  Vector a{};
  for (std::size_t c = 0; c < dimension; ++c) a[c] = of[node * dimension + c];
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
  for (std::vector<double>* values : {&v_free, &v_smooth, &delassus, &gap, &gap_offset, &v_previous, &area,
                                      &normal, &tangent, &spin_free, &spin_previous})
    for (double& value : *values) value = setup.rounded(value);
}

std::vector<NamedArray> Inputs::arrays_of(std::size_t node) const {
  std::vector<NamedArray> arrays{
      {"time, velocity_step, position_step", {time, velocity_step, position_step}}};
  const auto add = [&](const char* name, const std::vector<double>& values, std::size_t width) {
    if (values.size() < (node + 1) * width) return;
    const auto first = values.begin() + static_cast<std::ptrdiff_t>(node * width);
    arrays.push_back({name, {first, first + static_cast<std::ptrdiff_t>(width)}});
  };
  add("v_free", v_free, dimension);
  add("v_smooth", v_smooth, dimension);
  add("delassus", delassus, form_width);
  add("gap", gap, 1);
  add("gap_offset", gap_offset, 1);
  add("v_previous", v_previous, dimension);
  add("area", area, 1);
  add("normal", normal, dimension);
  add("tangent", tangent, dimension);
  add("spin_free", spin_free, dimension);
  add("spin_previous", spin_previous, dimension);
  for (const std::vector<double>& values : per_node) add("per_node_parameters", values, 1);
  return arrays;
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

Vector draw_turned(const Vector& normal, std::size_t dimension, Draw& draw) {
  if (dimension == 1) return normal;
  Vector turned = normal;
  for (std::size_t c = 0; c < dimension; ++c) turned[c] += draw.within(-0.4, 0.4);
  return unit(turned);
}

Matrix draw_axes(std::size_t dimension, Draw& draw) {
  if (dimension == 1)
    return {Vector{draw.one_in(2) ? 1.0 : -1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}};
  if (dimension == 2) {
    const double angle = draw.within(-3.1, 3.1), c = std::cos(angle), s = std::sin(angle);
    return {Vector{c, s, 0.0}, {-s, c, 0.0}, {0.0, 0.0, 1.0}};
  }
  const auto one = [&] { return draw.within(-1.0, 1.0); };
  const Vector n = unit({one() + 1e-3, one(), one()});
  Vector t = std::abs(n[0]) < 0.7 ? Vector{1.0, one(), one()} : Vector{one(), 1.0, one()};
  for (int pass = 0; pass < 2; ++pass) {  // the second takes off what the first left by rounding
    const double along = dot(n, t);
    for (std::size_t c = 0; c < 3; ++c) t[c] -= along * n[c];
    t = unit(t);
  }
  return {n, t, Vector{n[1] * t[2] - n[2] * t[1], n[2] * t[0] - n[0] * t[2], n[0] * t[1] - n[1] * t[0]}};
}

Script draw_script(const Trial& trial, Draw& draw, const ScriptSize& size, bool isotropic) {
  Script script;
  Inputs in = empty_inputs(trial, size.nodes);
  draw_fixed(in, trial, draw);
  const bool same_steps = draw.one_in(2), without_force = draw.one_in(2), alike = isotropic || draw.one_in(4),
             is_path = !draw.one_in(3);
  const Smooth smooth = draw_smooth_steps(trial, draw);
  for (std::size_t k = 0; k < size.steps; ++k) {
    in.velocity_step = 0x1p-10 * (same_steps ? 1.0 : draw.within(0.5, 1.5));
    in.position_step = 0x1p-10 * (same_steps ? 1.0 : draw.within(0.5, 1.5));
    in.time += in.velocity_step;
    if (k > 0 && is_path) turn_axes(in, draw);
    draw_motion(in, alike, without_force, k > 0 && is_path, draw);
    in.v_smooth.clear();
    if (smooth == Smooth::in_all || (smooth == Smooth::in_every_second && k % 2 == 1)) draw_smooth(in, draw);
    in.round_to(trial.setup);
    script.push_back(in);
  }
  return script;
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
    for (std::vector<double> Inputs::*of : {&Inputs::v_free, &Inputs::v_smooth, &Inputs::v_previous,
                                            &Inputs::spin_free, &Inputs::spin_previous})
      if (!(in.*of).empty()) in.set_vector(in.*of, i, times(to_host, in.vector(in.*of, i)));
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
    for (std::vector<double> Inputs::*of :
         {&Inputs::v_free, &Inputs::v_smooth, &Inputs::v_previous, &Inputs::normal, &Inputs::tangent,
          &Inputs::spin_free, &Inputs::spin_previous})
      if (!(in.*of).empty()) in.set_vector(in.*of, i, times(rotation, in.vector(in.*of, i)));
    if (in.form == ILAW_DELASSUS_FULL) set_full(in, i, from_axes(in.h(i), back));
  }
  return in;
}

}  // namespace ilaw::check
