// Rules: what the results at a node have to do with each other, by what the law says it can do.
// SPDX-License-Identifier: BSD-3-Clause
#include "check/rule.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace ilaw::check {
namespace {

// The result of one node in one step.
struct Node {
  const Trial& trial;
  const Inputs& in;
  const Results& found;
  std::size_t i;
  Wrench action = found.action(i), after = in.free(i) + in.gain(i) * action;
  Vector r = action.head<3>(), m = action.tail<3>(), n = in.normal_at(i);

  int status() const { return found.status[i]; }
  const double* energy() const { return &found.energy[i * ILAW_ENERGY_COUNT]; }
  // Sizes of what cancels in the velocity and in the spin.
  Eigen::Vector2d sizes() const {
    const Wrench all = in.free(i).cwiseAbs() + in.gain(i).cwiseAbs() * action.cwiseAbs();
    return {all.head<3>().sum(), all.tail<3>().sum()};
  }
  std::string text(const Vector& a) const { return text_of(a, in.dimension); }
  [[noreturn]] void fail(const std::string& seen, const std::string& allowed) const {
    check::fail(trial, in, i, seen, allowed);
  }
};

// Calls look with every good node of every step.
Judge on_nodes(bool (*applies)(const Trial& trial), void (*look)(const Node& at), const char* otherwise) {
  return on_trials(
      [=](const Trial& trial, Draw& draw) {
        if (!applies(trial)) return false;
        const Script script = draw_script(trial, draw, {17, 8, true});
        const std::vector<Results> results = run(trial, script);
        for (std::size_t k = 0; k < script.size(); ++k)
          for (std::size_t i = 0; i < script[k].count; ++i)
            if (results[k].status.empty() || results[k].status[i] != ILAW_BAD_INPUT)
              look({trial, script[k], results[k], i});
        return true;
      },
      otherwise);
}

bool only_pushes(const Trial& trial) { return !trial.can(ILAW_CAN_ADHERE); }
// In the local frame, where r_N = 0 and r_T = 0 are numbers without rounding.
bool only_pushes_locally(const Trial& trial) { return only_pushes(trial) && !trial.setup.global(); }
bool writes_status(const Trial& trial) { return trial.writes(ILAW_OUTPUT_STATUS); }
bool writes_velocity(const Trial& trial) { return trial.writes(ILAW_OUTPUT_VELOCITY); }
bool writes_energy(const Trial& trial) { return trial.writes(ILAW_OUTPUT_ENERGY); }
bool stores_nothing(const Trial& trial) { return !trial.can(ILAW_CAN_STORE_ENERGY); }

double subnormal(const Trial& trial) { return trial.setup.floats() ? 0x1p-126 : 0.0; }

Vector tangential(const Vector& a, const Vector& n) { return a - n.dot(a) * n; }

void complementarity(const Node& at) {
  const double normal = at.n.dot(at.r);
  if (normal < -16.0 * at.trial.epsilon() * at.r.norm()) at.fail(joined("r_N = ", normal), "r_N >= 0");
}

void friction_needs_pressure(const Node& at) {
  if (at.r[0] > 0.0) return;
  if (at.r[1] != 0.0 || at.r[2] != 0.0)
    at.fail(joined("r = ", at.text(at.r), " without pressure"), "no tangential impulse where r_N = 0");
  if (at.m != Vector::Zero())
    at.fail(joined("moment ", text_of(at.m, 3), " without pressure"), "no moment where r_N = 0");
}

void status(const Node& at) {
  const double normal = at.n.dot(at.r);
  if (at.status() >= ILAW_STATUS_COUNT) at.fail(joined("status ", at.status()), "0 to 7");
  if (at.status() == ILAW_FREE && at.r != Vector::Zero())
    at.fail(joined("ILAW_FREE with the impulse ", at.text(at.r)), "no impulse");
  if (at.status() == ILAW_FREE && at.m != Vector::Zero())
    at.fail(joined("ILAW_FREE with the moment ", text_of(at.m, 3)), "no moment");
  const bool sheared =
      at.r.norm() > std::abs(normal) * (1.0 + 64.0 * at.trial.epsilon()) + subnormal(at.trial);
  if (at.status() == ILAW_CLOSED && (sheared || normal < 0.0))
    at.fail(joined("ILAW_CLOSED with the impulse ", at.text(at.r)), "pushed, no friction");
}

bool tells_sticking(const Trial& trial) {
  return writes_status(trial) && stores_nothing(trial) && trial.setup.dimension > 1;
}
// A spring along the interface may still move where it sticks; without one v_T = -e v_T^- with e from 0 to 1.
void status_stick(const Node& at) {
  if (at.status() != ILAW_STICK) return;
  const Vector v = tangential(at.after.head<3>(), at.n),
               before = tangential(at.in.vector(at.in.v_previous, at.i), at.n);
  const double square = before.squaredNorm(), e = square > 0.0 ? -v.dot(before) / square : 0.0;
  const Vector rest = v + std::min(std::max(e, 0.0), 1.0) * before;
  if (rest.norm() > (at.trial.setup.floats() ? 1e-4 : 1e-9) * at.sizes()[0])
    at.fail(joined("ILAW_STICK with the velocity ", at.text(v), " along the interface"),
            "none, or a part of the opposite of that before");
}

void velocity(const Node& at) {
  const std::size_t d = at.in.dimension;
  const auto expect = [&](const char* name, const std::vector<double>& written, std::size_t half) {
    const double tolerance = 64.0 * at.trial.epsilon() * at.sizes()[half];
    for (std::size_t c = 0; c < d && !written.empty(); ++c)
      if (!(std::abs(at.after[3 * half + c] - written[at.i * d + c]) <= tolerance))
        at.fail(joined(name, "[", c, "] = ", written[at.i * d + c]),
                joined(at.after[3 * half + c], " to ", tolerance, ", by the impulse that is written"));
  };
  expect("velocity", at.found.velocity, 0);
  expect("spin", at.found.spin, 1);
}

void energy_parts(const Node& at) {
  for (int c = 0; c < ILAW_ENERGY_STORED; ++c)
    if (!(at.energy()[c] >= 0.0))
      at.fail(joined("dissipated part ", c, " of ", at.energy()[c]), "none is negative, or NaN");
  const double stored = at.energy()[ILAW_ENERGY_STORED];
  if (std::isnan(stored) || (stored != 0.0 && stores_nothing(at.trial)))
    at.fail(joined("stored energy ", stored), "0 without ILAW_CAN_STORE_ENERGY, never NaN");
}

// A spring along the interface may go slack.
bool tells_friction(const Trial& trial) {
  return writes_energy(trial) && stores_nothing(trial) && !trial.setup.global();
}
void energy_friction(const Node& at) {
  const double part = at.energy()[ILAW_ENERGY_FRICTION];
  if (at.r[1] == 0.0 && at.r[2] == 0.0 && at.m == Vector::Zero() && part != 0.0)
    at.fail(joined("friction dissipated ", part, " without a tangential impulse"), "0");
}

// A law remembers what it breaks, unless a bond forms again in the same step: the status says so.
bool energy_rupture(const Trial& trial, Draw& draw) {
  if (!writes_energy(trial)) return false;
  const Script script = draw_script(trial, draw, {17, 8, true});
  const std::vector<Results> results = run(trial, script);
  const std::size_t size = trial.info.state_size;
  for (std::size_t k = 1; k < script.size(); ++k)
    for (std::size_t i = 0; i < script[k].count; ++i) {
      const double* before = results[k - 1].state.data() + i * size;
      const bool same = std::equal(before, before + size, results[k].state.data() + i * size, same_bits);
      const Node at{trial, script[k], results[k], i};
      const double part = at.energy()[ILAW_ENERGY_RUPTURE];
      const int said = at.found.status.empty() ? int{ILAW_FREE} : at.status();
      if (same && said != ILAW_BROKEN && said != ILAW_HEALED && part != 0.0)
        at.fail(joined("rupture dissipated ", part, " and left the state as it was"),
                "0 where the state does not change");
    }
  return true;
}

bool tells_amounts(const Trial& trial) { return trial.info.amount_count > 0 && writes_status(trial); }
void amounts_zero(const Node& at) {
  for (std::size_t k = 0; k < at.found.amounts.size(); ++k) {
    const double amount = at.found.amounts[k][at.i];
    const std::string said = joined(at.trial.info.amounts[k]->name, " of ", amount);
    if (std::isnan(amount)) at.fail(said, "never NaN");
    if (at.status() == ILAW_FREE && amount != 0.0) at.fail(said + " at a free node", "0");
  }
}

// The amounts that go into one of the two bodies, by the names of the glossary.
bool is_heat(const ilaw_amount* amount) {
  return amount->name == std::string("heat") || amount->name == std::string("counterpart_heat");
}
bool tells_heat(const Trial& trial) {
  return writes_energy(trial) &&
         std::any_of(trial.info.amounts, trial.info.amounts + trial.info.amount_count, is_heat);
}
void heat_dissipated(const Node& at) {
  double heat = 0.0;
  for (std::size_t k = 0; k < at.found.amounts.size(); ++k) {
    if (!is_heat(at.trial.info.amounts[k])) continue;
    const double part = at.found.amounts[k][at.i];
    if (!(part >= 0.0)) at.fail(joined(at.trial.info.amounts[k]->name, " of ", part), ">= 0");
    heat += part;
  }
  const double dissipated = std::accumulate(at.energy(), at.energy() + ILAW_ENERGY_STORED, 0.0);
  if (heat > dissipated * (1.0 + 16.0 * at.trial.epsilon()) + subnormal(at.trial))
    at.fail(joined("heat of ", heat), joined("at most what was dissipated, ", dissipated));
}

// Coefficients of friction by the names that the kit gives them.
double cone_of(const Trial& trial) {
  double most = -1.0;
  for (const char* name : {"friction", "friction_2"}) {
    const ilaw_parameter* p = parameter_of(trial.law, name);
    if (!p || p->kind != ILAW_KIND_NUMBER || std::string(p->unit) != "1") continue;
    const double value = number_of(trial.law, trial.values, name);
    if (name == std::string("friction_2") && std::isinf(value)) continue;  // the same as friction
    most = std::max(most, value);
  }
  return most;
}

bool has_cone(const Trial& trial) {
  return writes_status(trial) && cone_of(trial) >= 0.0 && std::isfinite(cone_of(trial));
}
void cone(const Node& at) {
  if (at.status() != ILAW_STICK && at.status() != ILAW_SLIP) return;
  const double along = tangential(at.r, at.n).norm(), friction = cone_of(at.trial),
               most = friction * at.n.dot(at.r);
  // r_N = n.r rounds as a part of |r|, however small it is.
  const double rounding =
      at.trial.setup.floats() ? 16.0 * at.trial.epsilon() * (1.0 + friction) : 1e-12 + 16.0 * ulp * friction;
  if (along > most + rounding * at.r.norm() + subnormal(at.trial) * (1.0 + friction))
    at.fail(joined("|r_T| = ", along), joined("at most friction r_N = ", most));
}

// Any positive step: from picoseconds to hours.
bool step_limits(const Trial& trial, Draw& draw) {
  Script script = draw_script(trial, draw, {9, 1}, true);
  if (run(trial, script)[0].code != ILAW_OK) return false;
  for (const double step : {1e-13, 3e-7, 0.0171, 11.0, 7300.0}) {
    Inputs& in = script[0];
    for (double& gap : in.gap) gap *= step / in.position_step;
    for (double& offset : in.gap_offset) offset *= step / in.position_step;
    in.velocity_step = in.position_step = in.time = step;
    const Results found = run(trial, script)[0];
    // A spring that is pressed for hours exceeds what a float holds.
    const bool may_refuse = (trial.may_soften() && step > 0x1p-9) || (trial.setup.floats() && step > 1.0);
    const bool is_too_large = may_refuse && found.code == ILAW_BAD_NODES;
    if (found.code != ILAW_OK && !is_too_large)
      fail(trial, in, 0,
           joined("code ", found.code, " with steps of ", step,
                  " s: ", (found.report.reason ? found.report.reason : "no reason")),
           "ILAW_OK for any step > 0");
    expect_finite(trial, in, found);
  }
  return true;
}

// The results of a step from the same states, by the law and as a host may tell it.
struct OfBonds {
  Results by_law, held, broken;
};
OfBonds evaluate_three_times(Arrays& arrays, const Inputs& in) {
  OfBonds found;
  const std::vector<double> before = arrays.state();
  const auto evaluate = [&](ilaw_batch_flags flags) {
    arrays.set_state(before);
    arrays.batch().flags = flags;
    return arrays.evaluate(in);
  };
  found.held = evaluate(ILAW_BATCH_HOLD_BONDS);
  found.broken = evaluate(ILAW_BATCH_BREAK_BONDS);
  found.by_law = evaluate(0);
  return found;
}

bool held_bonds(const Trial& trial, Draw& draw) {
  if (!trial.can(ILAW_CAN_HOLD_BONDS) || !trial.writes(ILAW_OUTPUT_STATUS)) return false;
  const Script script = draw_script(trial, draw, {17, 8, true});
  Started arrays(trial, script[0]);
  for (const Inputs& in : script) {
    const OfBonds found = evaluate_three_times(arrays, in);
    for (std::size_t i = 0; i < in.count; ++i) {
      const auto status = [i](const Results& of) { return of.status[i]; };
      const auto expect = [&](const Results& of, std::uint8_t allowed, const char* told) {
        if (status(of) != allowed)
          fail(trial, in, i, joined("told to ", told, ": status ", status(of)), joined("status ", allowed));
        if (status(found.by_law) == allowed && of.action(i).head<3>() != found.by_law.action(i).head<3>())
          fail(trial, in, i, joined("told to ", told, ": another impulse"),
               "that of the law, which says the same");
      };
      const std::uint8_t own = status(found.by_law);
      if (std::max({own, status(found.held), status(found.broken)}) == ILAW_BAD_INPUT) continue;
      const bool was_bonded = own == ILAW_BONDED || own == ILAW_BROKEN;
      expect(found.held, was_bonded ? std::uint8_t{ILAW_BONDED} : own, "hold");
      expect(found.broken, was_bonded ? std::uint8_t{ILAW_BROKEN} : own, "break");
    }
  }
  return true;
}

}  // namespace

std::vector<Rule> result_rules() {
  return {
      {"complementarity", "Without ILAW_CAN_ADHERE an impulse pushes or is none: r_N >= 0.",
       "ilaw.h, ILAW_CAN_ADHERE", on_nodes(only_pushes, complementarity, "the law adheres")},
      {"friction-pressure",
       "Without ILAW_CAN_ADHERE there is no tangential impulse and no moment where r_N = 0.",
       "ilaw.h, ILAW_CAN_ADHERE", on_nodes(only_pushes_locally, friction_needs_pressure, "the law adheres")},
      {"friction-cone",
       "If a law has a coefficient called friction (and friction_2), the length of r_T of a status stick or "
       "slip is at most the larger one times r_N.",
       "check.md, Names with a meaning", on_nodes(has_cone, cone, "no parameter is called friction")},
      {"status-meaning",
       "A status is one of the eight; free is r = 0 and m = 0, closed is pushed without friction.",
       "ilaw.h, ILAW_FREE", on_nodes(writes_status, status, "the law writes no status")},
      {"status-stick",
       "A node that sticks, of a law that stores no energy, has no velocity along the interface, or a part "
       "of the opposite of that before.",
       "ilaw.h, ILAW_STICK",
       on_nodes(tells_sticking, status_stick, "the law writes no status, or stores energy")},
      {"velocity-output", "The velocity is v_free + H r + k n x m, and the spin w_free + J m - k n x r.",
       "ilaw.h, ilaw_batch.velocity", on_nodes(writes_velocity, velocity, "the law writes no velocity")},
      {"held-bonds",
       "With ILAW_CAN_HOLD_BONDS bonds hold or break as the flags of the batch say, and nothing else changes.",
       "ilaw.h, ILAW_BATCH_HOLD_BONDS", on_trials(held_bonds, "the law does not hold bonds when told")},
      {"energy-parts",
       "No dissipated part is negative and none NaN; nothing is stored without "
       "ILAW_CAN_STORE_ENERGY.",
       "ilaw.h, ILAW_ENERGY_FRICTION", on_nodes(writes_energy, energy_parts, "the law writes no energy")},
      {"energy-friction",
       "Friction of a law that stores no energy dissipates nothing without a tangential impulse or moment.",
       "ilaw.h, ILAW_ENERGY_FRICTION",
       on_nodes(tells_friction, energy_friction, "the law writes no energy, or stores some")},
      {"energy-rupture",
       "Rupture dissipates nothing where the state stays and the status is neither broken nor healed.",
       "ilaw.h, ILAW_ENERGY_RUPTURE", on_trials(energy_rupture, "the law writes no energy")},
      {"amounts-zero", "An amount is 0 where the status is free, and never NaN.", "ilaw.h, ilaw_amount",
       on_nodes(tells_amounts, amounts_zero, "the law has no amounts")},
      {"heat-dissipated",
       "The amounts heat and counterpart_heat are not negative, and together at most what was dissipated.",
       "abi.md, Tables, fields and amounts",
       on_nodes(tells_heat, heat_dissipated, "the law has no amount called heat or counterpart_heat")},
      {"step-limits", "Any positive step is served; a bond that may soften may refuse one that is too large.",
       "ilaw.h, ilaw_batch.velocity_step", on_trials(step_limits)}};
}

}  // namespace ilaw::check
