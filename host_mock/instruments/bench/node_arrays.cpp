// SPDX-License-Identifier: BSD-3-Clause
#include "bench/node_arrays.hpp"

#include <ilaw/arrays.hpp>

#include <Eigen/Geometry>

#include <algorithm>

namespace ilaw::host {
namespace {

constexpr double time_step = 1e-3;
// Steps before the first that is measured; in each, a node has the velocity of its next neighbour.
constexpr std::int64_t steps_before = 16;

std::int64_t components_of(std::uint32_t form, std::int64_t dimension) {
  switch (form) {
    case ILAW_DELASSUS_SCALAR:
      return 1;
    case ILAW_DELASSUS_TRANSVERSE:
      return 2;
    case ILAW_DELASSUS_TRANSVERSE_SPIN:
      return 5;
    case ILAW_DELASSUS_DIAGONAL:
      return dimension;
    default:
      return dimension * (dimension + 1) / 2;
  }
}

bool has_spins(const BenchCase& bench_case) { return form_of(bench_case) == ILAW_DELASSUS_TRANSVERSE_SPIN; }
bool gives_motion(const BenchCase& bench_case) { return bench_case.outputs != "none"; }

// The arrays of a case, without values.
std::vector<BatchArray> arrays_of(const BenchLaw& law, const BenchCase& bench_case) {
  using Batch = ilaw_batch;
  const std::int64_t d = law.dimension();
  const bool energy = bench_case.outputs == "all", motion = gives_motion(bench_case);
  const std::uint32_t inputs = law.info().inputs | (energy ? law.info().balance_inputs : 0U);
  std::vector<BatchArray> arrays;
  const auto read = [&](ilaw_input Batch::*input, std::int64_t components, std::uint32_t when) {
    if (when == 0 || (inputs & when)) arrays.push_back({input, nullptr, components});
  };
  const auto written = [&](ilaw_output Batch::*output, std::int64_t components, bool is_given) {
    if (is_given) arrays.push_back({nullptr, output, components});
  };
  read(&Batch::v_free, d, 0);
  read(&Batch::delassus, components_of(form_of(bench_case), d), 0);
  read(&Batch::v_previous, d, ILAW_INPUT_V_PREVIOUS);
  read(&Batch::gap, 1, ILAW_INPUT_GAP);
  read(&Batch::area, 1, ILAW_INPUT_AREA);
  read(&Batch::normal, d, ILAW_INPUT_NORMAL);
  read(&Batch::tangent, d, ILAW_INPUT_TANGENT);
  written(&Batch::impulse, d, true);
  written(&Batch::velocity, d, motion);
  written(&Batch::energy, ILAW_ENERGY_COUNT, energy);
  if (!has_spins(bench_case)) return arrays;
  read(&Batch::spin_free, d, 0);
  read(&Batch::spin_previous, d, ILAW_INPUT_V_PREVIOUS);
  written(&Batch::moment, d, true);
  written(&Batch::spin, d, motion);
  return arrays;
}

double numbers_per_node(const BenchLaw& law, const BenchCase& bench_case) {
  std::int64_t numbers = static_cast<std::int64_t>(law.per_node_values().size());
  for (const BatchArray& array : arrays_of(law, bench_case)) numbers += array.components;
  return static_cast<double>(numbers);
}

// Normal and tangents of a node in its columns.
Eigen::Matrix3d frame_of(const std::vector<double>& normal) {
  Eigen::Vector3d n = Eigen::Vector3d::Zero();
  std::copy(normal.begin(), normal.end(), n.begin());
  const Eigen::Vector3d t = normal.size() < 3 ? Eigen::Vector3d(-n[1], n[0], 0.0) : n.unitOrthogonal();
  Eigen::Matrix3d frame;
  frame << n, t, n.cross(t);
  return frame;
}

}  // namespace

double bytes_per_node(const BenchLaw& law, const BenchCase& bench_case) {
  const double size = bench_case.floats ? sizeof(float) : sizeof(double);
  return size * numbers_per_node(law, bench_case) + (gives_motion(bench_case) ? 1.0 : 0.0) +
         16.0 * static_cast<double>(law.info().state_size);
}

double memory_per_node(const BenchLaw& law, const BenchCase& bench_case) {
  const double doubles = bench_case.floats ? 8.0 * numbers_per_node(law, bench_case) : 0.0;
  return bytes_per_node(law, bench_case) + doubles;
}

NodeArrays::NodeArrays(const BenchLaw& law, const BenchCase& bench_case, std::int64_t nodes)
    : law_(law),
      nodes_(nodes),
      drawn_(nodes + (law.info().state_size > 0 ? steps_before : 0)),
      dimension_(law.dimension()),
      is_global_(bench_case.frame == "global"),
      is_soa_(bench_case.layout == "soa"),
      has_spins_(has_spins(bench_case)),
      arrays_(arrays_of(law, bench_case)),
      status_(gives_motion(bench_case) ? static_cast<std::size_t>(nodes) : 0) {
  const auto count = static_cast<std::size_t>(drawn_);
  for (BatchArray& array : arrays_)
    array.values.resize(static_cast<std::size_t>(array.components) * count,
                        array.input == &ilaw_batch::area ? 1.0 : 0.0);
  for (const double value : law.per_node_values())
    per_node_.push_back({nullptr, nullptr, 1, std::vector<double>(count, value)});
  Draw draw(1);
  for (std::int64_t i = 0; i < drawn_; ++i) {
    draw_node(draw, i);
    draw_delassus(draw, i);
  }
  if (has_spins_) draw_spins(draw);
  lay_out(batch_, per_node_inputs_, &BatchArray::values);
  if (law.info().state_size > 0) reach_a_representative_state();
  if (bench_case.floats) round_to_floats();
  evaluate();  // what the law refuses is seen before anything is timed
  restore();
}

double* NodeArrays::place(ilaw_input ilaw_batch::*input, std::int64_t i, std::int64_t c) {
  for (BatchArray& array : arrays_)
    if (array.input == input)
      return &array.values[static_cast<std::size_t>(is_soa_ ? i + c * drawn_ : i * array.components + c)];
  return nullptr;
}

// Half of the nodes touch, and half of them approach.
void NodeArrays::draw_node(Draw& draw, std::int64_t i) {
  const bool touches = draw.chance(0.5), approaches = draw.chance(0.5);
  const double speed = draw.uniform(0.0, 1.0);
  Eigen::Vector3d v{approaches ? -speed : speed, draw.uniform(-1.0, 1.0), draw.uniform(-1.0, 1.0)};
  const double gap = touches ? draw.uniform(-0.1 * time_step, 0.0) : draw.uniform(0.01, 0.1);
  const Eigen::Matrix3d axes = is_global_ ? frame_of(draw.direction(static_cast<int>(dimension_)))
                                          : Eigen::Matrix3d(Eigen::Matrix3d::Identity());
  const auto d = static_cast<Eigen::Index>(dimension_);
  const Eigen::Vector3d after = axes.leftCols(d) * v.head(d);
  if (touches) v[0] = 0.0;
  const Eigen::Vector3d before = axes.leftCols(d) * v.head(d);
  const auto set = [&](ilaw_input ilaw_batch::*input, Eigen::Index c, double value) {
    if (double* const number = place(input, i, c)) *number = value;
  };
  set(&ilaw_batch::gap, 0, gap);
  for (Eigen::Index c = 0; c < d; ++c) {
    set(&ilaw_batch::v_free, c, after[c]);
    set(&ilaw_batch::v_previous, c, before[c]);
    set(&ilaw_batch::normal, c, axes(c, 0));
    set(&ilaw_batch::tangent, c, axes(c, 1));
  }
}

// Positive definite: a diagonal of at least 1, other entries of at most 0.3. With spins the third couples.
void NodeArrays::draw_delassus(Draw& draw, std::int64_t i) {
  const std::int64_t components = arrays_[1].components;
  for (std::int64_t c = 0; c < components; ++c) {
    const bool is_diagonal = has_spins_ ? c != 2 : c < dimension_;
    *place(&ilaw_batch::delassus, i, c) = is_diagonal ? draw.uniform(1.0, 3.0) : draw.uniform(-0.3, 0.3);
  }
}

void NodeArrays::draw_spins(Draw& draw) {
  std::vector<double> spins(static_cast<std::size_t>(dimension_ * drawn_));
  for (double& component : spins) component = draw.uniform(-1.0, 1.0);
  for (BatchArray& array : arrays_)
    if (array.input == &ilaw_batch::spin_free || array.input == &ilaw_batch::spin_previous)
      array.values = spins;
}

template <class Number>
void NodeArrays::lay_out(ilaw_batch& batch, std::vector<ilaw_input>& per_node,
                         std::vector<Number> BatchArray::*numbers) {
  for (BatchArray& array : arrays_) {
    const std::int64_t node = is_soa_ ? 1 : array.components, component = is_soa_ ? drawn_ : 1;
    if (array.input)
      batch.*array.input = ilaw::input((array.*numbers).data(), node, component);
    else
      batch.*array.output = ilaw::output((array.*numbers).data(), node, component);
  }
  for (const BatchArray& array : per_node_)
    per_node.push_back(ilaw::input((array.*numbers).data(), 1, is_soa_ ? drawn_ : 1));
  batch.struct_size = sizeof batch;
  batch.node_count = nodes_;
  batch.velocity_step = batch.position_step = time_step;
  batch.per_node_parameters = per_node.empty() ? nullptr : per_node.data();
  batch.status = status_.empty() ? nullptr : status_.data();
  batch.status_stride = 1;
}

void NodeArrays::reach_a_representative_state() {
  const auto size = static_cast<std::int64_t>(law_.info().state_size);
  state_.resize(static_cast<std::size_t>(size * nodes_));
  batch_.state_in = ilaw::input(state_.data(), size, 1);
  batch_.state_out = ilaw::output(state_.data(), size, 1);
  law_.initialise(batch_);
  const ilaw_input v_free = batch_.v_free;
  for (std::int64_t k = steps_before; k > 0; --k) {
    batch_.time += time_step;
    batch_.v_free.values = v_free.values + k * v_free.node_stride;
    evaluate();
  }
  batch_.v_free = v_free;
  batch_.time += time_step;
  first_state_ = state_;
}

// The state stays in doubles.
void NodeArrays::round_to_floats() {
  for (std::vector<BatchArray>* arrays : {&arrays_, &per_node_})
    for (BatchArray& array : *arrays) array.floats.assign(array.values.begin(), array.values.end());
  float_batch_ = batch_;
  lay_out(float_batch_, per_node_floats_, &BatchArray::floats);
  is_of_floats_ = true;
}

}  // namespace ilaw::host
