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
    moved = v_free;
    std::array<double, max_stride> by{};
    for (std::size_t q = 0; q < block.count; ++q)
      by[q] = small * (size_at(block, v_free.data(), q) + size_at(block, made.data(), q));
    const auto width = static_cast<std::size_t>(layout.width);
    const std::size_t first = tangents_.size();
    tangents_.resize(first + width * width * block.count, 0.0);
    for (std::size_t c = 0; c < (width == 3 ? problem.bodies.dimension() : width); ++c) {
      for (std::size_t q = 0; q < block.count; ++q)
        moved[c * max_stride + q] += c < 3 ? by[q] : by[q] / block.column(layout.length)[q];
      if (!call(moved.data(), other.data())) return false;
      for (std::size_t q = 0; q < block.count; ++q) {
        const double step = moved[c * max_stride + q] - v_free[c * max_stride + q];
        for (std::size_t row = 0; row < width && step > 0.0 && std::isfinite(step); ++row)
          tangents_[first + width * (width * q + c) + row] =
              (other[row * max_stride + q] - answer[row * max_stride + q]) / step;
        moved[c * max_stride + q] = v_free[c * max_stride + q];
      }
    }
    for (std::size_t q = 0; q < block.count; ++q)
      for (std::size_t c = 0; c < width; ++c)
        difference_.push_back(answer[c * max_stride + q] -
                              block.column(layout.impulse + static_cast<int>(c))[q]);
  }
  return true;
}

namespace {

// Of up to six rows and columns.
using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, 6, 6>;
using Column = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, 6, 1>;

}  // namespace

// The equations of a contact with `width` components from row `row` on. Matrices by columns, in arrays of
// which they take the front. The tangent is p q', with as many columns as its rank: none at an open contact,
// one without friction.
struct Newton::Contact {
  int width = 3;
  std::size_t row = 0;
  Eigen::Index rank = 0, first = 0;  // its factors are rows first to first + rank of the system
  std::array<double, 36> h{}, p{}, q{};
  std::array<double, 6> right{};

  // scales: of impulse and moment. Tangents with moments are made free of units by them.
  void factorize(const double* tangent, const double* difference, const double* scales) {
    constexpr double noise = 1e-7;  // of differences, relative to the tangent of a rigid contact
    using Square = Eigen::Map<Matrix>;
    Matrix t = Eigen::Map<const Matrix>(tangent, width, width);
    Column scale = Column::Ones(width);
    if (width == 6) {
      scale << scales[0], scales[0], scales[0], scales[1], scales[1], scales[1];
      t = scale.asDiagonal() * t * scale.asDiagonal();
    }
    const double delassus = width == 6 ? 1.0 : scales[0] * scales[0];
    const Eigen::ColPivHouseholderQR<Matrix> qr(t);
    const Matrix r = qr.matrixQR().triangularView<Eigen::Upper>();
    while (rank < width && std::fabs(r(rank, rank)) * delassus > noise) ++rank;
    Matrix of_p = qr.householderQ(), of_q = (r * qr.colsPermutation().transpose()).transpose();
    if (width == 6) {
      of_p = scale.cwiseInverse().asDiagonal() * of_p;
      of_q = scale.cwiseInverse().asDiagonal() * of_q;
    }
    Square of_h(h.data(), width, width);
    const Matrix h_q = of_h.lazyProduct(of_q);  // H is symmetric
    Eigen::Map<Column>(right.data(), width) =
        -h_q.transpose().lazyProduct(Eigen::Map<const Column>(difference, width));
    of_h = h_q.transpose().lazyProduct(of_p);  // q' H p takes its place
    Square(p.data(), width, width) = of_p;
    Square(q.data(), width, width) = of_q;
  }
  void add_solution(const Eigen::VectorXd& solution, double* changes) const {
    for (Eigen::Index c = 0; c < rank; ++c)
      for (int k = 0; k < width; ++k)
        changes[row + static_cast<std::size_t>(k)] +=
            p[static_cast<std::size_t>(c * width + k)] * solution[first + c];
  }
};

struct Newton::System {
  std::vector<Contact> contacts;
  std::vector<std::size_t> contact_of;  // of three rows
  std::vector<Eigen::Index> column;     // of a component of x; -1: in no equation of y
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::VectorXd right;
  Eigen::SparseLU<Eigen::SparseMatrix<double>> factor;
};

Newton::Newton() : system_(std::make_unique<System>()) {}
Newton::~Newton() = default;

void Newton::read_delassus(const Blocks& blocks, const Sweep& sweep) {
  Columns unit{}, made{};
  std::vector<Contact>& contacts = system_->contacts;
  contacts.clear();
  std::size_t row = 0;
  for (const Block& block : blocks.list()) {
    if (block.asleep) continue;
    const auto width = static_cast<std::size_t>(block.layout->width);
    const std::size_t first = contacts.size();
    contacts.resize(first + block.count);
    for (std::size_t q = 0; q < block.count; ++q, row += width) {
      contacts[first + q].width = block.layout->width;
      contacts[first + q].row = row;
    }
    for (std::size_t c = 0; c < width; ++c) {
      unit.fill(0.0);
      std::fill_n(unit.begin() + static_cast<std::ptrdiff_t>(c * max_stride), max_stride, 1.0);
      sweep.respond(block, unit.data(), max_stride, made.data());
      for (std::size_t q = 0; q < block.count; ++q)
        for (std::size_t i = 0; i < width; ++i)
          contacts[first + q].h[width * c + i] = made[i * max_stride + q];
    }
  }
}

// The rows of each contact in the system, from its tangent.
void Newton::factorize() {
  system_->contact_of.clear();
  const double* tangent = tangents_.data();
  Eigen::Index first = 0;
  for (std::size_t k = 0; k < system_->contacts.size(); ++k) {
    Contact& contact = system_->contacts[k];
    const double *difference = &difference_[contact.row], *scales = &equations_.scales()[contact.row / 3];
    contact.factorize(tangent, difference, scales);
    contact.first = first;
    first += contact.rank;
    tangent += contact.width * contact.width;
    system_->contact_of.resize(system_->contact_of.size() + static_cast<std::size_t>(contact.width / 3), k);
  }
}

// f(r + dr) = f + t (W - H) dr has to be r + dr, with the tangents t = p q' and W = B B'. With x = B' dr and
// y = q' (W - H) dr, so that dr = f - r + p y:
//   x - B' p y = B' (f - r),   (1 + delta) y + q' H p y - q' B x = -q' H (f - r).
// delta makes redundant contacts solvable: a step of the proximal point method (Rockafellar 1976).
void Newton::assemble(double delta) {
  auto& [contacts, contact_of, column, entries, right, factor] = *system_;
  const auto add = [&list = entries](Eigen::Index row, Eigen::Index of, double value) {
    if (value != 0.0) list.emplace_back(static_cast<int>(row), static_cast<int>(of), value);
  };
  entries.clear();
  column.assign(equations_.columns(), -1);
  Eigen::Index size = contacts.empty() ? 0 : contacts.back().first + contacts.back().rank;
  for (const RowEntry& entry : equations_.entries()) {
    const auto row = static_cast<std::size_t>(entry.row);
    const Contact& contact = contacts[contact_of[row / 3]];
    Eigen::Index& x = column[static_cast<std::size_t>(entry.column)];
    for (Eigen::Index i = 0; i < contact.rank; ++i) {
      const std::size_t at = static_cast<std::size_t>(contact.width * i) + row - contact.row;
      const double p = entry.value * contact.p[at], q = entry.value * contact.q[at];
      if (x < 0 && (p != 0.0 || q != 0.0)) add(size, size, 1.0), x = size++;
      add(x, contact.first + i, -p);
      add(contact.first + i, x, -q);
    }
  }
  right = Eigen::VectorXd::Zero(size);
  for (const RowEntry& entry : equations_.entries())
    if (const Eigen::Index x = column[static_cast<std::size_t>(entry.column)]; x >= 0)
      right[x] += entry.value * difference_[static_cast<std::size_t>(entry.row)];
  for (const Contact& contact : contacts)
    for (Eigen::Index i = 0; i < contact.rank; ++i) {
      right[contact.first + i] = contact.right[static_cast<std::size_t>(i)];
      for (Eigen::Index j = 0; j < contact.rank; ++j)
        add(contact.first + i, contact.first + j,
            contact.h[static_cast<std::size_t>(contact.width * j + i)] + (i == j ? 1.0 + delta : 0.0));
    }
}

bool Newton::step(const Blocks& blocks, const Problem& problem, const Sweep& sweep, double delta,
                  std::vector<double>& changes) {
  std::size_t pressed = 0;  // contacts with an equation at least
  for (const Block& block : blocks.list())
    for (std::size_t q = 0; q < block.count && !block.asleep; ++q) pressed += !block.is_free(q);
  if (pressed > max_unknowns || !linearize(blocks, problem, sweep)) return false;
  equations_.read(blocks, problem);
  read_delassus(blocks, sweep);
  factorize();
  assemble(delta);
  auto& [contacts, contact_of, column, entries, right, factor] = *system_;
  if (right.size() > static_cast<Eigen::Index>(max_unknowns)) return false;
  changes = difference_;
  if (right.size() == 0) return true;
  Eigen::SparseMatrix<double> matrix(right.size(), right.size());
  matrix.setFromTriplets(entries.begin(), entries.end());
  factor.compute(matrix);
  if (factor.info() != Eigen::Success) return false;
  const Eigen::VectorXd solution = factor.solve(right);
  if (!solution.allFinite()) return false;
  for (const Contact& contact : contacts) contact.add_solution(solution, changes.data());
  return true;
}

}  // namespace ilaw::coupled
