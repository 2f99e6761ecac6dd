// SPDX-License-Identifier: BSD-3-Clause
#include "newton.hpp"

#include <Eigen/Dense>

#include <algorithm>
#include <array>
#include <cmath>

namespace ilaw::coupled {

// Each contact's impulse f(v_free) by its law at v_free = u - H r, and the derivative of f: all contacts of a
// block at once, since a law sees its own contact alone.
bool Newton::linearize(const Blocks& blocks, const Problem& problem, const Sweep& sweep) {
  constexpr double small = 0x1p-20;
  std::array<double, 3 * max_stride> v_free{}, made{}, moved{}, answer{}, other{};
  std::array<std::uint8_t, max_stride> status{};
  difference_.clear();
  tangents_.clear();
  for (const Block& block : blocks.list()) {
    if (block.asleep) continue;
    const Contacts& group = problem.group(block);
    const Layout& layout = *block.layout;
    state_.resize(block.stride * static_cast<std::size_t>(layout.state_size) + 1);
    sweep.gather(block, v_free.data());
    sweep.respond(block, block.column(layout.impulse), block.stride, made.data());
    for (std::size_t i = 0; i < v_free.size(); ++i) v_free[i] -= made[i];
    const auto call = [&](const double* velocity, double* impulse) {
      ilaw_report report{};
      return group.evaluate(block,
                            {velocity, block.column(layout.delassus), block.stride, impulse, state_.data(),
                             status.data()},
                            report) >= 0;
    };
    if (!call(v_free.data(), answer.data())) return false;
    for (std::size_t i = 0; i < 3 * max_stride; ++i) moved[i] = v_free[i];
    std::array<double, max_stride> by{};
    for (std::size_t q = 0; q < block.count; ++q)
      by[q] = small * (largest({v_free[q], v_free[max_stride + q], v_free[2 * max_stride + q]}) +
                       largest({made[q], made[max_stride + q], made[2 * max_stride + q]}));
    const std::size_t first = tangents_.size();
    tangents_.resize(first + 9 * block.count, 0.0);
    for (std::size_t c = 0; c < problem.bodies.dimension(); ++c) {
      for (std::size_t q = 0; q < block.count; ++q) moved[c * max_stride + q] += by[q];
      if (!call(moved.data(), other.data())) return false;
      for (std::size_t q = 0; q < block.count; ++q) {
        const double step = moved[c * max_stride + q] - v_free[c * max_stride + q];
        for (std::size_t row = 0; row < 3 && step > 0.0; ++row)
          tangents_[first + 9 * q + 3 * c + row] =
              (other[row * max_stride + q] - answer[row * max_stride + q]) / step;
        moved[c * max_stride + q] = v_free[c * max_stride + q];
      }
    }
    for (std::size_t q = 0; q < block.count; ++q)
      for (std::size_t c = 0; c < 3; ++c)
        difference_.push_back(answer[c * max_stride + q] -
                              block.column(layout.impulse + static_cast<int>(c))[q]);
  }
  return true;
}

// f(r + dr) = f + f' (W - H) dr has to be r + dr: (1 - f' (W - H)) dr = f - r, with W = B B'. Redundant
// contacts make it singular: pivots find a solution.
bool Newton::step(const Blocks& blocks, const Problem& problem, const Sweep& sweep,
                  std::vector<double>& changes) {
  if (!linearize(blocks, problem, sweep)) return false;
  equations_.read(blocks, problem);
  const auto rows = static_cast<Eigen::Index>(equations_.rows());
  const auto columns = static_cast<Eigen::Index>(equations_.columns());
  Eigen::MatrixXd b = Eigen::MatrixXd::Zero(rows, columns);
  for (const RowEntry& entry : equations_.entries()) b(entry.row, entry.column) += entry.value;
  Eigen::MatrixXd coupling = b * b.transpose();  // W, then W - H
  Eigen::Index k = 0;
  std::array<double, 3 * max_stride> unit{}, made{};
  for (const Block& block : blocks.list()) {
    if (block.asleep) continue;
    for (std::size_t c = 0; c < 3; ++c) {
      unit.fill(0.0);
      std::fill_n(unit.begin() + static_cast<std::ptrdiff_t>(c * max_stride), max_stride, 1.0);
      sweep.respond(block, unit.data(), max_stride, made.data());
      for (std::size_t q = 0; q < block.count; ++q)
        for (std::size_t row = 0; row < 3; ++row)
          coupling(k + 3 * static_cast<Eigen::Index>(q) + static_cast<Eigen::Index>(row),
                   k + 3 * static_cast<Eigen::Index>(q) + static_cast<Eigen::Index>(c)) -=
              made[row * max_stride + q];
    }
    k += 3 * static_cast<Eigen::Index>(block.count);
  }
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Identity(rows, rows);
  for (Eigen::Index contact = 0; 3 * contact < rows; ++contact) {
    const Eigen::Map<const Eigen::Matrix3d> tangent(&tangents_[static_cast<std::size_t>(9 * contact)]);
    matrix.middleRows(3 * contact, 3).noalias() -= tangent * coupling.middleRows(3 * contact, 3);
  }
  // In the scales of the contacts' impulses: H of masses 1:1e7 differs as much.
  Eigen::VectorXd scale(rows);
  for (Eigen::Index i = 0; i < rows; ++i) scale[i] = equations_.scales()[static_cast<std::size_t>(i / 3)];
  matrix = scale.asDiagonal() * matrix * scale.cwiseInverse().asDiagonal();
  const Eigen::Map<const Eigen::VectorXd> right(difference_.data(), rows);
  std::vector<Eigen::Index> used;  // the others are 0 in dimensions 1 and 2
  for (Eigen::Index i = 0; i < rows; ++i)
    if (i % 3 < static_cast<Eigen::Index>(problem.bodies.dimension())) used.push_back(i);
  const Eigen::MatrixXd reduced = matrix(used, used);
  Eigen::VectorXd solution = Eigen::VectorXd::Zero(rows);
  solution(used) = reduced.colPivHouseholderQr().solve(scale.cwiseProduct(right)(used));
  solution = solution.cwiseQuotient(scale);
  if (!solution.allFinite()) return false;
  changes.assign(solution.begin(), solution.end());
  return true;
}

}  // namespace ilaw::coupled
