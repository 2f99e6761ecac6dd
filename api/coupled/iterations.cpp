// SPDX-License-Identifier: BSD-3-Clause
#include "iterations.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace ilaw::coupled {

Progress Iterations::run(Blocks& blocks, Progress progress, bool& stalled) {
  const double scale = progress.scale;
  const std::uint32_t most = progress.limits.most;
  for (;;) {
    progress.scale = std::max(scale, progress.limits.speed);
    Outcome outcome = conjugate(blocks, progress, most <= few ? most : knobs::first_conjugate);
    const bool away = progress.code >= 0 && runs_away(blocks, progress);
    if (outcome == Outcome::solved && !away) break;
    if (away && most <= few)
      outcome = begin_again(blocks, progress);
    else if (outcome == Outcome::solved)
      outcome = Outcome::stalled;
    if (outcome == Outcome::spent && most >= least_few && most <= few && !ranks_.any())
      solve_islands(blocks, progress, stalled);
    if (outcome == Outcome::stalled) solve_islands(blocks, progress, stalled);
    // Contacts that came within reach meanwhile: all of it again, from here, or an iteration that measures.
    if (!progress.is_solved() || !ranks_.any_rank(sweep_.wake(blocks))) break;
    if (!progress.is_over()) continue;
    if (ranks_.any()) keep_start();
    iterate(blocks, progress);
    break;
  }
  stalled = stalled || progress.has_stalled();
  return progress;
}

// As many plain iterations, from no impulses.
Outcome Iterations::begin_again(Blocks& blocks, Progress& progress) {
  progress = progress.once_more(progress.limits.most);
  read_impulses(blocks, image_);
  std::fill(image_.begin(), image_.end(), 0.0);
  return_to(blocks, progress, image_);
  while (!progress.is_over() && !progress.is_done()) {
    if (ranks_.any()) keep_start();
    iterate(blocks, progress);
  }
  return progress.code < 0 ? Outcome::refused : progress.is_done() ? Outcome::solved : Outcome::spent;
}

void Iterations::iterate(Blocks& blocks, Progress& progress, const Sweep::Conjugate& conjugate) {
  Change change = progress.count == 0 ? sweep_.run_all(blocks) : sweep_.run(blocks, conjugate);
  exchange_velocities();
  // Maxima take no NaN from a host's function: a code and a sum that is no number go as flags.
  std::array<double, 4> most{change.largest, change.size, change.code < 0 ? 1.0 : 0.0,
                             std::isfinite(change.square) ? 0.0 : 1.0};
  ranks_.largest(most.data(), most.size());
  ranks_.sum(&change.square, 1);
  if (std::any_of(most.begin(), most.end(), [](double x) { return std::isnan(x); })) {
    progress.code = ILAW_INVALID_ARGUMENT;
    progress.reason = "a function of the exchange returned a value that is not a number";
  }
  if (most[2] > 0.0) progress.code = change.code < 0 ? change.code : std::int32_t{ILAW_INVALID_ARGUMENT};
  if (most[3] > 0.0) most[0] = Progress::infinity;
  progress.note(most[0], change.square, most[1]);
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

Outcome Iterations::conjugate(Blocks& blocks, Progress& progress, std::uint32_t most) {
  // With a direction the square of the change falls by beta at best, as it does without one, so that the
  // direction pays only if iterations are slow. At borders, integrated weights are solved later by it. All
  // ranks take the same step, or copies of a body would move apart.
  const double fast = ranks_.any_rank(problem_.has_integrated()) ? 0.25 : 0.1;
  Sweep::Conjugate step;
  double square_before = -1.0;
  progress.method = most > 1 ? ILAW_METHOD_CONJUGATE : ILAW_METHOD_GAUSS_SEIDEL;
  for (std::uint32_t k = 0; k < most && !progress.is_over(); ++k) {
    if (k > 0) {
      // Fletcher-Reeves in the norm of H; restart where it grows. Fast iterations need no direction.
      const double beta = square_before > 0.0 ? progress.square / square_before : 2.0;
      step = {true, beta > fast && beta <= 1.0 ? beta : 0.0};
      square_before = progress.square;
      extrapolate_bodies(step.beta);
      if (k % knobs::wake_interval == 0) sweep_.wake(blocks);
    } else {
      direction_.assign(static_cast<std::size_t>(problem_.bodies.count()), {});
      keep_start();
    }
    iterate(blocks, progress, step);
    if (progress.is_done() && !ranks_.any_rank(sweep_.wake(blocks))) return Outcome::solved;
  }
  if (progress.code < 0) return Outcome::refused;
  return progress.is_over() ? Outcome::spent : Outcome::stalled;
}

void Iterations::extrapolate_bodies(double beta) {
  Body* now = problem_.bodies.now();
  const bool rotate = problem_.bodies.rotate();
  const auto extrapolate = [&](std::size_t b) {
    Motion& direction = direction_[b];
    const auto go_on = [beta](Vector& value, Vector& along, Vector& start) {
      const Vector change = value - start;
      start = value = value + beta * along;
      along = beta * along + change;
    };
    go_on(now[b].velocity, direction.velocity, start_[b].velocity);
    if (rotate) go_on(now[b].spin, direction.spin, start_[b].spin);
  };
  sweep_.share(direction_.size(), knobs::few_bodies, [&](std::size_t first, std::size_t end) {
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

// An accelerated iterate with a larger squared change than the plain one before it is given up: the plain one
// goes on, and the next correction makes a smaller velocity. Contacts that press against each other change by
// the same in each iteration until one of them slips or opens, which corrections overshoot by far.
Outcome Iterations::anderson(Blocks& blocks, Progress& progress, std::uint32_t most, Best& best) {
  constexpr double shorter = 0.25, longer = 2.0, as_large = 1.0 + 1e-3;
  progress.method = ILAW_METHOD_ANDERSON;
  const std::size_t size = 3 * scales_of(blocks);
  for (auto* vector : {&image_, &step_, &correction_}) vector->resize(size);
  anderson_.reset(size, Anderson::max_depth, 1.0);
  const auto sum = [this](double* values, std::size_t count) { ranks_.sum(values, count); };
  double accepted = Progress::infinity, radius = 0.0, made = 0.0;
  for (std::uint32_t k = 0; k < most && !progress.is_over(); ++k) {
    if (ranks_.any()) keep_start();
    iterate(blocks, progress);
    if (progress.is_done()) return Outcome::solved;
    if (progress.error() < much_less * best.error && !runs_away(blocks, progress)) {
      best.error = progress.error();
      read_impulses(blocks, best.impulses);
    }
    if (k + 1 == most || progress.is_over()) break;
    if (made > 0.0 && !(progress.square <= as_large * accepted)) {
      radius = shorter * std::min(made, progress.size);
      made = 0.0;
      return_to_image(blocks);
      continue;
    }
    if (made > 0.0) radius *= longer;
    accepted = progress.square;
    read_scaled(blocks);
    made = 0.0;
    if (!anderson_.correct(image_, step_, sum, correction_)) continue;
    for (std::size_t i = 0; i < size; ++i) made = std::max(made, scales_[i / 3] * std::fabs(correction_[i]));
    ranks_.largest(&made, 1);
    if (!(radius > 0.0)) radius = progress.size;
    const double part = made > radius ? radius / made : 1.0;
    made *= part;
    for (std::size_t i = 0; i < size; ++i)
      correction_[i] = scales_[i / 3] > 0.0 ? part * correction_[i] / scales_[i / 3] : 0.0;
    add_changes(blocks, correction_);
  }
  if (progress.code < 0) return Outcome::refused;
  return progress.is_over() ? Outcome::spent : Outcome::stalled;
}

void Iterations::return_to_image(Blocks& blocks) {
  read_impulses(blocks, correction_);
  for (std::size_t i = 0; i < correction_.size(); ++i)
    correction_[i] = scales_[i / 3] > 0.0 ? image_[i] / scales_[i / 3] - correction_[i] : 0.0;
  add_changes(blocks, correction_);
}

// Anderson's acceleration goes on as long as each part of it lowers the residual to a tenth; then other
// methods get a part, which grows from turn to turn. The best impulses of all are kept.
Outcome Iterations::solve_island(Blocks& blocks, Progress& progress) {
  constexpr double close = 1e-6;
  Best best;
  read_impulses(blocks, best.impulses);
  std::fill(best.impulses.begin(), best.impulses.end(), 0.0);
  --progress.limits.most;  // one iteration is left to return to the best impulses
  if (runs_away(blocks, progress)) return_to(blocks, progress, best.impulses);
  // With ranks none of them has the whole system.
  const Outcome outcome = ranks_.any() ? anderson(blocks, progress, progress.limits.most, best)
                                       : take_turns(blocks, progress, best);
  ++progress.limits.most;
  if (outcome == Outcome::solved || progress.code < 0) return outcome;
  if (best.error > close * progress.scale && !best.far_ones.empty())
    return_to(blocks, progress, best.far_ones);
  else if (best.error < progress.error() || runs_away(blocks, progress))
    return_to(blocks, progress, best.impulses);
  return progress.is_done() ? Outcome::solved : Outcome::spent;
}

Outcome Iterations::take_turns(Blocks& blocks, Progress& progress, Best& best) {
  constexpr std::uint32_t most_futile = 2;  // turns in a row that do not lower the error by a tenth
  std::uint32_t gauss_seidel_part = knobs::first_part, splitting_part = knobs::first_part;
  splitting_.reset();
  const auto settles = [&](Outcome outcome) {
    if (outcome != Outcome::solved) return false;
    if (!runs_away(blocks, progress)) return true;
    if (best.far_ones.empty() && progress.residual() <= progress.limits.tolerance)
      read_impulses(blocks, best.far_ones);
    return false;
  };
  if (knobs::newton_first && settles(newton(blocks, progress))) return Outcome::solved;
  if (knobs::newton_first) keep_best(blocks, progress, best);
  for (std::uint32_t turn = 0, futile = 0; !progress.is_over() && futile < most_futile; ++turn) {
    const double error_before = best.error;
    for (double before = Progress::infinity; !progress.is_over();) {
      if (settles(anderson(blocks, progress, gauss_seidel_part, best))) return Outcome::solved;
      if (!(progress.square < 0.01 * before)) break;
      before = progress.square;
    }
    keep_best(blocks, progress, best);
    const bool grows = turn == 0 && grow_without_end(blocks, progress);
    if (grows) keep_best(blocks, progress, best);
    if (settles(newton(blocks, progress))) return Outcome::solved;
    keep_best(blocks, progress, best);
    // With acceleration, then without: both happen to run in circles.
    const std::size_t depth = turn % 2 == 0 ? Anderson::max_depth : 0;
    if (settles(splitting(blocks, progress, splitting_part, depth))) return Outcome::solved;
    keep_best(blocks, progress, best);
    if ((progress.grows = grows)) break;
    gauss_seidel_part *= 2;
    if (turn % 2 == 1) splitting_part *= 2;
    futile = best.error < 0.9 * error_before ? 0 : futile + 1;
  }
  if (progress.code < 0) return Outcome::refused;
  return progress.is_over() ? Outcome::spent : Outcome::stalled;
}

void Iterations::add_changes(Blocks& blocks, const std::vector<double>& changes) {
  if (ranks_.any()) keep_start();
  sweep_.add_changes(blocks, changes.data());
  exchange_velocities();
}

void Iterations::move(Blocks& blocks, Progress& progress, const std::vector<double>& changes) {
  add_changes(blocks, changes);
  if (ranks_.any()) keep_start();
  iterate(blocks, progress);
}

// The derivatives of laws hold until a contact opens: steps end there. Redundant contacts whose conditions
// contradict each other by rounding open one by one. Velocities known to their rounding end it. A few steps
// that do not lower the change may come before one that does; the best impulses are returned to by keep_best.
Outcome Iterations::newton(Blocks& blocks, Progress& progress) {
  constexpr std::uint32_t most_steps = 60, most_failures = 5, most_off = 10;
  const double start = progress.square;
  constexpr double much = 0.25;
  scales_of(blocks);
  double least = Progress::infinity;  // the first step may be far off
  for (std::uint32_t k = 0, failures = 0; k < most_steps && failures < most_failures && !progress.is_over();
       ++k) {
    const double delta = std::clamp(progress.residual(), 1e-12, 1e-10);
    if (!newton_.step(blocks, problem_, sweep_, delta, correction_)) return Outcome::refused;
    progress.method = ILAW_METHOD_NEWTON;
    if (shorten(blocks, part_to_first_opening(blocks)) > max_newton_growth * progress.scale)
      return Outcome::refused;
    move(blocks, progress, correction_);
    if (progress.is_done()) return Outcome::solved;
    if (progress.change <= progress.limits.rounding && progress.square > much * least) return Outcome::solved;
    failures = progress.square < least ? 0 : failures + 1;
    least = std::min(least, progress.square);
    if (k >= most_off && !(least < start)) break;
  }
  return progress.is_over() ? Outcome::spent : Outcome::stalled;
}

Outcome Iterations::splitting(Blocks& blocks, Progress& progress, std::uint32_t most, std::size_t depth) {
  if (progress.is_over()) return Outcome::spent;
  if (!splitting_.open(blocks, problem_, sweep_, depth)) return Outcome::refused;
  progress.method = ILAW_METHOD_DOUGLAS_RACHFORD;
  double close = progress.limits.tolerance * progress.scale;
  for (std::uint32_t k = 0; k + 1 < most && progress.count + 1 < progress.limits.most; ++k) {
    if (!splitting_.iterate(blocks, problem_)) return Outcome::refused;
    ++progress.count;
    // Both parts agree: an iteration of Gauss-Seidel measures the residual that is asked for.
    if (splitting_.difference() > close) continue;
    splitting_.changes(blocks, correction_);
    move(blocks, progress, correction_);
    if (progress.is_done()) return Outcome::solved;
    if (progress.is_over()) return Outcome::spent;
    if (!splitting_.open(blocks, problem_, sweep_, depth)) return Outcome::refused;
    close *= 0.1;
  }
  splitting_.changes(blocks, correction_);
  if (progress.is_over()) return Outcome::spent;
  move(blocks, progress, correction_);
  return progress.is_done() ? Outcome::solved : progress.is_over() ? Outcome::spent : Outcome::stalled;
}

std::size_t Iterations::scales_of(const Blocks& blocks) {
  scales_.clear();
  for (const Block& block : blocks.list())
    for (std::size_t q = 0; q < block.count && !block.asleep; ++q) push_scales(block, q, scales_);
  return scales_.size();
}

// Keeps the present impulses, or returns to the best ones.
void Iterations::keep_best(Blocks& blocks, Progress& progress, Best& best) {
  if (progress.error() <= best.error && !runs_away(blocks, progress)) {
    best.error = progress.error();
    read_impulses(blocks, best.impulses);
  } else if (!progress.is_over()) {
    return_to(blocks, progress, best.impulses);
  }
}

void Iterations::return_to(Blocks& blocks, Progress& progress, const std::vector<double>& impulses) {
  read_impulses(blocks, correction_);
  for (std::size_t i = 0; i < impulses.size(); ++i) correction_[i] = impulses[i] - correction_[i];
  move(blocks, progress, correction_);
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

// Newton steps alone, beyond the iterations that the caller asks for.
Outcome Iterations::solve_directly(Blocks& blocks, Progress& progress) {
  Best best;
  read_impulses(blocks, best.impulses);
  best.error = progress.error();
  const std::uint32_t count = progress.count, most = progress.limits.most;
  progress.limits.most = count + most_direct;
  const Outcome outcome = newton(blocks, progress);
  if ((outcome != Outcome::solved && best.error < progress.error()) || runs_away(blocks, progress))
    return_to(blocks, progress, best.impulses);
  progress.count = count;
  progress.limits.most = most;
  return outcome;
}

// An island that is solved in its own scale is left alone, and with few iterations so is a large one.
Outcome Iterations::solve_islands(Blocks& blocks, Progress& progress, bool& stalled) {
  const bool is_direct = progress.limits.most <= few;
  if (!ranks_.any()) islands_.find(blocks, problem_);
  if (islands_.count() == 0 && !ranks_.any()) return Outcome::stalled;
  if (ranks_.any() || (islands_.count() <= 1 && !is_direct)) {
    const Outcome outcome = solve_island(blocks, progress);
    stalled = stalled || progress.has_stalled();
    return outcome;
  }
  const bool away = !is_direct && progress.size > near * progress.scale;
  std::vector<Progress> islands = progress_of_islands(blocks, progress);
  Progress all = islands.front();
  bool is_solved = true;
  for (std::int32_t island = 0; island < islands_.count(); ++island) {
    Progress& own = islands[static_cast<std::size_t>(island)];
    const double solved = is_direct ? std::max(own.limits.tolerance, far_off) : own.limits.tolerance;
    const bool is_large = is_direct && islands_.lanes(island).size() > small_island;
    const bool needs_more = own.residual() > solved && !is_large;
    if (needs_more || away) island_.select(blocks, islands_.lanes(island));
    if (away) own.size = progress.size;
    if (needs_more || (away && runs_away(island_, own))) {
      const Outcome outcome = is_direct ? solve_directly(island_, own) : solve_island(island_, own);
      is_solved = outcome == Outcome::solved && is_solved;
      island_.give_back(blocks);
      stalled = stalled || own.has_stalled();
    }
    if (island == 0)
      all = own;
    else
      all.merge(own);
    if (own.code < 0) break;
  }
  progress = all;
  return is_solved ? Outcome::solved : Outcome::spent;
}

// From the changes of the last iteration over all contacts.
std::vector<Progress> Iterations::progress_of_islands(const Blocks& blocks, const Progress& progress) const {
  std::vector<Progress> islands(static_cast<std::size_t>(islands_.count()));
  for (Progress& own : islands) {
    own.limits = progress.limits;
    own.scale = progress.limits.speed;
    own.count = progress.count;
    own.method = progress.method;
    own.change = 0.0;
  }
  Columns response{};
  std::size_t k = 0;
  for (const Block& block : blocks.list()) {
    if (block.asleep) {
      k += block.count;
      continue;
    }
    const Layout& layout = *block.layout;
    sweep_.respond(block, block.column(layout.change), block.stride, response.data());
    for (std::size_t q = 0; q < block.count; ++q, ++k) {
      Progress& own = islands[static_cast<std::size_t>(islands_.labels()[k])];
      own.scale = std::max(own.scale, problem_.speeds[block.order + q]);
      for (std::size_t c = 0; c < static_cast<std::size_t>(layout.width); ++c) {
        const double length = c < 3 ? 1.0 : block.column(layout.length)[q];
        const double change = std::fabs(length * response[c * max_stride + q]);
        own.change = std::max(own.change, change);
        if (!std::isfinite(change)) own.change = Progress::infinity;
      }
    }
  }
  for (Progress& own : islands) own.least = own.least_in_first_half = own.lowered = own.size = own.change;
  return islands;
}

}  // namespace ilaw::coupled
