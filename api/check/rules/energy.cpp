// Rules: a node that flies onto its interface, along a path and pushed by forces, gains no energy there.
// SPDX-License-Identifier: BSD-3-Clause
#include "check/rule.hpp"

#include <cmath>
#include <optional>

namespace ilaw::check {
namespace {

// Energies below are rounded as subnormal numbers.
double least(const Trial& trial) { return trial.setup.floats() ? 1e-36 : 1e-300; }
constexpr std::size_t point_count = 24, steps = 12;

struct Flight {
  bool has_force, has_v_smooth, has_even_steps;
};
constexpr Flight flights[] = {
    {false, false, true}, {false, true, false}, {false, true, true}, {true, false, true}, {true, true, true}};

struct Step {
  const Inputs& in;
  const Results& found;
  std::size_t node;
  double work, stored;  // of the impulse; more than before
  double size;          // of what cancels in them
};

double stored_of(const Results& found, std::size_t i) {
  return found.energy.empty() ? 0.0 : found.energy[i * ILAW_ENERGY_COUNT + ILAW_ENERGY_STORED];
}

// Sizes of v_free + H r + k n x m and of w_free + J m - k n x r, in which they round.
using Sizes = Eigen::Vector2d;
Sizes halves_of(const Wrench& wrench) { return {wrench.head<3>().norm(), wrench.tail<3>().norm()}; }
Sizes sizes_of(const Inputs& in, const Results& found, std::size_t i) {
  const Eigen::Matrix<double, 6, 6> gain = in.gain(i);
  const Wrench action = found.action(i);
  const Sizes own{(gain.topLeftCorner<3, 3>() * action.head<3>()).norm(),
                  (gain.bottomRightCorner<3, 3>() * action.tail<3>()).norm()};
  const double k = std::sqrt(0.5) * gain.topRightCorner<3, 3>().norm();
  return halves_of(in.free(i)) + own + k * halves_of(action).reverse();
}

// v^- is the last step's v_free + H r as the host rounded it. A law that moves its bond by what it solved
// knows it unrounded, so that the work differs from what becomes of it by |r| ulp (|v_free| + |H r|) of the
// last step: all there is where a node was stopped, and only that is left of its velocity.
Step step_of(const Inputs& in, const Results& found, std::size_t i, double stored_before,
             const Sizes& before) {
  const Wrench action = found.action(i);
  // The work r.(v^- + v)/2 with v = v_free + H r. That of a moment likewise.
  const double work = 0.5 * action.dot(in.previous(i) + in.free(i) + in.gain(i) * action),
               now = stored_of(found, i);
  Sizes actions = halves_of(action);
  // In the host's axes a tangential velocity is off by the rounding of v_free, in any direction: so is what
  // stops it.
  if (!in.normal.empty() && actions[0] > 0.0)
    actions[0] += in.vector(in.v_free, i).norm() / (in.h(i) * in.normal_at(i)).norm();
  const double size = actions.dot(sizes_of(in, found, i) + before) + std::abs(now) + std::abs(stored_before);
  return {in, found, i, work, now - stored_before, size};
}

// The velocity after this step is that before the next one, and the gap follows it.
void go_on(Inputs& in, const Results& found, std::size_t i) {
  const Wrench after = in.free(i) + in.gain(i) * found.action(i);
  in.set_vector(in.v_free, i, after.head<3>());
  if (in.spins()) in.set_vector(in.spin_free, i, after.tail<3>());
  in.gap[i] += in.position_step * in.normal_at(i).dot(after.head<3>());
}

// A node is turned round within a step, pushed a little, or left alone.
void push(Inputs& in, Draw& draw) {
  for (std::vector<double>* free : {&in.v_free, &in.spin_free})
    for (std::size_t i = 0; i < in.count && !free->empty(); ++i) {
      const double turned = draw.one_in(4) ? -draw.within(0.5, 2.0) : 1.0, size = draw.one_in(2) ? 1.0 : 0.0;
      for (std::size_t c = i * in.dimension; c < (i + 1) * in.dimension; ++c)
        (*free)[c] = turned * (*free)[c] + size * draw.within(-1.0, 1.0);
    }
}

// Laws that limit the step are the scheme's to bound.
Judge on_flights(void (*look)(const Trial& trial, const Step& step)) {
  return on_trials(
      [look](const Trial& trial, Draw& draw) {
        if (!trial.writes(ILAW_OUTPUT_ENERGY) && trial.can(ILAW_CAN_STORE_ENERGY)) return false;
        // A contact that does not read v^- cannot know that a force turned its node round.
        const bool may_be_pushed = trial.reads(ILAW_INPUT_V_PREVIOUS) || trial.can(ILAW_CAN_ADHERE) ||
                                   trial.can(ILAW_CAN_STORE_ENERGY);
        for (const Flight& flight : flights) {
          if (flight.has_force && !may_be_pushed) continue;
          Inputs in = draw_script(trial, draw, {point_count, 1}, true)[0];
          in.velocity_step = in.position_step = 0x1p-10;
          for (std::size_t i = 0; i < point_count; ++i)
            in.gap[i] = in.gap_offset[i] + draw.within(0.0, 3.0) * in.position_step;
          Started arrays(trial, in);
          std::vector<double> stored(point_count);
          std::vector<Sizes> sizes(point_count, Sizes::Zero());
          for (std::size_t k = 0; k < steps; ++k) {
            in.v_previous = in.v_free;
            in.spin_previous = in.spin_free;
            in.v_smooth.clear();
            if (flight.has_force && k > 0) push(in, draw);
            if (flight.has_v_smooth && trial.reads(ILAW_INPUT_V_SMOOTH)) draw_smooth(in, draw);
            in.round_to(trial.setup);
            const Results found = arrays.evaluate(in);
            if (found.code != ILAW_OK) break;
            if (std::isfinite(found.report.stable_velocity_step) && found.report.stable_velocity_step > 0.0)
              return false;
            for (std::size_t i = 0; i < point_count; ++i) {
              look(trial, step_of(in, found, i, stored[i], sizes[i]));
              stored[i] = stored_of(found, i);
              sizes[i] = sizes_of(in, found, i);
              go_on(in, found, i);
            }
            in.time += in.position_step;
            // A velocity step lies between two positions' middles.
            const double last = in.position_step;
            if (!flight.has_even_steps) in.position_step = 0x1p-10 * draw.within(0.5, 1.5);
            in.velocity_step = 0.5 * (last + in.position_step);
          }
        }
        return true;
      },
      "the law limits the step, or its stored energy is not known");
}

void not_made(const Trial& trial, const Step& step) {
  const double most = 256.0 * trial.epsilon() * step.size;
  if (step.work + step.stored > most + least(trial))
    fail(trial, step.in, step.node,
         joined("the impulse did the work ", step.work, ", and ", step.stored,
                " more is stored: energy was made"),
         joined("their sum at most ", most));
}

void balanced(const Trial& trial, const Step& step) {
  if (step.found.energy.empty()) return;
  double dissipated = 0.0;
  for (std::size_t c = 0; c < ILAW_ENERGY_STORED; ++c)
    dissipated += step.found.energy[step.node * ILAW_ENERGY_COUNT + c];
  const double rest = step.work + step.stored + dissipated,
               most = 256.0 * trial.epsilon() * (step.size + dissipated);
  if (!(std::abs(rest) <= most + least(trial)))
    fail(trial, step.in, step.node,
         joined("work ", step.work, ", dissipated ", dissipated, ", stored ", step.stored, ": a rest of ",
                rest),
         joined("a rest of at most ", most));
}

// A node alone that approaches, closed, as a batch of its own.
Inputs approaching(const Trial& trial, Draw& draw) {
  Inputs in = draw_script(trial, draw, {1, 1}, true)[0];
  Vector v = -in.normal_at(0);
  for (std::size_t c = 0; c < in.dimension; ++c) v[c] *= draw.within(0.2, 1.0);
  in.set_vector(in.v_free, 0, v);
  in.v_smooth.clear();  // it is v_free
  return in;
}

// How r_N answers to the gap and to the velocity v^- = v_free along the normal: none where it has a kink.
struct Slopes {
  double by_gap, by_velocity;
};
std::optional<Slopes> slopes_of(Arrays& arrays, const Inputs& in, const std::vector<double>& state) {
  const Vector n = in.normal_at(0);
  const auto normal_impulse = [&](double gap, double velocity) {
    Inputs moved = in;
    moved.gap[0] += gap;
    moved.set_vector(moved.v_free, 0, in.vector(in.v_free, 0) + velocity * n);
    moved.v_previous = moved.v_free;
    arrays.set_state(state);
    return n.dot(arrays.evaluate(moved).action(0).head<3>());
  };
  const double gap = 1e-4 * std::abs(in.slack(0)), speed = 1e-4 * in.vector(in.v_free, 0).norm();
  const double middle = normal_impulse(0.0, 0.0);
  const auto slope = [&](double above, double below, double by) -> std::optional<double> {
    const double bend = std::abs(above - 2.0 * middle + below);
    if (bend > 1e-2 * std::abs(above - below) + 1e-12 * std::abs(middle)) return std::nullopt;
    return (above - below) / (2.0 * by);
  };
  const auto by_gap = slope(normal_impulse(gap, 0.0), normal_impulse(-gap, 0.0), gap),
             by_velocity = slope(normal_impulse(0.0, speed), normal_impulse(0.0, -speed), speed);
  if (!by_gap || !by_velocity) return std::nullopt;
  return Slopes{*by_gap, *by_velocity};
}

// v' = v + H (a g + b v), g' = g + h v': its two eigenvalues, of sum 2 + H b + h H a and product 1 + H b,
// pass -1 where the step is too large (Jury).
bool stable_step_bound(const Trial& trial, Draw& draw) {
  constexpr double below = 0.95, slack = 1e-3;
  if (trial.setup.floats()) return false;
  bool judged = false;
  for (std::size_t k = 0; k < point_count; ++k) {
    Inputs in = approaching(trial, draw);
    Arrays arrays(trial, in);
    double limit = infinity;
    for (int pass = 0; pass < 4; ++pass) {  // it may depend on the step and on the gap
      const double depth = in.position_step * in.vector(in.v_free, 0).norm();
      in.gap[0] = in.gap_offset[0] - depth;
      in.v_previous = in.v_free;
      arrays.initialise(in);
      const Results found = arrays.evaluate(in);
      limit = infinity;
      if (found.code == ILAW_OK) limit = found.report.stable_velocity_step;
      if (!std::isfinite(limit) || !(limit > 0.0)) break;
      in.velocity_step = in.position_step = below * limit;
    }
    if (!std::isfinite(limit) || in.velocity_step > limit) continue;
    arrays.initialise(in);
    const std::optional<Slopes> found = slopes_of(arrays, in, arrays.state());
    if (!found) continue;
    const Vector n = in.normal_at(0);
    const double h = n.dot(in.h(0) * n), product = 1.0 + h * found->by_velocity,
                 sum = 1.0 + product + in.position_step * h * found->by_gap;
    judged = true;
    if (product < -1.0 - slack || sum < -1.0 - product - slack)
      fail(trial, in, 0,
           joined("at 0.95 of the stable step ", limit,
                  " a node on the law swings ever wider: eigenvalues of sum ", sum, " and product ", product),
           "eigenvalues of size 1 at most");
  }
  return judged;
}

}  // namespace

std::vector<Rule> energy_rules() {
  return {
      {"energy-made",
       "A node gains no energy, whatever pushes it and whatever v_smooth is: the work of impulse and moment "
       "and what is stored more is not positive.",
       "ilaw.h, ILAW_ENERGY_FRICTION", on_flights(not_made)},
      {"energy-balance", "The parts of the energy are what becomes of the work of impulse and moment.",
       "ilaw.h, ILAW_ENERGY_FRICTION", on_flights(balanced)},
      {"stable-step-bound",
       "A node on the law does not swing ever wider below the stable step that is reported.",
       "ilaw.h, ilaw_report.stable_velocity_step", on_trials(stable_step_bound, "the law limits no step")}};
}

}  // namespace ilaw::check
