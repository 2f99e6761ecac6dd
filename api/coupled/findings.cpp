// What a solve tells beyond its impulses: bad contacts, the stable step, the worst contact and why.
// SPDX-License-Identifier: BSD-3-Clause
#include "solver.hpp"

#include <ilaw/decimal_text.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>

namespace ilaw::coupled {

void Solver::find_bad_contacts(ilaw_coupled_report& report) const {
  for (const Block& block : blocks_.list()) {
    for (std::size_t lane = 0; lane < block.count && block.is_refused; ++lane) {
      if (block.status[lane] < ILAW_BAD_INPUT) continue;
      ++report.bad_count;
      const std::int64_t k = block.contact[lane];
      const bool is_first = report.bad_group < 0 || block.group < report.bad_group ||
                            (block.group == report.bad_group && k < report.bad_contact);
      if (!is_first) continue;
      report.bad_group = block.group;
      report.bad_contact = k;
      report.reason = block.reason;
    }
  }
}

// Springs between bodies: with masses divided among the contacts that push, no set of them is stiffer than
// its contacts are one by one. Only where a law has a limit at all.
void Solver::find_stable_step(ilaw_coupled_report& report) {
  const bool has_limit = std::isfinite(sweep_.stable_step());
  if (!ranks_.any_rank(has_limit)) return;
  counts_.assign(static_cast<std::size_t>(problem_.bodies.count()) + 1, 0.0);
  for (const Block& block : blocks_.list())
    for (std::size_t q = 0; q < block.count; ++q)
      for (int e = 0; e < block.layout->ends; ++e)
        if (!block.is_free(q)) counts_[static_cast<std::size_t>(block.end(e, q))] += 1.0;
  counts_.pop_back();
  ranks_.sum_bodies(counts_);
  counts_.push_back(1.0);
  Columns v_free{}, answer{};
  std::array<double, 6 * max_stride> delassus{};
  std::array<std::uint8_t, max_stride> status{};
  std::vector<double> state;
  sweep_.reset();
  double least = std::numeric_limits<double>::infinity();
  for (Block& block : blocks_.list()) {
    const Layout& layout = *block.layout;
    sweep_.gather(block, v_free.data());
    for (std::size_t q = 0; q < block.count; ++q) {
      double share = 1.0;
      for (int e = 0; e < layout.ends; ++e)
        share = std::max(share, counts_[static_cast<std::size_t>(block.end(e, q))]);
      for (int c = 0; c < layout.delassus_size; ++c)
        delassus[static_cast<std::size_t>(c) * max_stride + q] = share * block.column(layout.delassus + c)[q];
    }
    state.resize(block.stride * static_cast<std::size_t>(layout.state_size) + 1);
    ilaw_report found{};
    const std::int32_t code = problem_.group(block).evaluate(
        block, {v_free.data(), delassus.data(), max_stride, answer.data(), state.data(), status.data()},
        found);
    if (code >= 0 && found.stable_velocity_step > 0.0) least = std::min(least, found.stable_velocity_step);
  }
  report.stable_velocity_step = least;
}

// Contacts have moved on from the velocities of their last evaluation by the impulses of later ones. The
// energies of a law belong to that evaluation: an impulse r at a contact that is off by s works r.s/2 more.
double Solver::energy_error() const {
  Columns made{}, velocity{};
  double error = 0.0;
  for (const Block& block : blocks_.list()) {
    if (block.asleep) continue;
    const Layout& layout = *block.layout;
    sweep_.gather(block, velocity.data());
    sweep_.respond(block, block.column(layout.impulse), block.stride, made.data());
    for (std::size_t q = 0; q < block.count; ++q) {
      double work = 0.0, rounding = 0.0;  // of H r, where impulses are larger than what they move
      for (int c = 0; c < layout.width; ++c) {
        const std::size_t i = static_cast<std::size_t>(c) * max_stride + q;
        const double off = velocity[i] - made[i] - block.column(layout.asked + c)[q];
        const double r = block.column(layout.impulse + c)[q];
        if (r != 0.0) work += r * off;
        rounding += std::numeric_limits<double>::epsilon() * std::fabs(r * made[i]);
      }
      error += 0.5 * std::fabs(work) + rounding;
    }
  }
  return error;
}

void Solver::find_worst_contact(ilaw_coupled_report& report) {
  if (progress_.is_solved()) return;
  Columns response{};
  double most = -1.0;
  const Block* worst = nullptr;
  std::size_t worst_lane = 0;
  for (const Block& block : blocks_.list()) {
    if (block.asleep) continue;
    sweep_.respond(block, block.column(block.layout->change), block.stride, response.data());
    for (std::size_t q = 0; q < block.count; ++q) {
      const double change = size_at(block, response.data(), q);
      if (!(change > most)) continue;
      most = change;
      worst = &block;
      worst_lane = q;
    }
  }
  if (!worst) return;
  report.worst_group = worst->group;
  report.worst_contact = worst->contact[worst_lane];
  explain(*worst, worst_lane, report);
}

void Solver::explain(const Block& worst, std::size_t lane, ilaw_coupled_report& report) {
  describe_island(worst.order + lane, report);
  if (progress_.grows) find_opposed_laws(worst, lane, report);
  const char *law = problem_.group(worst).law_id(), *other = report.other_law;
  std::snprintf(message_.data(), message_.size(),
                "%s%s%s%s%s after %u iterations: contact %lld of group %lld (law '%s') is off by %s; "
                "%lld contacts are coupled, with masses of 1:%s%s",
                other ? "laws '" : "contacts are not solved", other ? law : "", other ? "' and '" : "",
                other ? other : "", other ? "' push against each other without end" : "", report.sweeps,
                static_cast<long long>(report.worst_contact), static_cast<long long>(report.worst_group), law,
                decimal_text(progress_.change, 3).get(), static_cast<long long>(report.island_contacts),
                decimal_text(report.mass_ratio, 2).get(),
                other ? "; remove one of them, or let it give way" : "");
  report.message = message_.data();
}

// The contacts coupled with one of them, and the masses of their bodies that can move, heaviest to lightest.
void Solver::describe_island(std::size_t contact, ilaw_coupled_report& report) {
  islands_.label(blocks_, problem_);
  const std::vector<std::int32_t>& labels = islands_.labels();
  double least = std::numeric_limits<double>::infinity(), most = 0.0;
  for (const Block& block : blocks_.list())
    for (std::size_t q = 0; q < block.count; ++q) {
      if (labels[block.order + q] != labels[contact]) continue;
      ++report.island_contacts;
      for (int e = 0; e < block.layout->ends; ++e) {
        const std::int32_t body = block.end(e, q);
        if (!problem_.bodies.is_movable(body)) continue;
        const Vector inverse = problem_.bodies.inertia_of(body).inverse_mass;
        const double largest_inverse = std::max({inverse[0], inverse[1], inverse[2]});
        if (!(largest_inverse > 0.0)) continue;
        least = std::min(least, largest_inverse);
        most = std::max(most, largest_inverse);
      }
    }
  report.mass_ratio = most > 0.0 ? most / least : 1.0;
}

// The other law: of the contact at the same bodies with the largest impulse.
void Solver::find_opposed_laws(const Block& worst, std::size_t lane, ilaw_coupled_report& report) const {
  double most = 0.0;
  for (const Block& block : blocks_.list())
    for (std::size_t q = 0; q < block.count; ++q) {
      bool shares = false;
      for (int e = 0; e < block.layout->ends; ++e)
        for (int f = 0; f < worst.layout->ends; ++f)
          shares = shares ||
                   (block.end(e, q) == worst.end(f, lane) && problem_.bodies.is_movable(block.end(e, q)));
      if (!shares || (&block == &worst && q == lane)) continue;
      const double size = largest(block.at(block.layout->impulse, q));
      if (!(size > most)) continue;
      most = size;
      report.other_law = problem_.group(block).law_id();
    }
  if (report.other_law) report.law = problem_.group(worst).law_id();
}

}  // namespace ilaw::coupled
