// Rules: what the results at a node have to do with each other, by what the law says it can do.
// SPDX-License-Identifier: BSD-3-Clause
#include "check/rule.hpp"

#include <algorithm>
#include <cmath>

namespace ilaw::check {
namespace {

// Calls look with the results of every good node of every step.
template <class Look>
void for_nodes(const Subject& subject, bool (*applies)(const Trial& trial), Look look,
               const char* otherwise) {
  for_trials(
      subject,
      [&](const Trial& trial, Draw& draw) {
        if (!applies(trial)) return false;
        const Script script = draw_script(trial, draw, {17, 8, true});
        const std::vector<Results> results = run(trial, script);
        for (std::size_t k = 0; k < script.size(); ++k)
          for (std::size_t i = 0; i < script[k].count; ++i)
            if (results[k].status.empty() || results[k].status[i] != ILAW_BAD_INPUT)
              look(trial, script[k], results[k], i);
        return true;
      },
      otherwise);
}

Vector impulse(const Inputs& in, const Results& found, std::size_t i) {
  return found.vector(found.impulse, i, in.dimension);
}

// Size of what cancels in free + h r, and in what the coupling of spins adds.
double size_of_sum(const Vector& free, const Matrix& h, const Vector& r, double coupled) {
  double size = std::abs(coupled);
  for (std::size_t a = 0; a < 3; ++a) {
    size += std::abs(free[a]);
    for (std::size_t b = 0; b < 3; ++b) size += std::abs(h[a][b] * r[b]);
  }
  return size;
}
double natural_velocity(const Inputs& in, std::size_t i, const Vector& r, const Vector& m) {
  return size_of_sum(in.vector(in.v_free, i), in.h(i), r, in.k(i) * length(m));
}
double natural_spin(const Inputs& in, std::size_t i, const Vector& r, const Vector& m) {
  return size_of_sum(in.spin(in.spin_free, i), in.j(i), m, in.k(i) * length(r));
}

void complementarity(const Subject& subject) {
  for_nodes(
      subject, [](const Trial& trial) { return !trial.can(ILAW_CAN_ADHERE); },
      [](const Trial& trial, const Inputs& in, const Results& found, std::size_t i) {
        const Vector r = impulse(in, found, i);
        const double normal = dot(in.normal_at(i), r);
        if (normal < -16.0 * trial.epsilon() * length(r))
          fail(trial, in, i, "r_N = " + text_of(normal), "r_N >= 0");
      },
      "the law adheres");
}

// In the local frame, where r_N = 0 is a number without rounding.
void friction_needs_pressure(const Subject& subject) {
  for_nodes(
      subject, [](const Trial& trial) { return !trial.can(ILAW_CAN_ADHERE) && !trial.setup.global(); },
      [](const Trial& trial, const Inputs& in, const Results& found, std::size_t i) {
        const Vector r = impulse(in, found, i);
        if (!(r[0] > 0.0) && (r[1] != 0.0 || r[2] != 0.0))
          fail(trial, in, i, "r = " + text_of(r, in.dimension) + " without pressure",
               "no tangential impulse where r_N = 0");
        if (const Vector m = found.moment_at(i); !(r[0] > 0.0) && m != Vector{})
          fail(trial, in, i, "moment " + text_of(m, 3) + " without pressure", "no moment where r_N = 0");
      },
      "the law adheres");
}

void status(const Subject& subject) {
  for_nodes(
      subject, [](const Trial& trial) { return trial.writes(ILAW_OUTPUT_STATUS); },
      [](const Trial& trial, const Inputs& in, const Results& found, std::size_t i) {
        const std::uint8_t said = found.status[i];
        const Vector r = impulse(in, found, i);
        const double normal = dot(in.normal_at(i), r);
        if (said >= ILAW_STATUS_COUNT) fail(trial, in, i, "status " + std::to_string(said), "0 to 7");
        if (said == ILAW_FREE && r != Vector{})
          fail(trial, in, i, "ILAW_FREE with the impulse " + text_of(r, in.dimension), "no impulse");
        if (const Vector m = found.moment_at(i); said == ILAW_FREE && m != Vector{})
          fail(trial, in, i, "ILAW_FREE with the moment " + text_of(m, 3), "no moment");
        const double subnormal = trial.setup.floats() ? 0x1p-126 : 0.0;
        const bool sheared = length(r) > std::abs(normal) * (1.0 + 64.0 * trial.epsilon()) + subnormal;
        if (said == ILAW_CLOSED && (sheared || normal < 0.0))
          fail(trial, in, i, "ILAW_CLOSED with the impulse " + text_of(r, in.dimension),
               "pushed, no friction");
      },
      "the law writes no status");
}

Vector tangential(const Vector& a, const Vector& n) {
  const double normal = dot(n, a);
  return {a[0] - normal * n[0], a[1] - normal * n[1], a[2] - normal * n[2]};
}

// A spring along the interface may still move where it sticks; without one v_T = -e v_T^- with e from 0 to 1.
void status_stick(const Subject& subject) {
  for_nodes(
      subject,
      [](const Trial& trial) {
        return trial.writes(ILAW_OUTPUT_STATUS) && !trial.can(ILAW_CAN_STORE_ENERGY) &&
               trial.setup.dimension > 1;
      },
      [](const Trial& trial, const Inputs& in, const Results& found, std::size_t i) {
        if (found.status[i] != ILAW_STICK) return;
        const Vector r = impulse(in, found, i), m = found.moment_at(i), n = in.normal_at(i),
                     v = tangential(sum(in.vector(in.v_free, i), in.gained(i, r, m).velocity), n),
                     before = tangential(in.vector(in.v_previous, i), n);
        const double square = dot(before, before), e = square > 0.0 ? -dot(v, before) / square : 0.0;
        const double part = std::min(std::max(e, 0.0), 1.0);
        const Vector rest{v[0] + part * before[0], v[1] + part * before[1], v[2] + part * before[2]};
        const double tolerance = (trial.setup.floats() ? 1e-4 : 1e-9) * natural_velocity(in, i, r, m);
        if (length(rest) > tolerance)
          fail(trial, in, i,
               "ILAW_STICK with the velocity " + text_of(v, in.dimension) + " along the interface",
               "none, or a part of the opposite of that before");
      },
      "the law writes no status, or stores energy");
}

void velocity(const Subject& subject) {
  for_nodes(
      subject, [](const Trial& trial) { return trial.writes(ILAW_OUTPUT_VELOCITY); },
      [](const Trial& trial, const Inputs& in, const Results& found, std::size_t i) {
        const Vector r = impulse(in, found, i), m = found.moment_at(i);
        const Motion gained = in.gained(i, r, m);
        const auto expect = [&](const char* name, const std::vector<double>& after, const Vector& expected,
                                double size) {
          const double tolerance = 64.0 * trial.epsilon() * size;
          const Vector written = found.vector(after, i, in.dimension);
          for (std::size_t c = 0; c < in.dimension; ++c)
            if (!(std::abs(expected[c] - written[c]) <= tolerance))
              fail(trial, in, i, std::string(name) + "[" + std::to_string(c) + "] = " + text_of(written[c]),
                   text_of(expected[c]) + " to " + text_of(tolerance) + ", by the impulse that is written");
        };
        expect("velocity", found.velocity, sum(in.vector(in.v_free, i), gained.velocity),
               natural_velocity(in, i, r, m));
        if (in.spins())
          expect("spin", found.spin, sum(in.vector(in.spin_free, i), gained.spin), natural_spin(in, i, r, m));
      },
      "the law writes no velocity");
}

void energy_parts(const Subject& subject) {
  for_nodes(
      subject, [](const Trial& trial) { return trial.writes(ILAW_OUTPUT_ENERGY); },
      [](const Trial& trial, const Inputs& in, const Results& found, std::size_t i) {
        const double* parts = &found.energy[i * ILAW_ENERGY_COUNT];
        for (int c = 0; c < ILAW_ENERGY_STORED; ++c)
          if (!(parts[c] >= 0.0))
            fail(trial, in, i, "dissipated part " + std::to_string(c) + " of " + text_of(parts[c]),
                 "none is negative, or NaN");
        const double stored = parts[ILAW_ENERGY_STORED];
        if (!(stored >= 0.0 || stored < 0.0) || (stored != 0.0 && !trial.can(ILAW_CAN_STORE_ENERGY)))
          fail(trial, in, i, "stored energy " + text_of(stored),
               "0 without ILAW_CAN_STORE_ENERGY, never NaN");
      },
      "the law writes no energy");
}

// In the local frame, where r_T = 0 is a number without rounding. A spring along the interface may go slack.
void energy_friction(const Subject& subject) {
  for_nodes(
      subject,
      [](const Trial& trial) {
        return trial.writes(ILAW_OUTPUT_ENERGY) && !trial.can(ILAW_CAN_STORE_ENERGY) && !trial.setup.global();
      },
      [](const Trial& trial, const Inputs& in, const Results& found, std::size_t i) {
        const Vector r = impulse(in, found, i);
        const double part = found.energy[i * ILAW_ENERGY_COUNT + ILAW_ENERGY_FRICTION];
        if (r[1] == 0.0 && r[2] == 0.0 && found.moment_at(i) == Vector{} && part != 0.0)
          fail(trial, in, i, "friction dissipated " + text_of(part) + " without a tangential impulse", "0");
      },
      "the law writes no energy, or stores some");
}

// A law remembers what it breaks, unless a bond forms again in the same step: the status says so.
void energy_rupture(const Subject& subject) {
  for_trials(
      subject,
      [](const Trial& trial, Draw& draw) {
        if (!trial.writes(ILAW_OUTPUT_ENERGY)) return false;
        const Script script = draw_script(trial, draw, {17, 8, true});
        const std::vector<Results> results = run(trial, script);
        const std::size_t size = trial.info.state_size;
        for (std::size_t k = 1; k < script.size(); ++k)
          for (std::size_t i = 0; i < script[k].count; ++i) {
            const double* before = &results[k - 1].state[0] + i * size;
            const bool same = std::equal(before, before + size, &results[k].state[0] + i * size, same_bits);
            const double part = results[k].energy[i * ILAW_ENERGY_COUNT + ILAW_ENERGY_RUPTURE];
            const int said = results[k].status.empty() ? int{ILAW_FREE} : results[k].status[i];
            if (same && said != ILAW_BROKEN && said != ILAW_HEALED && part != 0.0)
              fail(trial, script[k], i,
                   "rupture dissipated " + text_of(part) + " and left the state as it was",
                   "0 where the state does not change");
          }
        return true;
      },
      "the law writes no energy");
}

void amounts_zero(const Subject& subject) {
  for_nodes(
      subject,
      [](const Trial& trial) { return trial.info.amount_count > 0 && trial.writes(ILAW_OUTPUT_STATUS); },
      [](const Trial& trial, const Inputs& in, const Results& found, std::size_t i) {
        for (std::size_t k = 0; k < found.amounts.size(); ++k) {
          const double amount = found.amounts[k][i];
          const std::string said = std::string(trial.info.amounts[k]->name) + " of " + text_of(amount);
          if (std::isnan(amount)) fail(trial, in, i, said, "never NaN");
          if (found.status[i] == ILAW_FREE && amount != 0.0)
            fail(trial, in, i, said + " at a free node", "0");
        }
      },
      "the law has no amounts");
}

// The amounts that go into one of the two bodies, by the names of the glossary.
double heat_at(const Trial& trial, const Inputs& in, const Results& found, std::size_t i) {
  double sum = 0.0;
  for (std::size_t k = 0; k < found.amounts.size(); ++k) {
    const std::string name = trial.info.amounts[k]->name;
    if (name != "heat" && name != "counterpart_heat") continue;
    if (!(found.amounts[k][i] >= 0.0))
      fail(trial, in, i, name + " of " + text_of(found.amounts[k][i]), ">= 0");
    sum += found.amounts[k][i];
  }
  return sum;
}

void heat_dissipated(const Subject& subject) {
  for_nodes(
      subject,
      [](const Trial& trial) {
        const auto* const end = trial.info.amounts + trial.info.amount_count;
        return trial.writes(ILAW_OUTPUT_ENERGY) &&
               std::any_of(trial.info.amounts, end, [](const ilaw_amount* a) {
                 return a->name == std::string("heat") || a->name == std::string("counterpart_heat");
               });
      },
      [](const Trial& trial, const Inputs& in, const Results& found, std::size_t i) {
        double dissipated = 0.0;
        for (std::size_t c = 0; c < ILAW_ENERGY_STORED; ++c)
          dissipated += found.energy[i * ILAW_ENERGY_COUNT + c];
        const double heat = heat_at(trial, in, found, i);
        const double subnormal = trial.setup.floats() ? 0x1p-126 : 0.0;
        if (heat > dissipated * (1.0 + 16.0 * trial.epsilon()) + subnormal)
          fail(trial, in, i, "heat of " + text_of(heat),
               "at most what was dissipated, " + text_of(dissipated));
      },
      "the law has no amount called heat or counterpart_heat");
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

void cone(const Subject& subject) {
  for_nodes(
      subject,
      [](const Trial& trial) {
        return trial.writes(ILAW_OUTPUT_STATUS) && cone_of(trial) >= 0.0 && std::isfinite(cone_of(trial));
      },
      [](const Trial& trial, const Inputs& in, const Results& found, std::size_t i) {
        if (found.status[i] != ILAW_STICK && found.status[i] != ILAW_SLIP) return;
        const Vector r = impulse(in, found, i), n = in.normal_at(i);
        const double normal = dot(n, r);
        const Vector along = tangential(r, n);
        // r_N = n.r rounds as a part of |r|, however small it is.
        const double friction = cone_of(trial), most = friction * normal;
        const double rounding =
            trial.setup.floats() ? 16.0 * trial.epsilon() * (1.0 + friction) : 1e-12 + 16.0 * ulp * friction;
        const double subnormal = trial.setup.floats() ? 0x1p-126 * (1.0 + friction) : 0.0;
        if (length(along) > most + rounding * length(r) + subnormal)
          fail(trial, in, i, "|r_T| = " + text_of(length(along)), "at most friction r_N = " + text_of(most));
      },
      "no parameter is called friction");
}

// Any positive step: from picoseconds to hours.
void step_limits(const Subject& subject) {
  for_trials(subject, [](const Trial& trial, Draw& draw) {
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
             "code " + std::to_string(found.code) + " with steps of " + text_of(step) +
                 " s: " + (found.report.reason ? found.report.reason : "no reason"),
             "ILAW_OK for any step > 0");
      expect_finite(trial, in, found);
    }
    return true;
  });
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

void held_bonds(const Subject& subject) {
  for_trials(
      subject,
      [](const Trial& trial, Draw& draw) {
        if (!trial.can(ILAW_CAN_HOLD_BONDS) || !trial.writes(ILAW_OUTPUT_STATUS)) return false;
        const Script script = draw_script(trial, draw, {17, 8, true});
        Heap heap;
        Arrays arrays(trial, script[0], {}, heap);
        arrays.initialise(script[0]);
        for (const Inputs& in : script) {
          const OfBonds found = evaluate_three_times(arrays, in);
          for (std::size_t i = 0; i < in.count; ++i) {
            const auto status = [i](const Results& of) { return of.status[i]; };
            const auto expect = [&](const Results& of, std::uint8_t allowed, const char* told) {
              if (status(of) != allowed)
                fail(trial, in, i, "told to " + (told + (": status " + std::to_string(status(of)))),
                     "status " + std::to_string(allowed));
              if (status(found.by_law) == allowed && impulse(in, of, i) != impulse(in, found.by_law, i))
                fail(trial, in, i, std::string("told to ") + told + ": another impulse",
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
      },
      "the law does not hold bonds when told");
}

}  // namespace

std::vector<Rule> result_rules() {
  return {
      {"complementarity", "Without ILAW_CAN_ADHERE an impulse pushes or is none: r_N >= 0.",
       "ilaw.h, ILAW_CAN_ADHERE", Needs::motion, complementarity},
      {"friction-pressure",
       "Without ILAW_CAN_ADHERE there is no tangential impulse and no moment where r_N = 0.",
       "ilaw.h, ILAW_CAN_ADHERE", Needs::motion, friction_needs_pressure},
      {"friction-cone",
       "If a law has a coefficient called friction (and friction_2), the length of r_T of a status stick or "
       "slip is at most the larger one times r_N.",
       "check.md, Names with a meaning", Needs::motion, cone},
      {"status-meaning",
       "A status is one of the eight; free is r = 0 and m = 0, closed is pushed without friction.",
       "ilaw.h, ILAW_FREE", Needs::motion, status},
      {"status-stick",
       "A node that sticks, of a law that stores no energy, has no velocity along the interface, or a part "
       "of the opposite of that before.",
       "ilaw.h, ILAW_STICK", Needs::motion, status_stick},
      {"velocity-output", "The velocity is v_free + H r + k n x m, and the spin w_free + J m - k n x r.",
       "ilaw.h, ilaw_batch.velocity", Needs::motion, velocity},
      {"held-bonds",
       "With ILAW_CAN_HOLD_BONDS bonds hold or break as the flags of the batch say, and nothing else changes.",
       "ilaw.h, ILAW_BATCH_HOLD_BONDS", Needs::motion, held_bonds},
      {"energy-parts",
       "No dissipated part is negative and none NaN; nothing is stored without "
       "ILAW_CAN_STORE_ENERGY.",
       "ilaw.h, ILAW_ENERGY_FRICTION", Needs::motion, energy_parts},
      {"energy-friction",
       "Friction of a law that stores no energy dissipates nothing without a tangential impulse or moment.",
       "ilaw.h, ILAW_ENERGY_FRICTION", Needs::motion, energy_friction},
      {"energy-rupture",
       "Rupture dissipates nothing where the state stays and the status is neither broken nor healed.",
       "ilaw.h, ILAW_ENERGY_RUPTURE", Needs::motion, energy_rupture},
      {"amounts-zero", "An amount is 0 where the status is free, and never NaN.", "ilaw.h, ilaw_amount",
       Needs::motion, amounts_zero},
      {"heat-dissipated",
       "The amounts heat and counterpart_heat are not negative, and together at most what was dissipated.",
       "abi.md, Tables, fields and amounts", Needs::motion, heat_dissipated},
      {"step-limits", "Any positive step is served; a bond that may soften may refuse one that is too large.",
       "ilaw.h, ilaw_batch.velocity_step", Needs::motion, step_limits}};
}

}  // namespace ilaw::check
