// SPDX-License-Identifier: BSD-3-Clause
#include "solver.hpp"

#include "sizes.hpp"

#include <ilaw/arrays.hpp>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <limits>

namespace ilaw::coupled {
namespace {

constexpr std::uint32_t default_sweeps = 1000;
constexpr double default_tolerance = 1e-10;
constexpr std::uint32_t most_threads = 256;

const char* complaint(const ilaw_coupled_options& options) {
  const auto is_positive = [](double x) { return x >= 0.0 && std::isfinite(x); };
  if (!is_positive(options.tolerance)) return "tolerance is below 0 or not finite";
  if (!is_positive(options.speed)) return "speed is below 0 or not finite";
  if (!is_positive(options.rounding)) return "rounding is below 0 or not finite";
  return options.threads > most_threads ? "threads is above 256" : nullptr;
}

}  // namespace

std::int32_t Solver::solve(const ilaw_bodies* bodies, const ilaw_contacts* const* groups,
                           std::int64_t group_count, const ilaw_coupled_options& options,
                           ilaw_coupled_report& report) {
  ranks_.use(options.exchange);
  sweep_.use(std::clamp(options.threads, 1U, most_threads), options.pool);
  report.bad_group = report.bad_contact = report.worst_group = report.worst_contact = -1;
  report.stable_velocity_step = std::numeric_limits<double>::infinity();
  report.reason = complaint(options);
  if (!report.reason) report.reason = open(bodies, groups, group_count, report);
  const bool refused_here = report.reason != nullptr;
  if (ranks_.any_rank(refused_here)) {
    if (!refused_here) report.reason = "another rank's call was refused";
    return ILAW_INVALID_ARGUMENT;
  }
  split_shared_bodies();
  report.reason = make_blocks(report);
  if (ranks_.any_rank(report.reason != nullptr)) {
    if (!report.reason) report.reason = "another rank's call was refused";
    return ILAW_INVALID_ARGUMENT;
  }
  report.bad_group = report.bad_contact = -1;
  sweep_.reset();
  iterate({options.most_sweeps > 0 ? options.most_sweeps : default_sweeps,
           options.tolerance > 0.0 ? options.tolerance : default_tolerance, options.rounding, options.speed});
  if (progress_.code < 0) {
    report.bad_group = sweep_.failed_group();
    report.reason = progress_.reason ? progress_.reason : sweep_.last_report().reason;
    return progress_.code;
  }
  report.sweeps = progress_.count;
  report.residual = progress_.residual();
  report.speed = progress_.size;
  report.first_speed = progress_.scale;
  report.method = progress_.method;
  report.stalled = has_stalled_;
  find_bad_contacts(report);
  find_stable_step(report);
  find_worst_contact(report);
  const std::int32_t refused = evaluate_balance(report);
  if (ranks_.any_rank(refused < 0)) return refused < 0 ? refused : std::int32_t{ILAW_INVALID_ARGUMENT};
  if (!progress_.is_solved() || !balance_.empty()) report.energy_error = energy_error();
  write(report);
  return report.bad_count > 0 ? ILAW_BAD_NODES : ILAW_OK;
}

const char* Solver::open(const ilaw_bodies* bodies, const ilaw_contacts* const* groups,
                         std::int64_t group_count, ilaw_coupled_report& report) {
  if (const char* reason = Bodies::complaint(bodies)) return reason;
  if (group_count < 0 || (group_count > 0 && !groups)) return "groups are missing";
  if (const char* reason = problem_.bodies.read(sized::read(bodies))) return reason;
  problem_.group_count = static_cast<std::size_t>(group_count);
  if (problem_.groups.size() < problem_.group_count) problem_.groups.resize(problem_.group_count);
  for (std::size_t g = 0; g < problem_.group_count; ++g) {
    report.bad_group = static_cast<std::int64_t>(g);
    if (!groups[g]) return "a group is null";
    for (std::size_t f = 0; f < g; ++f)
      if (groups[f] == groups[g]) return "a group is given twice";
    if (const char* reason = problem_.groups[g].open(*groups[g], problem_.bodies)) return reason;
  }
  report.bad_group = -1;
  return complaint_of_overlaps(sized::read(bodies));
}

// Outputs that begin at the same number, and outputs of contacts that are an input of the bodies.
const char* Solver::complaint_of_overlaps(const ilaw_bodies& bodies) {
  std::vector<const double*>& outputs = outputs_;
  outputs.clear();
  for (std::size_t g = 0; g < problem_.group_count; ++g) problem_.groups[g].add_outputs(outputs);
  for (const ilaw_input* a : {&bodies.v_free, &bodies.spin_free, &bodies.v_previous, &bodies.inverse_mass})
    if (a->values && std::find(outputs.begin(), outputs.end(), a->values) != outputs.end())
      return "an output of contacts is an input of bodies";
  for (const ilaw_output* a : {&bodies.velocity, &bodies.spin, &bodies.impulse, &bodies.angular_impulse})
    if (a->values && bodies.count > 0) outputs.push_back(a->values);
  std::sort(outputs.begin(), outputs.end());
  return std::adjacent_find(outputs.begin(), outputs.end()) == outputs.end() ? nullptr
                                                                             : "two outputs are one array";
}

// Each copy of a body that has contacts counts, whichever rank it is on.
void Solver::split_shared_bodies() {
  if (!ranks_.any()) return;
  counts_.assign(static_cast<std::size_t>(problem_.bodies.count()), 0.0);
  for (std::size_t g = 0; g < problem_.group_count; ++g)
    for (std::int64_t k = 0; k < problem_.groups[g].count(); ++k)
      for (std::uint32_t e = 0; e < problem_.groups[g].ends(); ++e)
        if (const std::int32_t b = problem_.groups[g].end(k, e); b != problem_.bodies.wall())
          counts_[static_cast<std::size_t>(b)] = 1.0;
  ranks_.sum_bodies(counts_);
  problem_.bodies.split(counts_);
}

const char* Solver::make_blocks(ilaw_coupled_report& report) {
  blocks_.clear();
  order_.clear();
  colours_.begin();
  for (std::size_t g = 0; g < problem_.group_count; ++g)
    colours_.assign(problem_.groups[g], static_cast<std::int32_t>(g), problem_.bodies, blocks_, order_);
  blocks_.allocate();
  problem_.speeds.resize(order_.size());
  std::atomic<bool> is_refused = false;
  sweep_.share(blocks_.list().size(), knobs::few_blocks, [&](std::size_t first, std::size_t end) {
    for (std::size_t b = first; b < end; ++b)
      if (!fill(blocks_.list()[b])) is_refused = true;
  });
  if (!is_refused) return refuse_held_axes(report);
  for (Block& block : blocks_.list()) {
    report.bad_group = block.group;
    if (!fill(block)) break;
  }
  return "delassus_form is transverse, and an arm is not along the normal";
}

// H of an axis along which nothing moves is small instead of 0. The velocity along it is given, so an impulse
// that a law bounds is right to that part; one that grows as H shrinks has no solution.
const char* Solver::refuse_held_axes(ilaw_coupled_report& report) {
  constexpr double larger = 16.0, grown = 8.0, ulps = 64.0, oblique = 1e-9;
  for (Block& block : blocks_.list()) {
    const Contacts& group = problem_.group(block);
    if (!group.may_be_held()) continue;
    std::array<Columns, 2> impulse{};
    Columns v_free{}, delassus{};
    bool is_held = false;
    for (std::size_t q = 0; q < block.count; ++q)
      for (std::size_t c = 0; c < 3; ++c) is_held = is_held || group.is_held(block, q, c);
    if (!is_held) continue;
    std::vector<double> state(block.stride * static_cast<std::size_t>(block.layout->state_size) + 1);
    std::array<std::uint8_t, max_stride> status{};
    sweep_.gather(block, v_free.data());
    for (std::size_t k = 0; k < 2; ++k) {
      for (int c = 0; c < block.layout->delassus_size; ++c)
        for (std::size_t q = 0; q < block.count; ++q) {
          const auto at = static_cast<std::size_t>(c);
          const double factor = k == 0 && at < 3 && group.is_held(block, q, at) ? larger : 1.0;
          delassus[at * max_stride + q] = factor * block.column(block.layout->delassus + c)[q];
        }
      ilaw_report found{};
      if (group.evaluate(
              block,
              {v_free.data(), delassus.data(), max_stride, impulse[k].data(), state.data(), status.data()},
              found) < 0)
        return nullptr;  // the iterations name it
    }
    for (std::size_t q = 0; q < block.count; ++q)
      for (std::size_t c = 0; c < 3; ++c) {
        if (!group.is_held(block, q, c)) continue;
        const double before = std::fabs(impulse[0][c * max_stride + q]), r = impulse[1][c * max_stride + q];
        const double made = delassus[c * max_stride + q] * std::fabs(r);
        const double known = ulps * std::numeric_limits<double>::epsilon() * problem_.bodies.free_speed();
        const double along_axis = block.at(block.layout->normal, q)[c];
        // Other contacts may still free one whose normal is oblique, or that slips.
        const bool is_sure = along_axis * along_axis > 1.0 - oblique || status[q] == ILAW_BONDED;
        if (!(is_sure && std::fabs(r) > grown * before && made > known)) continue;
        report.bad_group = block.group;
        report.bad_contact = block.contact[q];
        const bool is_normal = std::fabs(along_axis) > 0.5;
        char along[16] = "its normal";
        if (!is_normal) std::snprintf(along, sizeof along, "axis %zu", c);
        std::snprintf(
            message_.data(), message_.size(),
            "contact %lld of group %lld: body %lld cannot move along %s, and the law '%s' must push it",
            static_cast<long long>(report.bad_contact), static_cast<long long>(report.bad_group),
            static_cast<long long>(block.end(0, q)), along, group.law_id());
        report.message = message_.data();
        return message_.data();
      }
  }
  return nullptr;
}

// False where an arm is not along the normal.
bool Solver::fill(Block& block) {
  for (std::size_t lane = 0; lane < block.count; ++lane)
    if (!problem_.group(block).fill(block, lane, order_[block.order + lane], problem_.bodies)) return false;
  sweep_.read_velocities(block);
  sweep_.find_speeds(block, problem_.speeds.data() + block.order);
  return true;
}

// Iterations add changes to the velocities, and with them rounding. At their end velocities are made anew
// from the impulses; where that moves them by more than the tolerance, iterations go on. They solve with the
// bonds that hold; those whose load at that solution is too large break together, and the next round sheds
// it on the others. So the ruptures of a step depend on no order of contacts. Where bonds that hold have no
// solution, such as one that a wall pushes against another law, the laws decide.
void Solver::iterate(Limits limits) {
  constexpr int most_times = 10;
  constexpr double rounding = 4.0 * std::numeric_limits<double>::epsilon();
  find_scale(limits);
  for (Block& block : blocks_.list())
    problem_.group(block).close_gaps(block, limits.rounding, limits.tolerance,
                                     problem_.speeds.data() + block.order);
  forget_large_impulses();
  set_velocities();
  has_stalled_ = false;
  for (int times = 0;; ++times) {
    progress_ = iterations_.run(blocks_, progress_, has_stalled_);
    const double limit = std::max(std::max(limits.tolerance, rounding) * progress_.scale, limits.rounding);
    const bool moved = ranks_.any_rank(set_velocities() > limit);
    if (moved && times < most_times && progress_.is_solved() && !progress_.is_over()) continue;
    if (progress_.code < 0) return;
    if (ranks_.any_rank(sweep_.break_bonds(blocks_)))
      progress_ = progress_.once_more(1);
    else if (!progress_.is_solved() && ranks_.any_rank(release_bonds()))
      progress_ = progress_.once_more(limits.most);
    else
      return;
    times = 0;
  }
}

// False: none are held.
bool Solver::release_bonds() {
  bool any = false;
  for (std::size_t g = 0; g < problem_.group_count; ++g) {
    any = any || problem_.groups[g].holds_bonds();
    problem_.groups[g].release_bonds();
  }
  return any;
}

double Solver::set_velocities() {
  here_.assign(static_cast<std::size_t>(problem_.bodies.count()) + 1, {});
  sweep_.add_impulses(blocks_, here_);
  here_.pop_back();
  if (ranks_.any()) {
    everywhere_ = here_;
    ranks_.sum_bodies(everywhere_, problem_.bodies.rotate());
  }
  return problem_.bodies.set(ranks_.any() ? everywhere_ : here_);
}

// The largest velocity that the problem brings to a contact. Contacts of bodies that move together have the
// rounding of their common speed, which no residual goes below.
void Solver::find_scale(Limits& limits) {
  constexpr double rounding = 4.0 * std::numeric_limits<double>::epsilon();
  std::array<double, 2> most{limits.speed, problem_.bodies.free_speed()};
  for (const double of_contact : problem_.speeds) most[0] = of_contact > most[0] ? of_contact : most[0];
  ranks_.largest(most.data(), most.size());
  limits.speed = std::max(limits.speed, rounding / limits.tolerance * most[1]);
  progress_ = {};
  progress_.limits = limits;
  progress_.scale = std::max(most[0], limits.speed);
}

// Impulses of an earlier step whose rounding is too large for this one are no start.
void Solver::forget_large_impulses() {
  constexpr double largest_start = 1e-10 / std::numeric_limits<double>::epsilon();
  const auto begins = [](const Block& block) {
    for (std::size_t lane = 0; lane < block.count; ++lane)
      if (!block.is_free(lane)) return true;
    return false;
  };
  Columns made{};
  double most = 0.0;
  for (const Block& block : blocks_.list()) {
    if (!begins(block)) continue;
    sweep_.respond(block, block.column(block.layout->impulse), block.stride, made.data());
    for (std::size_t q = 0; q < block.count; ++q) most = std::max(most, size_at(block, made.data(), q));
  }
  progress_.is_cold = !ranks_.any_rank(most > 0.0);
  if (!ranks_.any_rank(most > largest_start * progress_.scale)) return;
  progress_.is_cold = true;
  for (Block& block : blocks_.list())
    std::fill_n(block.column(block.layout->impulse),
                static_cast<std::size_t>(block.layout->width) * block.stride, 0.0);
}

// Energies and amounts of the last evaluation of each contact, kept until no call can be refused any more.
std::int32_t Solver::evaluate_balance(ilaw_coupled_report& report) {
  balance_.clear();
  Columns v_free{}, answer{};
  std::array<std::uint8_t, max_stride> status{};
  for (Block& block : blocks_.list()) {
    const Contacts& group = problem_.group(block);
    if (!group.asks_balance()) continue;
    const Layout& layout = *block.layout;
    for (int c = 0; c < layout.width; ++c)
      std::copy_n(block.column(layout.asked + c), block.stride,
                  v_free.data() + static_cast<std::size_t>(c) * max_stride);
    const std::size_t columns = ILAW_ENERGY_COUNT + group.amount_count(), at = balance_.size();
    balance_.resize(at + columns * max_stride);
    balance_state_.resize(block.stride * static_cast<std::size_t>(layout.state_size) + 1);
    double* energy = balance_.data() + at;
    amounts_.clear();
    for (std::size_t c = ILAW_ENERGY_COUNT; c < columns; ++c)
      amounts_.push_back(ilaw::output(energy + c * max_stride, 1, 0));
    const Contacts::Call call{v_free.data(),
                              block.column(layout.delassus),
                              block.stride,
                              answer.data(),
                              balance_state_.data(),
                              status.data(),
                              group.asks_energy() ? energy : nullptr,
                              amounts_.empty() ? nullptr : amounts_.data()};
    ilaw_report found{};
    const std::int32_t code = group.evaluate(block, call, found);
    if (code >= 0) continue;
    report.bad_group = block.group;
    report.reason = found.reason;
    return code;
  }
  return ILAW_OK;
}

void Solver::write(ilaw_coupled_report& report) {
  const double* balance = balance_.data();
  double twice_wall_work = 0.0;
  for (const Block& block : blocks_.list()) {
    const Contacts& group = problem_.group(block);
    for (std::size_t lane = 0; lane < block.count; ++lane) {
      group.write(block, lane);
      if (group.has_wall()) twice_wall_work += group.wall_work(block, lane);
      if (group.asks_balance())
        group.write_balance(block, lane, balance, balance + ILAW_ENERGY_COUNT * max_stride, report.energy);
    }
    if (group.asks_balance()) balance += (ILAW_ENERGY_COUNT + group.amount_count()) * max_stride;
  }
  report.work = problem_.bodies.work(here_) - 0.5 * twice_wall_work;
  problem_.bodies.write(ranks_.any() ? everywhere_ : here_);
}

}  // namespace ilaw::coupled
