// Impulses that grow beyond what the bodies need: along a pressure of contacts against each other, or because
// laws push against each other without end.
// SPDX-License-Identifier: BSD-3-Clause
#include "iterations.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace ilaw::coupled {

// Whether contacts press against each other by far more than the momentum of the bodies: any multiple of such
// a pressure may solve the equations, and accelerated iterates run along it. Bonds prescribe forces of their
// own, so that impulses beside them may be as large.
bool Iterations::runs_away(const Blocks& blocks, const Progress& progress) {
  if (progress.size <= near * progress.scale) return false;
  bool adheres = false;
  for (const Block& block : blocks.list())
    adheres = adheres || (!block.asleep && problem_.group(block).can_adhere());
  return !ranks_.any_rank(adheres) && exceeds_momentum(blocks, progress);
}

bool Iterations::exceeds_momentum(const Blocks& blocks, const Progress& progress) {
  constexpr double least_weight = 1e-3;
  double most = 0.0, mass = 0.0;
  for (const Block& block : blocks.list()) {
    if (block.asleep) continue;
    const Contacts& group = problem_.group(block);
    with_kernel(group.kind(), block, group.body_count(), [&](const auto& kernel) {
      for (std::size_t q = 0; q < block.count; ++q) {
        most = std::max(most, largest(block.at(block.layout->impulse, q)));
        std::array<double, width_of<decltype(kernel)>> unit{};
        std::copy_n(block.at(block.layout->normal, q).begin(), 3, unit.begin());
        kernel.apply(q, unit, [&](std::int32_t body, const Vector& impulse, const Vector&) {
          if (!problem_.bodies.is_movable(body)) return;
          const double inverse = largest(problem_.bodies.inertia_of(body).inverse_mass);
          const double weight = std::max(std::sqrt(dot(impulse, impulse)), least_weight);
          if (inverse > 0.0) mass += 1.0 / (inverse * weight * weight);
        });
      }
    });
  }
  ranks_.largest(&most, 1);
  ranks_.sum(&mass, 1);
  return most > near * mass * progress.scale;
}

// Whether each plain iteration adds the same impulses again, which move no body: laws that push each other
// up, along normals or in bonds. If r = f(v) never rises with v, no velocity suits them all: for the growth
// d, sum d.v has one value for all velocities of the bodies, and the laws ask for a larger one. A tie that
// does no positive work is no such law, so growth alone proves nothing.
bool Iterations::grow_without_end(Blocks& blocks, Progress& progress) {
  constexpr std::uint32_t most = 50;
  constexpr double steady = 1e-22, still = 1e-11, large = 1e-3;
  scales_of(blocks);
  for (auto* vector : {&image_, &step_}) vector->resize(3 * scales_.size());
  std::vector<double> before;
  for (std::uint32_t k = 0; k < most && !progress.is_over(); ++k) {
    keep_start();
    iterate(blocks, progress);
    if (progress.is_done() || !(progress.change > large * progress.scale)) return false;
    read_scaled(blocks);
    double off = 0.0, moved = 0.0;
    for (std::size_t i = 0; i < before.size(); ++i) off += (step_[i] - before[i]) * (step_[i] - before[i]);
    for (std::size_t b = 0; b < start_.size(); ++b)
      moved = std::max(moved, largest(problem_.bodies.now()[b].velocity - start_[b].velocity));
    if (!before.empty() && off <= steady * progress.square && moved <= still * progress.change) {
      if (!grows_along_normals(blocks)) return false;
      const bool proves =
          std::all_of(blocks.list().begin(), blocks.list().end(), [&](const Block& b) { return stops(b); });
      return follow_growth(blocks, progress) && proves;
    }
    before = step_;
  }
  return false;
}

bool Iterations::grows_along_normals(const Blocks& blocks) const {
  constexpr double part = 1e-6;
  for (const Block& block : blocks.list())
    for (std::size_t q = 0; q < block.count && !block.asleep; ++q) {
      const Vector by = block.at(block.layout->change, q), n = block.at(block.layout->normal, q);
      const Vector across = by - dot(n, by) * n;
      const double size = largest(by);
      if (block.status[q] != ILAW_BONDED && largest(across) > part * size) return false;
      if (dot(by, block.at(block.layout->impulse, q)) < 0.0) return false;
    }
  return true;
}

// Whether bonds stop their contacts, and would as well at the opposite velocity. One whose impulse must do no
// work does so in one direction alone, so that a solution with smaller impulses may exist.
bool Iterations::stops(const Block& block) const {
  constexpr double part = 1e-6;
  const Layout& layout = *block.layout;
  if (block.asleep ||
      std::find(block.status, block.status + block.count, ILAW_BONDED) == block.status + block.count)
    return true;
  Columns v_free{}, impulse{}, made{};
  std::array<std::uint8_t, max_stride> status{};
  std::vector<double> state(block.stride * static_cast<std::size_t>(layout.state_size) + 1);
  for (const double sign : {1.0, -1.0}) {
    for (std::size_t q = 0; q < block.count; ++q)
      for (int c = 0; c < layout.width; ++c)
        v_free[static_cast<std::size_t>(c) * max_stride + q] = sign * block.column(layout.asked + c)[q];
    ilaw_report report{};
    const Contacts::Call call{v_free.data(), block.column(layout.delassus),
                              block.stride,  impulse.data(),
                              state.data(),  status.data()};
    if (problem_.group(block).evaluate(block, call, report) < 0) return false;
    sweep_.respond(block, impulse.data(), max_stride, made.data());
    for (std::size_t q = 0; q < block.count; ++q) {
      const Vector velocity = columns_at<3>(v_free.data() + q, max_stride);
      const Vector left = velocity + columns_at<3>(made.data() + q, max_stride);
      if (block.status[q] == ILAW_BONDED && largest(left) > part * largest(velocity)) return false;
    }
  }
  return true;
}

// Follows the last changes by doubling: bonds fail at their strengths, which ends the growth. False: that
// happened, and iterations go on from there.
bool Iterations::follow_growth(Blocks& blocks, Progress& progress) {
  constexpr double other = 2.0;
  std::vector<double> growth(3 * scales_.size());
  for (std::size_t i = 0; i < growth.size(); ++i)
    growth[i] = scales_[i / 3] > 0.0 ? step_[i] / scales_[i / 3] : 0.0;
  const double square = progress.square;
  const auto is_far = [&] { return !progress.is_known() && exceeds_momentum(blocks, progress); };
  for (double part = 1.0; !progress.is_over() && !is_far(); part *= 2.0) {
    for (std::size_t i = 0; i < growth.size(); ++i) correction_[i] = part * growth[i];
    move(blocks, progress, correction_);
    if (sweep_.break_bonds(blocks) || progress.is_done() ||
        !(progress.square > square / other && progress.square < other * square))
      return false;
  }
  return is_far();
}

}  // namespace ilaw::coupled
