// SPDX-License-Identifier: BSD-3-Clause
#include "solver.hpp"

#include "sizes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

namespace ilaw::coupled {
namespace {

constexpr std::uint32_t default_sweeps = 1000;
constexpr double default_tolerance = 1e-10;
// Sweeps without a better residual after which a law is taken for one that jumps, and is not accelerated.
constexpr std::uint32_t patience = 200;

const char* complaint(const ilaw_bodies* given) {
  if (!sized::is_complete(given)) return "bodies are missing, or their struct_size is wrong";
  const ilaw_bodies bodies = sized::read(given);
  if (bodies.dimension < 1 || bodies.dimension > 3) return "dimension is not 1, 2 or 3";
  if (bodies.owned_count < 0 || bodies.count < bodies.owned_count) return "counts of bodies are wrong";
  if (bodies.count > most_entries) return "count is above 2^40";
  for (const ilaw_output* a : {&bodies.velocity, &bodies.spin, &bodies.impulse, &bodies.angular_impulse})
    if (a->floats || collides(*a, bodies.count, bodies.dimension))
      return "an output of bodies has floats or a stride of 0";
  if (bodies.count == 0) return nullptr;
  if (!bodies.inverse_mass.values || !bodies.v_free.values) return "inverse_mass or v_free is missing";
  if (!bodies.inverse_inertia.values) return nullptr;
  if (bodies.dimension != 3) return "bodies rotate in dimension 3 alone";
  if (!bodies.spin_free.values) return "spin_free is missing";
  return bodies.v_previous.values && !bodies.spin_previous.values ? "spin_previous is missing" : nullptr;
}

}  // namespace

std::int32_t Solver::solve(const ilaw_bodies* bodies, const ilaw_contacts* const* groups,
                           std::int64_t group_count, const ilaw_coupled_options& options,
                           ilaw_coupled_report& report) {
  exchange_ = options.exchange;
  report.bad_group = report.bad_contact = -1;
  report.stable_velocity_step = std::numeric_limits<double>::infinity();
  report.reason = open(bodies, groups, group_count, report);
  const bool refused_here = report.reason != nullptr;
  if (any_rank(refused_here)) {
    if (!refused_here) report.reason = "another rank's call was refused";
    return ILAW_INVALID_ARGUMENT;
  }
  report.bad_group = -1;
  if (const std::int32_t code = iterate(options, report); code < 0) return code;
  return write(report);
}

const char* Solver::open(const ilaw_bodies* bodies, const ilaw_contacts* const* groups,
                         std::int64_t group_count, ilaw_coupled_report& report) {
  if (const char* reason = complaint(bodies)) return reason;
  if (group_count < 0 || (group_count > 0 && !groups)) return "groups are missing";
  bodies_.read(sized::read(bodies));
  group_count_ = static_cast<std::size_t>(group_count);
  if (groups_.size() < group_count_) groups_.resize(group_count_);
  for (std::size_t g = 0; g < group_count_; ++g) {
    report.bad_group = static_cast<std::int64_t>(g);
    if (!groups[g]) return "a group is null";
    if (const char* reason = groups_[g].open(*groups[g], bodies_)) return reason;
  }
  return nullptr;
}

std::int32_t Solver::iterate(const ilaw_coupled_options& options, ilaw_coupled_report& report) {
  const std::uint32_t most = options.most_sweeps > 0 ? options.most_sweeps : default_sweeps;
  const double tolerance = options.tolerance > 0.0 ? options.tolerance : default_tolerance;
  sum_answers();
  sums_before_ = sums_;
  of_trial_ = of_before_ = of_answer_;
  nesterov_ = 1.0;
  double least = std::numeric_limits<double>::infinity();
  std::uint32_t least_at = 0;
  bool changed = true;
  for (report.sweeps = 0; report.sweeps < most;) {
    if (changed)
      for (Contacts& group : std::span(groups_).first(group_count_)) group.split(sums_, bodies_);
    const std::int32_t code = evaluate(report);
    ++report.sweeps;
    sums_before_.swap(sums_);
    of_before_.swap(of_answer_);
    sum_answers();

    std::array<double, 4> found{0.0, 0.0, code < 0 ? 1.0 : 0.0, counts_changed() ? 1.0 : 0.0};
    for (const Contacts& group : std::span(groups_).first(group_count_)) {
      const Contacts::Residual residual = group.residual(of_answer_);
      found[0] = larger(found[0], residual.difference);
      found[1] = std::fmax(found[1], residual.size);
    }
    if (exchange_) exchange_->largest(exchange_->context, found.data(), found.size());
    if (found[2] > 0.0) return code < 0 ? code : ILAW_INVALID_ARGUMENT;
    report.residual = found[0] > 0.0 ? found[0] / found[1] : 0.0;
    if (report.residual <= tolerance) break;

    changed = found[3] > 0.0;
    if (report.residual < least) least = report.residual, least_at = report.sweeps;
    extrapolate(momentum(report.sweeps - least_at > patience));
  }
  return ILAW_OK;
}

std::int32_t Solver::evaluate(ilaw_coupled_report& report) {
  report.bad_count = 0;
  report.bad_group = report.bad_contact = -1;
  report.reason = nullptr;
  for (std::size_t g = 0; g < group_count_; ++g) {
    const std::int32_t code = groups_[g].evaluate(of_trial_);
    const ilaw_report& said = groups_[g].report();
    // NaN, or below 0, would pass for no limit at all.
    if (!(said.stable_velocity_step >= 0.0)) {
      report.bad_group = static_cast<std::int64_t>(g);
      report.reason = "a law reported a stable step that is below 0 or not a number";
      return ILAW_BAD_LIBRARY;
    }
    if (said.stable_velocity_step > 0.0)
      report.stable_velocity_step = std::fmin(report.stable_velocity_step, said.stable_velocity_step);
    if (code == ILAW_OK) continue;
    if (report.bad_group < 0) {
      report.bad_group = static_cast<std::int64_t>(g);
      report.bad_contact = code < 0 ? -1 : said.first_bad_node;
      report.reason = said.reason;
    }
    if (code < 0) return code;
    report.bad_count += said.bad_count;
  }
  return ILAW_OK;
}

void Solver::sum_answers() {
  sums_.assign(static_cast<std::size_t>(bodies_.count() * bodies_.components()), 0.0);
  for (const Contacts& group : std::span(groups_).first(group_count_)) group.add_to(sums_, bodies_);
  if (exchange_) exchange_->sum_bodies(exchange_->context, sums_.data(), bodies_.components());
  of_answer_ = bodies_.free();
  for (std::size_t i = 0; i < of_answer_.size(); ++i)
    of_answer_[i] = of_answer_[i] + bodies_.change(sums_, static_cast<std::int64_t>(i));
}

bool Solver::counts_changed() const {
  const auto stride = static_cast<std::size_t>(bodies_.components());
  for (std::size_t i = 0; i < sums_.size(); i += stride)
    if (sums_[i] != sums_before_[i]) return true;
  return false;
}

// How much of the last change the next trial adds. None where the answer turned back against it: the
// gradient scheme of O'Donoghue and Candes (2015), equation 13, with the kinetic energy as its product.
double Solver::momentum(bool learn_anew) {
  difference_.resize(of_answer_.size());
  for (std::size_t i = 0; i < difference_.size(); ++i) difference_[i] = of_trial_[i] - of_answer_[i];
  double uphill = bodies_.product(sums_, difference_) - bodies_.product(sums_before_, difference_);
  if (exchange_) exchange_->sum(exchange_->context, &uphill, 1);
  if (uphill > 0.0 || learn_anew) {
    nesterov_ = 1.0;
    return 0.0;
  }
  const double before = nesterov_;
  nesterov_ = 0.5 * (1.0 + std::sqrt(1.0 + 4.0 * before * before));
  return (before - 1.0) / nesterov_;
}

void Solver::extrapolate(double by) {
  for (Contacts& group : std::span(groups_).first(group_count_)) group.extrapolate(by);
  for (std::size_t i = 0; i < of_trial_.size(); ++i)
    of_trial_[i] = by == 0.0 ? of_answer_[i] : of_answer_[i] + by * (of_answer_[i] - of_before_[i]);
}

std::int32_t Solver::write(ilaw_coupled_report& report) {
  std::int32_t refused = ILAW_OK;
  for (std::size_t g = 0; g < group_count_ && refused == ILAW_OK; ++g) {
    const std::int32_t code = groups_[g].evaluate_balance(of_answer_);
    if (code >= 0) continue;
    refused = code;
    report.bad_group = static_cast<std::int64_t>(g);
    report.reason = groups_[g].report().reason;
  }
  if (any_rank(refused < 0)) return refused < 0 ? refused : ILAW_INVALID_ARGUMENT;
  for (const Contacts& group : std::span(groups_).first(group_count_))
    group.write(of_answer_, bodies_, report);
  bodies_.write(of_answer_, sums_);
  return report.bad_count > 0 ? ILAW_BAD_NODES : ILAW_OK;
}

bool Solver::any_rank(bool here) const {
  double any = here ? 1.0 : 0.0;
  if (exchange_) exchange_->largest(exchange_->context, &any, 1);
  return any > 0.0;
}

}  // namespace ilaw::coupled
