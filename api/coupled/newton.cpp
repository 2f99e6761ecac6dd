// SPDX-License-Identifier: BSD-3-Clause
#include "newton.hpp"

#include <Eigen/Dense>
#include <Eigen/SparseLU>

#include <algorithm>
#include <array>
#include <cmath>

namespace ilaw::coupled {

// Each contact's impulse f(v_free) by its law at v_free = u - H r, and the derivative of f: all contacts of a
// block at once, since a law sees its own contact alone.
bool Newton::linearize(const Blocks& blocks, const Problem& problem, const Sweep& sweep) {
  constexpr double small = 0x1p-20;
  Columns v_free{}, made{}, moved{}, answer{}, other{};
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

// A tangent t of a contact as t = p q', with as many columns as its rank: none at an open contact, one
// without friction.
struct Newton::Factors {
  Eigen::Matrix3d p, q;
  Eigen::Index rank = 0;

  Factors(const Eigen::Matrix3d& tangent, double delassus) {
    constexpr double noise = 1e-7;  // of differences, relative to the tangent of a rigid contact
    const Eigen::ColPivHouseholderQR<Eigen::Matrix3d> qr(tangent);
    const Eigen::Matrix3d r = qr.matrixQR().triangularView<Eigen::Upper>();
    while (rank < 3 && std::fabs(r(rank, rank)) * delassus > noise) ++rank;
    p = qr.householderQ();
    q = (r * qr.colsPermutation().transpose()).transpose();
  }
};

struct Newton::System {
  std::vector<Factors> factors;      // by contact
  std::vector<Eigen::Index> first;   // row of a contact's factors, and their end
  std::vector<Eigen::Matrix3d> h;    // of the contacts
  std::vector<Eigen::Index> column;  // of a component of x; -1: in no equation of y
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::VectorXd right;
  Eigen::SparseLU<Eigen::SparseMatrix<double>> factor;
};

Newton::Newton() : system_(std::make_unique<System>()) {}
Newton::~Newton() = default;

void Newton::read_delassus(const Blocks& blocks, const Sweep& sweep) {
  Columns unit{}, made{};
  std::vector<Eigen::Matrix3d>& h = system_->h;
  h.clear();
  for (const Block& block : blocks.list()) {
    if (block.asleep) continue;
    const std::size_t first = h.size();
    h.resize(first + block.count);
    for (std::size_t c = 0; c < 3; ++c) {
      unit.fill(0.0);
      std::fill_n(unit.begin() + static_cast<std::ptrdiff_t>(c * max_stride), max_stride, 1.0);
      sweep.respond(block, unit.data(), max_stride, made.data());
      for (std::size_t q = 0; q < block.count; ++q)
        for (std::size_t row = 0; row < 3; ++row)
          h[first + q](static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(c)) =
              made[row * max_stride + q];
    }
  }
}

// f(r + dr) = f + t (W - H) dr has to be r + dr, with the tangents t = p q' and W = B B'. With x = B' dr and
// y = q' (W - H) dr, so that dr = f - r + p y:
//   x - B' p y = B' (f - r),   (1 + delta) y + q' H p y - q' B x = -q' H (f - r).
// delta makes redundant contacts solvable: a step of the proximal point method (Rockafellar 1976).
void Newton::assemble(double delta) {
  auto& [factors, first, h, column, entries, right, factor] = *system_;
  factors.clear();
  first.assign(1, 0);
  for (std::size_t k = 0; k < h.size(); ++k) {
    const double scale = equations_.scales()[k];
    factors.emplace_back(Eigen::Map<const Eigen::Matrix3d>(&tangents_[9 * k]), scale * scale);
    first.push_back(first.back() + factors.back().rank);
  }
  const auto add = [&list = entries](Eigen::Index row, Eigen::Index of, double value) {
    if (value != 0.0) list.emplace_back(static_cast<int>(row), static_cast<int>(of), value);
  };
  entries.clear();
  column.assign(equations_.columns(), -1);
  Eigen::Index size = first.back();
  for (const RowEntry& entry : equations_.entries()) {
    const auto k = static_cast<std::size_t>(entry.row / 3);
    Eigen::Index& x = column[static_cast<std::size_t>(entry.column)];
    for (Eigen::Index i = 0; i < factors[k].rank; ++i) {
      const double p = entry.value * factors[k].p(entry.row % 3, i),
                   q = entry.value * factors[k].q(entry.row % 3, i);
      if (x < 0 && (p != 0.0 || q != 0.0)) add(size, size, 1.0), x = size++;
      add(x, first[k] + i, -p);
      add(first[k] + i, x, -q);
    }
  }
  right = Eigen::VectorXd::Zero(size);
  for (const RowEntry& entry : equations_.entries())
    if (const Eigen::Index x = column[static_cast<std::size_t>(entry.column)]; x >= 0)
      right[x] += entry.value * difference_[static_cast<std::size_t>(entry.row)];
  for (std::size_t k = 0; k < h.size(); ++k) {
    const Eigen::Index rank = factors[k].rank;
    const Eigen::Map<const Eigen::Vector3d> difference(&difference_[3 * k]);
    const Eigen::Matrix3d own = factors[k].q.transpose() * h[k] * factors[k].p;
    right.segment(first[k], rank) = -(factors[k].q.transpose() * (h[k] * difference)).head(rank);
    for (Eigen::Index i = 0; i < rank; ++i)
      for (Eigen::Index j = 0; j < rank; ++j)
        add(first[k] + i, first[k] + j, own(i, j) + (i == j ? 1.0 + delta : 0.0));
  }
}

bool Newton::step(const Blocks& blocks, const Problem& problem, const Sweep& sweep, double delta,
                  std::vector<double>& changes) {
  for (const Block& block : blocks.list())
    if (!block.asleep && block.layout->width > 3) return false;
  if (!linearize(blocks, problem, sweep)) return false;
  equations_.read(blocks, problem);
  read_delassus(blocks, sweep);
  assemble(delta);
  auto& [factors, first, h, column, entries, right, factor] = *system_;
  if (right.size() > static_cast<Eigen::Index>(max_unknowns)) return false;
  changes = difference_;
  if (right.size() == 0) return true;
  Eigen::SparseMatrix<double> matrix(right.size(), right.size());
  matrix.setFromTriplets(entries.begin(), entries.end());
  factor.compute(matrix);
  if (factor.info() != Eigen::Success) return false;
  const Eigen::VectorXd solution = factor.solve(right);
  if (!solution.allFinite()) return false;
  for (std::size_t k = 0; k < factors.size(); ++k) {
    const Eigen::Index rank = factors[k].rank;
    Eigen::Map<Eigen::Vector3d>(&changes[3 * k]) +=
        factors[k].p.leftCols(rank) * solution.segment(first[k], rank);
  }
  return true;
}

}  // namespace ilaw::coupled
