// SPDX-License-Identifier: BSD-3-Clause
#include "equations.hpp"

#include <Eigen/Eigenvalues>

#include <cmath>

namespace ilaw::coupled {

Equations::Root Equations::root_of(const Inertia& inertia) {
  Root root{};
  for (std::size_t c = 0; c < 3; ++c) root.inverse_mass[c] = std::sqrt(inertia.inverse_mass[c]);
  const Symmetric& j = inertia.inverse_inertia;
  if (j[3] == 0.0 && j[4] == 0.0 && j[5] == 0.0) {
    for (std::size_t c = 0; c < 3; ++c) root.inverse_inertia[c] = std::sqrt(j[c]);
    return root;
  }
  Eigen::Matrix3d tensor;
  tensor << j[0], j[3], j[4], j[3], j[1], j[5], j[4], j[5], j[2];
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(tensor);
  const Eigen::Vector3d roots = solver.eigenvalues().cwiseMax(0.0).cwiseSqrt();
  const Eigen::Matrix3d r = solver.eigenvectors() * roots.asDiagonal() * solver.eigenvectors().transpose();
  root.inverse_inertia = {r(0, 0), r(1, 1), r(2, 2), r(1, 0), r(2, 0), r(2, 1)};
  return root;
}

void Equations::read(const Blocks& blocks, const Problem& problem) {
  rows_ = 0;
  entries_.clear();
  scales_.clear();
  speeds_.clear();
  roots_.clear();
  numbers_.assign(static_cast<std::size_t>(problem.bodies.count()) + 1, -1);
  const auto add = [&](std::int32_t body, const Vector& impulse, const Vector& moment) {
    if (!problem.bodies.is_movable(body)) return;
    std::int32_t& number = numbers_[static_cast<std::size_t>(body)];
    if (number < 0) {
      number = static_cast<std::int32_t>(roots_.size());
      roots_.push_back(root_of(problem.bodies.inertia_of(body)));
    }
    const Root& root = roots_[static_cast<std::size_t>(number)];
    const Vector linear = scaled(root.inverse_mass, impulse), angular = root.inverse_inertia * moment;
    for (std::size_t i = 0; i < 6; ++i)
      if (const double value = i < 3 ? linear[i] : angular[i - 3]; value != 0.0)
        entries_.push_back(
            {static_cast<std::int32_t>(rows_), 6 * number + static_cast<std::int32_t>(i), value});
  };
  for (const Block& block : blocks.list()) {
    if (block.asleep) continue;
    const Contacts& group = problem.group(block);
    with_kernel(group.kind(), block, group.body_count(), [&](const auto& kernel) {
      for (std::size_t q = 0; q < block.count; ++q) {
        push_scales(block, q, scales_);
        speeds_.resize(scales_.size(), std::sqrt(mean_delassus(block, q)));
        for (std::size_t c = 0; c < width_of<decltype(kernel)>; ++c, ++rows_) {
          std::array<double, width_of<decltype(kernel)>> unit{};
          unit[c] = 1.0;
          kernel.apply(q, unit, add);
        }
      }
    });
  }
}

}  // namespace ilaw::coupled
