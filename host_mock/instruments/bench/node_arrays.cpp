// SPDX-License-Identifier: BSD-3-Clause
#include "bench/node_arrays.hpp"

#include <ilaw/arrays.hpp>

#include <algorithm>
#include <array>
#include <cmath>

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
bool gives_energy(const BenchCase& bench_case) { return bench_case.outputs == "all"; }

std::uint32_t inputs_of(const BenchLaw& law, const BenchCase& bench_case) {
  return law.info().inputs | (gives_energy(bench_case) ? law.info().balance_inputs : 0U);
}

// Numbers of a node that evaluate reads or writes, but its state.
std::int64_t numbers_of(const BenchLaw& law, const BenchCase& bench_case) {
  const std::int64_t d = law.dimension();
  const std::uint32_t inputs = inputs_of(law, bench_case);
  std::int64_t doubles = 2 * d + components_of(form_of(bench_case), d);  // v_free, impulse, H
  for (const std::uint32_t one : {ILAW_INPUT_GAP, ILAW_INPUT_AREA}) doubles += inputs & one ? 1 : 0;
  for (const std::uint32_t one : {ILAW_INPUT_V_PREVIOUS, ILAW_INPUT_NORMAL, ILAW_INPUT_TANGENT})
    doubles += inputs & one ? d : 0;
  if (gives_motion(bench_case)) doubles += d;
  if (has_spins(bench_case))
    doubles += d * (2 + (inputs & ILAW_INPUT_V_PREVIOUS ? 1 : 0) + (gives_motion(bench_case) ? 1 : 0));
  if (gives_energy(bench_case)) doubles += ILAW_ENERGY_COUNT;
  return doubles + static_cast<std::int64_t>(law.per_node_values().size());
}

using Vector3 = std::array<double, 3>;

// Normal and tangents of a node.
std::array<Vector3, 3> frame_of(const std::vector<double>& normal) {
  std::array<Vector3, 3> axes{};
  std::copy(normal.begin(), normal.end(), axes[0].begin());
  const Vector3& n = axes[0];
  if (normal.size() < 3) {
    axes[1] = {-n[1], n[0], 0.0};
    return axes;
  }
  const double length = std::hypot(n[0], n[1]);
  axes[1] = length > 0.5 ? Vector3{-n[1] / length, n[0] / length, 0.0} : Vector3{0.0, n[2], -n[1]};
  Vector3& t = axes[1];
  const double scale = std::sqrt(t[0] * t[0] + t[1] * t[1] + t[2] * t[2]);
  for (double& component : t) component /= scale;
  axes[2] = {n[1] * t[2] - n[2] * t[1], n[2] * t[0] - n[0] * t[2], n[0] * t[1] - n[1] * t[0]};
  return axes;
}

}  // namespace

double bytes_per_node(const BenchLaw& law, const BenchCase& bench_case) {
  const double size = bench_case.floats ? sizeof(float) : sizeof(double);
  return size * static_cast<double>(numbers_of(law, bench_case)) + (gives_motion(bench_case) ? 1.0 : 0.0) +
         16.0 * static_cast<double>(law.info().state_size);
}

double memory_per_node(const BenchLaw& law, const BenchCase& bench_case) {
  const double d = law.dimension();  // v_previous, gap, area and axes, whether they are read or not
  const double doubles = bench_case.floats ? 8.0 * static_cast<double>(numbers_of(law, bench_case)) : 0.0;
  return bytes_per_node(law, bench_case) + doubles + 8.0 * (3.0 * d + 2.0);
}

NodeArrays::NodeArrays(const BenchLaw& law, const BenchCase& bench_case, std::int64_t nodes)
    : law_(law),
      nodes_(nodes),
      drawn_(nodes + (law.info().state_size > 0 ? steps_before : 0)),
      dimension_(law.dimension()),
      delassus_components_(components_of(form_of(bench_case), law.dimension())),
      state_size_(static_cast<std::int64_t>(law.info().state_size)),
      is_global_(bench_case.frame == "global"),
      is_soa_(bench_case.layout == "soa"),
      has_spins_(has_spins(bench_case)) {
  const auto count = static_cast<std::size_t>(drawn_), d = static_cast<std::size_t>(dimension_);
  v_free_.resize(d * count);
  v_previous_.resize(d * count);
  delassus_.resize(static_cast<std::size_t>(delassus_components_) * count);
  gap_.resize(count);
  area_.assign(count, 1.0);
  if (is_global_) normal_.resize(d * count);
  if (law.takes_tangents()) tangent_.resize(d * count);
  Draw draw(1);
  for (std::int64_t i = 0; i < drawn_; ++i) {
    draw_node(draw, bench_case, i);
    draw_delassus(draw, i);
  }
  if (has_spins_) draw_spins(draw);
  impulse_.resize(d * count);
  if (gives_motion(bench_case)) velocity_.resize(d * count);
  if (has_spins_ && gives_motion(bench_case)) spin_.resize(d * count);
  if (gives_motion(bench_case)) status_.resize(static_cast<std::size_t>(nodes_));
  if (gives_energy(bench_case)) energy_.resize(ILAW_ENERGY_COUNT * count);
  for (const double value : law.per_node_values()) per_node_.emplace_back(count, value);
  lay_out(bench_case);
  if (state_size_ > 0) reach_a_representative_state();
  if (bench_case.floats) round_to_floats();
  evaluate();  // what the law refuses is seen before anything is timed
  restore();
}

void NodeArrays::draw_node(Draw& draw, const BenchCase& bench_case, std::int64_t i) {
  const bool touches = draw.chance(bench_case.touching), approaches = draw.chance(bench_case.pressed);
  const double speed = draw.uniform(0.0, 1.0);
  const Vector3 v = {approaches ? -speed : speed, draw.uniform(-1.0, 1.0), draw.uniform(-1.0, 1.0)};
  const Vector3 before = {touches ? 0.0 : v[0], v[1], v[2]};
  gap_[static_cast<std::size_t>(i)] = touches ? draw.uniform(-0.1 * time_step, 0.0) : draw.uniform(0.01, 0.1);
  std::array<Vector3, 3> axes = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  if (is_global_) axes = frame_of(draw.direction(static_cast<int>(dimension_)));
  for (std::int64_t c = 0; c < dimension_; ++c) {
    const auto k = static_cast<std::size_t>(c);
    const std::size_t at = place(i, c, dimension_);
    for (std::size_t a = 0; a < static_cast<std::size_t>(dimension_); ++a) {
      v_free_[at] += v[a] * axes[a][k];
      v_previous_[at] += before[a] * axes[a][k];
    }
    if (is_global_) normal_[at] = axes[0][k];
    if (!tangent_.empty()) tangent_[at] = axes[1][k];
  }
}

// Positive definite: a diagonal of at least 1, other entries of at most 0.3. With spins the third couples.
void NodeArrays::draw_delassus(Draw& draw, std::int64_t i) {
  for (std::int64_t c = 0; c < delassus_components_; ++c) {
    const bool is_diagonal = has_spins_ ? c != 2 : c < dimension_;
    delassus_[place(i, c, delassus_components_)] =
        is_diagonal ? draw.uniform(1.0, 3.0) : draw.uniform(-0.3, 0.3);
  }
}

void NodeArrays::draw_spins(Draw& draw) {
  spin_free_.resize(v_free_.size());
  for (double& component : spin_free_) component = draw.uniform(-1.0, 1.0);
  spin_previous_ = spin_free_;
  moment_.resize(v_free_.size());
}

ilaw_input NodeArrays::input(const std::vector<double>& values, std::int64_t components) const {
  return ilaw::input(values.data(), is_soa_ ? 1 : components, is_soa_ ? drawn_ : 1);
}

ilaw_output NodeArrays::output(std::vector<double>& values, std::int64_t components) const {
  return ilaw::output(values.data(), is_soa_ ? 1 : components, is_soa_ ? drawn_ : 1);
}

void NodeArrays::lay_out(const BenchCase& bench_case) {
  batch_.struct_size = sizeof batch_;
  batch_.node_count = nodes_;
  batch_.velocity_step = batch_.position_step = time_step;
  const std::uint32_t inputs = inputs_of(law_, bench_case);
  batch_.v_free = input(v_free_, dimension_);
  batch_.delassus = input(delassus_, delassus_components_);
  if (inputs & ILAW_INPUT_GAP) batch_.gap = input(gap_, 1);
  if (inputs & ILAW_INPUT_AREA) batch_.area = input(area_, 1);
  if (inputs & ILAW_INPUT_V_PREVIOUS) batch_.v_previous = input(v_previous_, dimension_);
  if (inputs & ILAW_INPUT_NORMAL) batch_.normal = input(normal_, dimension_);
  if (inputs & ILAW_INPUT_TANGENT) batch_.tangent = input(tangent_, dimension_);
  for (const std::vector<double>& values : per_node_) per_node_inputs_.push_back(input(values, 1));
  batch_.per_node_parameters = per_node_inputs_.empty() ? nullptr : per_node_inputs_.data();
  batch_.impulse = output(impulse_, dimension_);
  if (has_spins_) {
    batch_.spin_free = input(spin_free_, dimension_);
    if (inputs & ILAW_INPUT_V_PREVIOUS) batch_.spin_previous = input(spin_previous_, dimension_);
    batch_.moment = output(moment_, dimension_);
    if (!spin_.empty()) batch_.spin = output(spin_, dimension_);
  }
  if (gives_motion(bench_case)) batch_.velocity = output(velocity_, dimension_);
  if (gives_energy(bench_case)) batch_.energy = output(energy_, ILAW_ENERGY_COUNT);
  batch_.status = status_.empty() ? nullptr : status_.data();
  batch_.status_stride = 1;
}

void NodeArrays::reach_a_representative_state() {
  state_.resize(static_cast<std::size_t>(state_size_ * nodes_));
  batch_.state_in = ilaw::input(state_.data(), state_size_, 1);
  batch_.state_out = ilaw::output(state_.data(), state_size_, 1);
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
  const auto copy = [this](const std::vector<double>& values) {
    return floats_.emplace_back(values.begin(), values.end()).data();
  };
  const auto input = [&copy](const ilaw_input& given, const std::vector<double>& values) {
    return given.values ? ilaw::input(copy(values), given.node_stride, given.component_stride) : ilaw_input{};
  };
  const auto output = [&copy](const ilaw_output& given, const std::vector<double>& values) {
    return given.values ? ilaw::output(copy(values), given.node_stride, given.component_stride)
                        : ilaw_output{};
  };
  ilaw_batch& b = float_batch_ = batch_;
  b.v_free = input(batch_.v_free, v_free_);
  b.delassus = input(batch_.delassus, delassus_);
  b.gap = input(batch_.gap, gap_);
  b.v_previous = input(batch_.v_previous, v_previous_);
  b.area = input(batch_.area, area_);
  b.normal = input(batch_.normal, normal_);
  b.tangent = input(batch_.tangent, tangent_);
  b.spin_free = input(batch_.spin_free, spin_free_);
  b.spin_previous = input(batch_.spin_previous, spin_previous_);
  for (std::size_t k = 0; k < per_node_.size(); ++k)
    per_node_floats_.push_back(input(per_node_inputs_[k], per_node_[k]));
  b.per_node_parameters = per_node_floats_.data();
  b.impulse = output(batch_.impulse, impulse_);
  b.velocity = output(batch_.velocity, velocity_);
  b.moment = output(batch_.moment, moment_);
  b.spin = output(batch_.spin, spin_);
  b.energy = output(batch_.energy, energy_);
  is_of_floats_ = true;
}

}  // namespace ilaw::host
