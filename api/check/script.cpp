// SPDX-License-Identifier: BSD-3-Clause
#include "check/script.hpp"

#include "check/sandbox.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace ilaw::check {
namespace {

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
    if (!in.normal.empty()) in.set_vector(in.normal, i, axes.col(0));
    if (!in.tangent.empty()) in.set_vector(in.tangent, i, axes.col(1));
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
    if (!in.tangent.empty()) {
      Matrix axes;
      axes << in.normal_at(i), in.vector(in.tangent, i), Vector::Zero();
      in.set_vector(in.tangent, i, carried(axes, turned).col(1));
    }
    in.set_vector(in.normal, i, turned);
  }
}

void draw_spin(Inputs& in, std::size_t node, double part, bool without_force, Draw& draw) {
  const Vector last = in.vector(in.spin_free, node);
  Vector w = Vector::Zero(), before = w;
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
    Vector v = Vector::Zero(), before = v;
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

Part kept;

// Those of "chosen" that are below count; all where none was chosen, the first where none is left.
std::vector<std::size_t> chosen_below(std::size_t count, const std::vector<std::size_t>& chosen) {
  std::vector<std::size_t> all = numbers_below(count);
  if (chosen.empty()) return all;
  std::erase_if(all,
                [&](std::size_t k) { return std::find(chosen.begin(), chosen.end(), k) == chosen.end(); });
  return all.empty() ? std::vector<std::size_t>{0} : all;
}

}  // namespace

void keep_part(const Part& part) { kept = part; }

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

Vector draw_turned(const Vector& normal, std::size_t dimension, Draw& draw) {
  if (dimension == 1) return normal;
  Vector turned = normal;
  for (std::size_t c = 0; c < dimension; ++c) turned[c] += draw.within(-0.4, 0.4);
  return turned.normalized();
}

Matrix draw_axes(std::size_t dimension, Draw& draw) {
  if (dimension == 1) return Vector{draw.one_in(2) ? 1.0 : -1.0, 1.0, 1.0}.asDiagonal();
  Matrix axes = Matrix::Identity();
  if (dimension == 2) {
    axes.topLeftCorner<2, 2>() = Eigen::Rotation2Dd(draw.within(-3.1, 3.1)).toRotationMatrix();
    return axes;
  }
  const auto one = [&] { return draw.within(-1.0, 1.0); };
  const Vector n = Vector{one() + 1e-3, one(), one()}.normalized();
  Vector t = std::abs(n[0]) < 0.7 ? Vector{1.0, one(), one()} : Vector{one(), 1.0, one()};
  for (int pass = 0; pass < 2; ++pass)  // the second takes off what the first left by rounding
    t = (t - n.dot(t) * n).normalized();
  axes << n, t, n.cross(t);
  return axes;
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
  if (!size.may_shrink) return script;
  Script part;
  const std::vector<std::size_t> nodes = chosen_below(size.nodes, kept.nodes);
  for (const std::size_t k : chosen_below(size.steps, kept.steps)) part.push_back(script[k].of_nodes(nodes));
  return part;
}

}  // namespace ilaw::check
