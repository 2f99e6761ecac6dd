// SPDX-License-Identifier: BSD-3-Clause
#include "splitting.hpp"

#define EIGEN_MPL2_ONLY
#include <Eigen/SparseCholesky>

#include <algorithm>
#include <array>
#include <cmath>

namespace ilaw::coupled {
namespace {

constexpr double relaxation = 1.6;
// The history of the acceleration is kept while the squared residual grows by no more.
constexpr double slack = 4.0;

double norm(const std::vector<double>& a) {
  double square = 0.0;
  for (const double x : a) square += x * x;
  return std::sqrt(square);
}
double distance(const std::vector<double>& a, const std::vector<double>& b) {
  double square = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) square += (a[i] - b[i]) * (a[i] - b[i]);
  return std::sqrt(square);
}

}  // namespace

// [I B'; B -rho I], which is quasi-definite: any order of elimination works (Vanderbei 1995, Symmetric
// quasi-definite matrices), and the ordering chooses between bodies and contacts.
struct Splitting::Factor {
  using Matrix = Eigen::SparseMatrix<double>;
  Matrix matrix;
  Eigen::SimplicialLDLT<Matrix> factor;
  Eigen::VectorXd right;
  Eigen::Index columns = 0;

  void assemble(const Equations& equations) {
    columns = static_cast<Eigen::Index>(equations.columns());
    const Eigen::Index size = columns + static_cast<Eigen::Index>(equations.rows());
    std::vector<Eigen::Triplet<double>> triplets;
    triplets.reserve(equations.entries().size() + static_cast<std::size_t>(size));
    for (const RowEntry& entry : equations.entries())
      triplets.emplace_back(static_cast<int>(columns) + entry.row, entry.column,
                            entry.value / equations.scales()[static_cast<std::size_t>(entry.row / 3)]);
    for (Eigen::Index i = 0; i < size; ++i)
      triplets.emplace_back(static_cast<int>(i), static_cast<int>(i), i < columns ? 1.0 : -1.0);
    matrix.resize(size, size);
    matrix.setFromTriplets(triplets.begin(), triplets.end());
    factor.analyzePattern(matrix);
    right.resize(size);
  }
  void factorize(double rho) {
    for (Eigen::Index i = columns; i < matrix.cols(); ++i) matrix.coeffRef(i, i) = -rho;
    factor.factorize(matrix);
  }
};

Splitting::Splitting() : factor_(std::make_unique<Factor>()) {}
Splitting::~Splitting() = default;

bool Splitting::open(const Blocks& blocks, const Problem& problem, const Sweep& sweep, std::size_t depth) {
  equations_.read(blocks, problem);
  if (equations_.rows() + equations_.columns() > max_unknowns) return false;
  if (std::any_of(equations_.scales().begin(), equations_.scales().end(),
                  [](double s) { return !(s > 0.0); }))
    return false;
  depth_ = depth;
  iterations_ = last_adapted_ = adaptations_ = 0;
  const std::size_t size = equations_.rows();
  for (auto* vector : {&free_, &state_, &next_, &law_, &law_before_, &linear_, &step_, &correction_})
    vector->assign(size, 0.0);
  anderson_.reset(size, std::max<std::size_t>(1, depth), slack);
  factor_->assemble(equations_);
  factor_->factorize(rho_);

  Columns velocity{};
  std::size_t i = 0;
  for (const Block& block : blocks.list()) {
    if (block.asleep) continue;
    sweep.gather(block, velocity.data());
    for (std::size_t q = 0; q < block.count; ++q)
      for (int c = 0; c < block.layout->width; ++c, ++i) {
        const double scale = equations_.scales()[i / 3];
        law_[i] = scale * block.column(block.layout->impulse + c)[q];
        free_[i] = velocity[static_cast<std::size_t>(c) * max_stride + q] / scale;
        state_[i] = law_[i] - free_[i] / rho_;
      }
  }
  // Velocities without the impulses: u - B B' r.
  std::vector<double> bodies(equations_.columns(), 0.0);
  for (const RowEntry& entry : equations_.entries()) {
    const auto row = static_cast<std::size_t>(entry.row);
    bodies[static_cast<std::size_t>(entry.column)] += entry.value / equations_.scales()[row / 3] * law_[row];
  }
  for (const RowEntry& entry : equations_.entries()) {
    const auto row = static_cast<std::size_t>(entry.row);
    free_[row] -= entry.value / equations_.scales()[row / 3] * bodies[static_cast<std::size_t>(entry.column)];
  }
  return true;
}

// H = rho D of a contact whose scales are given, in its form, at distances of max_stride.
void Splitting::write_delassus(const Layout& layout, const double* scales, double* h) const {
  const double by_impulse = rho_ * scales[0] * scales[0];
  const std::size_t diagonal = layout.delassus_size == 6 ? 3 : std::min(2, layout.delassus_size);
  for (std::size_t c = 0; c < diagonal; ++c) h[c * max_stride] = by_impulse;
  if (layout.width == 3) return;
  for (const std::size_t c : {3, 4}) h[c * max_stride] = rho_ * scales[1] * scales[1];
}

// Impulses of the laws at v_free = -rho D state and H = rho D.
bool Splitting::answer(const Blocks& blocks, const Problem& problem) {
  Columns v_free{}, impulse{}, delassus{};
  std::array<std::uint8_t, max_stride> status{};
  std::size_t first = 0;  // row of a block
  for (const Block& block : blocks.list()) {
    if (block.asleep) continue;
    const Layout& layout = *block.layout;
    const auto width = static_cast<std::size_t>(layout.width);
    law_state_.resize(block.stride * static_cast<std::size_t>(layout.state_size) + 1);
    delassus.fill(0.0);
    for (std::size_t q = 0; q < block.count; ++q) {
      const std::size_t row = first + width * q;
      const double* scales = &equations_.scales()[row / 3];
      write_delassus(layout, scales, delassus.data() + q);
      for (std::size_t c = 0; c < width; ++c)
        v_free[c * max_stride + q] = -rho_ * scales[c / 3] * state_[row + c];
    }
    ilaw_report report{};
    if (problem.group(block).evaluate(
            block,
            {v_free.data(), delassus.data(), max_stride, impulse.data(), law_state_.data(), status.data()},
            report) < 0)
      return false;
    const std::size_t components = width == 3 ? problem.bodies.dimension() : width;
    for (std::size_t q = 0; q < block.count; ++q)
      for (std::size_t c = 0; c < components; ++c) {
        const std::size_t row = first + width * q + c;
        law_[row] = equations_.scales()[row / 3] * impulse[c * max_stride + q];
      }
    first += width * block.count;
  }
  return true;
}

// (B B' + rho I) x = rho (2 z - w) - free.
void Splitting::solve_linear() {
  Eigen::VectorXd& right = factor_->right;
  right.head(factor_->columns).setZero();
  for (std::size_t i = 0; i < law_.size(); ++i)
    right[factor_->columns + static_cast<Eigen::Index>(i)] = rho_ * (2.0 * law_[i] - state_[i]) - free_[i];
  right = factor_->factor.solve(right);
  for (std::size_t i = 0; i < law_.size(); ++i)
    linear_[i] = -right[factor_->columns + static_cast<Eigen::Index>(i)];
}

bool Splitting::iterate(const Blocks& blocks, const Problem& problem) {
  ++iterations_;
  law_before_ = law_;
  if (!answer(blocks, problem)) return false;
  solve_linear();
  difference_ = 0.0;
  for (std::size_t i = 0; i < law_.size(); ++i) {
    next_[i] = state_[i] + relaxation * (linear_[i] - law_[i]);
    const double by = std::max(std::fabs(linear_[i] - law_[i]), std::fabs(law_[i] - law_before_[i]));
    difference_ = std::max(difference_, rho_ * equations_.speeds()[i / 3] * by);
    if (!std::isfinite(next_[i])) return false;
  }
  const double primal = distance(linear_, law_) / (std::max(norm(linear_), norm(law_)) + 1e-300);
  const double dual = distance(law_, law_before_) / (distance(state_, law_) + 1e-300);
  adapt(primal, dual);
  if (adapted_) return true;
  if (depth_ > 0)
    accelerate();
  else
    state_ = next_;
  return true;
}

// rho by the balance of the two residuals (Boyd et al. 2011, section 3.4.1), less and less often: each change
// takes another factor. Impulses and velocities stay.
void Splitting::adapt(double primal, double dual) {
  constexpr double balance = 5.0;
  adapted_ = false;
  if (iterations_ - last_adapted_ < (std::size_t{10} << std::min<std::size_t>(adaptations_, 6))) return;
  const double factor = primal > balance * dual ? 2.0 : dual > balance * primal ? 0.5 : 1.0;
  if (factor == 1.0) return;
  rho_ *= factor;
  for (std::size_t i = 0; i < law_.size(); ++i) state_[i] = law_[i] + (next_[i] - law_[i]) / factor;
  factor_->factorize(rho_);
  anderson_.forget();
  last_adapted_ = iterations_;
  ++adaptations_;
  adapted_ = true;
}

void Splitting::accelerate() {
  for (std::size_t i = 0; i < state_.size(); ++i) step_[i] = next_[i] - state_[i];
  const bool corrected = anderson_.correct(
      next_, step_, [](double*, std::size_t) {}, correction_);
  for (std::size_t i = 0; i < state_.size(); ++i) state_[i] = next_[i] + (corrected ? correction_[i] : 0.0);
}

void Splitting::changes(const Blocks& blocks, std::vector<double>& changes) const {
  changes.resize(law_.size());
  std::size_t i = 0;
  for (const Block& block : blocks.list()) {
    if (block.asleep) continue;
    const int impulse = block.layout->impulse;
    for (std::size_t q = 0; q < block.count; ++q)
      for (int c = 0; c < block.layout->width; ++c, ++i)
        changes[i] = law_[i] / equations_.scales()[i / 3] - block.column(impulse + c)[q];
  }
}

}  // namespace ilaw::coupled
