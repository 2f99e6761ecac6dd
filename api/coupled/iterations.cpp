// SPDX-License-Identifier: BSD-3-Clause
#include "iterations.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace ilaw::coupled {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

}  // namespace

void Iterations::begin(std::uint32_t most, double tolerance, double speed, double rounding) {
  most_ = most;
  speed_ = speed;
  rounding_ = rounding;
  tolerance_ = tolerance;
  count_ = most_counted_ = 0;
  failed_ = ILAW_OK;
  residual_ = least_ = least_in_first_half_ = lowered_ = infinity;
  size_ = first_size_ = 0.0;
  method_ = ILAW_METHOD_GAUSS_SEIDEL;
}

std::int32_t Iterations::run(Blocks& blocks) {
  bool done = false;
  while (!done && !is_over()) {
    done = conjugate(blocks, most_ <= few ? most_ : first_conjugate);
    if (done || is_over()) break;
    solve_islands(blocks);
    // A contact that came within reach meanwhile: all of it again, from here.
    done = is_over() || !ranks_.any_rank(sweep_.wake(blocks));
  }
  most_counted_ = std::max(most_counted_, count_);
  stalled_ = !is_solved() && !(least_ < 0.9 * least_in_first_half_);
  return failed_;
}

bool Iterations::iterate(Blocks& blocks, const Sweep::Conjugate& conjugate) {
  Change change = count_ == 0 ? sweep_.run_all(blocks) : sweep_.run(blocks, conjugate);
  exchange_velocities();
  return accept(change);
}

bool Iterations::accept(Change change) {
  std::array<double, 4> most{change.largest, change.size, change.code < 0 ? 1.0 : 0.0,
                             std::isfinite(change.square) ? 0.0 : 1.0};
  ranks_.largest(most.data(), most.size());
  ranks_.sum(&change.square, 1);
  ++count_;
  if (most[2] > 0.0) failed_ = change.code < 0 ? change.code : std::int32_t{ILAW_INVALID_ARGUMENT};
  change_ = most[0];
  if (most[3] > 0.0) change_ = infinity;
  square_ = change.square;
  size_ = std::max(most[1], speed_);
  if (count_ == 1 && !(first_size_ > 0.0)) first_size_ = size_;
  residual_ = change_ > 0.0 ? change_ / size_ : 0.0;
  least_ = std::min(least_, residual_);
  if (count_ <= most_ / 2) least_in_first_half_ = least_;
  return failed_ >= 0 && (residual_ <= tolerance_ || stays_at_rounding());
}

bool Iterations::stays_at_rounding() {
  if (change_ < 0.9 * lowered_) {
    lowered_ = change_;
    since_lowered_ = 0;
  }
  return ++since_lowered_ > plateau && change_ <= rounding_;
}

void Iterations::keep_start() {
  const auto count = static_cast<std::size_t>(problem_.bodies.count());
  const Body* now = problem_.bodies.now();
  start_.resize(count);
  for (std::size_t b = 0; b < count; ++b) start_[b] = {now[b].velocity, now[b].spin};
}

// Velocities changed by the impulses of this rank, with masses divided among the copies of a body: the mean
// of all copies is the change by all impulses with the whole mass.
void Iterations::exchange_velocities() {
  if (!ranks_.any()) return;
  problem_.bodies.exchange(start_, ranks_);
}

bool Iterations::conjugate(Blocks& blocks, std::uint32_t most) {
  constexpr double fast = 0.1;
  Sweep::Conjugate step;
  double square_before = -1.0;
  method_ = most > 1 ? ILAW_METHOD_CONJUGATE : ILAW_METHOD_GAUSS_SEIDEL;
  for (std::uint32_t k = 0; k < most && !is_over(); ++k) {
    if (k > 0) {
      // Fletcher-Reeves in the norm of H; restart where it grows. Fast iterations need no direction.
      const double beta = square_before > 0.0 ? square_ / square_before : 2.0;
      step = {true, beta > fast && beta <= 1.0 ? beta : 0.0};
      square_before = square_;
      extrapolate_bodies(step.beta);
      if (k % wake_interval == 0) sweep_.wake(blocks);
    } else {
      direction_.assign(static_cast<std::size_t>(problem_.bodies.count()), {});
      keep_start();
    }
    const bool done = iterate(blocks, step);
    if (done && !ranks_.any_rank(sweep_.wake(blocks))) return true;
  }
  return false;
}

void Iterations::extrapolate_bodies(double beta) {
  Body* now = problem_.bodies.now();
  const auto extrapolate = [&](std::size_t b) {
    Motion& direction = direction_[b];
    const Vector v = now[b].velocity - start_[b].velocity, w = now[b].spin - start_[b].spin;
    now[b].velocity = now[b].velocity + beta * direction.velocity;
    now[b].spin = now[b].spin + beta * direction.spin;
    direction = {beta * direction.velocity + v, beta * direction.spin + w};
    start_[b] = {now[b].velocity, now[b].spin};
  };
  constexpr std::size_t few_bodies = 10000;
  sweep_.share(direction_.size(), few_bodies, [&](std::size_t first, std::size_t end) {
    for (std::size_t b = first; b < end; ++b) extrapolate(b);
  });
}

// Part of the corrections, at most 1, after which the first impulse of a contact has vanished. A moment may.
double Iterations::part_to_first_opening(const Blocks& blocks) const {
  double part = 1.0;
  const double* change = correction_.data();
  for (const Block& block : blocks.list())
    for (std::size_t q = 0; q < block.count && !block.asleep; ++q, change += block.layout->width) {
      const Vector r = block.at(block.layout->impulse, q), by = columns_at<3>(change, 1);
      const double square = dot(r, r), product = dot(r, by);
      if (-product * part > square && square > 0.0) part = square / -product;
    }
  return part;
}

// Takes this part of the corrections. Returns the largest velocity that they make.
double Iterations::shorten(const Blocks& blocks, double part) {
  double most = 0.0;
  std::size_t i = 0;
  for (const Block& block : blocks.list())
    for (std::size_t q = 0; q < block.count && !block.asleep; ++q) {
      const double speed = scales_[i / 3];
      for (int c = 0; c < block.layout->width; ++c, ++i) {
        correction_[i] *= part;
        most = std::max(most, speed * scales_[i / 3] * std::fabs(correction_[i]));
      }
    }
  return most;
}

void Iterations::read_scaled(const Blocks& blocks) {
  std::size_t i = 0;
  for (const Block& block : blocks.list()) {
    if (block.asleep) continue;
    const Layout& layout = *block.layout;
    for (std::size_t q = 0; q < block.count; ++q)
      for (int c = 0; c < layout.width; ++c, ++i) {
        image_[i] = scales_[i / 3] * block.column(layout.impulse + c)[q];
        step_[i] = scales_[i / 3] * block.column(layout.change + c)[q];
      }
  }
}

bool Iterations::anderson(Blocks& blocks, std::uint32_t most) {
  method_ = ILAW_METHOD_ANDERSON;
  lowered_ = infinity;
  const std::size_t size = 3 * scales_of(blocks);
  for (auto* vector : {&image_, &step_, &correction_}) vector->resize(size);
  anderson_.reset(size, Anderson::max_depth, 1.0);
  const auto sum = [this](double* values, std::size_t count) { ranks_.sum(values, count); };
  for (std::uint32_t k = 0; k < most && !is_over(); ++k) {
    if (ranks_.any()) keep_start();
    if (iterate(blocks, {})) return true;
    if (square_ < much_less * best_square_) note_best(blocks);
    if (k + 1 == most || is_over()) break;
    read_scaled(blocks);
    if (!anderson_.correct(image_, step_, sum, correction_)) continue;
    for (std::size_t i = 0; i < size; ++i)
      correction_[i] = scales_[i / 3] > 0.0 ? correction_[i] / scales_[i / 3] : 0.0;
    if (ranks_.any()) keep_start();
    sweep_.add_changes(blocks, correction_.data());
    exchange_velocities();
  }
  return false;
}

// Anderson's acceleration goes on as long as each part of it lowers the residual to a tenth; then other
// methods get a part, which grows from turn to turn. The best impulses of all are kept.
bool Iterations::alternate(Blocks& blocks) {
  best_square_ = infinity;
  --most_;  // one iteration is left to return to the best impulses
  // With ranks none of them has the whole system.
  const bool done = ranks_.any() ? anderson(blocks, most_) : take_turns(blocks);
  ++most_;
  return done || (best_square_ < square_ && !is_over() && return_to_best(blocks));
}

bool Iterations::take_turns(Blocks& blocks) {
  std::uint32_t gauss_seidel_part = first_part, splitting_part = first_part;
  splitting_.reset();
  for (std::uint32_t turn = 0; !is_over(); ++turn) {
    for (double before = infinity; !is_over();) {
      if (anderson(blocks, gauss_seidel_part)) return true;
      if (!(square_ < 0.01 * before)) break;
      before = square_;
    }
    if (is_over()) break;
    keep_best(blocks);
    if (newton(blocks)) return true;
    if (is_over()) break;
    keep_best(blocks);
    // With acceleration, then without: both happen to run in circles.
    if (splitting(blocks, splitting_part, turn % 2 == 0 ? Anderson::max_depth : 0)) return true;
    keep_best(blocks);
    gauss_seidel_part *= 2;
    if (turn % 2 == 1) splitting_part *= 2;
  }
  return false;
}

// Moves to these impulses, by contact, and iterates once from there.
bool Iterations::move(Blocks& blocks, const std::vector<double>& changes) {
  if (ranks_.any()) keep_start();
  sweep_.add_changes(blocks, changes.data());
  exchange_velocities();
  if (ranks_.any()) keep_start();
  return iterate(blocks, {});
}

// The derivatives of laws hold until a contact opens: steps end there. Redundant contacts whose conditions
// contradict each other by rounding open one by one. Velocities known to their rounding end it.
bool Iterations::newton(Blocks& blocks) {
  constexpr std::uint32_t most_steps = 60, most_failures = 5;
  double least = square_;
  for (std::uint32_t k = 0, failures = 0; k < most_steps && failures < most_failures && !is_over(); ++k) {
    const double delta = std::clamp(residual_, 1e-12, 1e-10);
    if (!newton_.step(blocks, problem_, sweep_, delta, correction_)) return false;
    method_ = ILAW_METHOD_NEWTON;
    if (shorten(blocks, part_to_first_opening(blocks)) > max_newton_growth * first_size_) return false;
    if (move(blocks, correction_)) return true;
    if (change_ <= rounding_ && square_ > much_less * least) return true;
    failures = square_ < least ? 0 : failures + 1;
    least = std::min(least, square_);
  }
  return false;
}

bool Iterations::splitting(Blocks& blocks, std::uint32_t most, std::size_t depth) {
  if (!splitting_.open(blocks, problem_, sweep_, depth)) return false;
  method_ = ILAW_METHOD_DOUGLAS_RACHFORD;
  double close = tolerance_ * size_;
  for (std::uint32_t k = 0; k + 1 < most && count_ + 1 < most_; ++k) {
    if (!splitting_.iterate(blocks, problem_)) return false;
    ++count_;
    // Both parts agree: an iteration of Gauss-Seidel measures the residual that is asked for.
    if (splitting_.difference() > close) continue;
    splitting_.changes(blocks, correction_);
    if (move(blocks, correction_)) return true;
    if (is_over() || !splitting_.open(blocks, problem_, sweep_, depth)) return false;
    close *= 0.1;
  }
  splitting_.changes(blocks, correction_);
  return !is_over() && move(blocks, correction_);
}

std::size_t Iterations::scales_of(const Blocks& blocks) {
  scales_.clear();
  for (const Block& block : blocks.list())
    for (std::size_t q = 0; q < block.count && !block.asleep; ++q) push_scales(block, q, scales_);
  return scales_.size();
}

// Impulses with the least residual so far; others go back to them.
void Iterations::keep_best(Blocks& blocks) {
  if (!(square_ <= best_square_)) {
    if (!is_over()) return_to_best(blocks);
    return;
  }
  note_best(blocks);
}

void Iterations::note_best(const Blocks& blocks) {
  best_square_ = square_;
  read_impulses(blocks, best_);
}

bool Iterations::return_to_best(Blocks& blocks) {
  read_impulses(blocks, correction_);
  for (std::size_t i = 0; i < best_.size(); ++i) correction_[i] = best_[i] - correction_[i];
  return move(blocks, correction_);
}

void Iterations::read_impulses(const Blocks& blocks, std::vector<double>& impulses) const {
  impulses.clear();
  for (const Block& block : blocks.list()) {
    if (block.asleep) continue;
    const int impulse = block.layout->impulse;
    for (std::size_t q = 0; q < block.count; ++q)
      for (int c = 0; c < block.layout->width; ++c) impulses.push_back(block.column(impulse + c)[q]);
  }
}

void Iterations::solve_islands(Blocks& blocks) {
  if (!ranks_.any()) islands_.find(blocks, problem_);
  if (ranks_.any() || islands_.count() <= 1) {
    alternate(blocks);
    return;
  }
  std::vector<double> residuals(static_cast<std::size_t>(islands_.count()), 0.0);
  find_island_residuals(blocks, residuals);
  const std::uint32_t first = count_;
  std::uint32_t method = method_;
  const double first_size = size_;
  double largest = 0.0, size = size_;
  for (std::int32_t island = 0; island < islands_.count() && failed_ >= 0; ++island) {
    const double residual = residuals[static_cast<std::size_t>(island)] / first_size;
    if (!(residual > tolerance_)) {
      largest = std::max(largest, residual);
      continue;
    }
    count_ = first;
    size_ = first_size;
    island_.select(blocks, islands_.lanes(island));
    alternate(island_);
    island_.give_back(blocks);
    largest = std::max(largest, residual_);
    size = std::max(size, size_);
    if (count_ > most_counted_) method = method_;
    most_counted_ = std::max(most_counted_, count_);
  }
  count_ = std::max(first, most_counted_);
  residual_ = largest;
  size_ = size;
  method_ = method;
}

void Iterations::find_island_residuals(const Blocks& blocks, std::vector<double>& residuals) {
  Columns response{};
  std::size_t k = 0;
  for (const Block& block : blocks.list()) {
    if (block.asleep) {
      k += block.count;
      continue;
    }
    const Layout& layout = *block.layout;
    sweep_.respond(block, block.column(layout.change), block.stride, response.data());
    for (std::size_t q = 0; q < block.count; ++q, ++k)
      for (std::size_t c = 0; c < static_cast<std::size_t>(layout.width); ++c) {
        double& most = residuals[static_cast<std::size_t>(islands_.labels()[k])];
        const double length = c < 3 ? 1.0 : block.column(layout.length)[q];
        const double change = std::fabs(length * response[c * max_stride + q]);
        most = std::max(most, change);
        if (!std::isfinite(change)) most = infinity;
      }
  }
}

}  // namespace ilaw::coupled
