// SPDX-License-Identifier: BSD-3-Clause
#include "stress/invariants.hpp"

#include "base/scene_error.hpp"
#include "base/words.hpp"
#include "scene/validation.hpp"
#include "stress/ledger.hpp"

#include <omp.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <exception>
#include <optional>
#include <sstream>

namespace ilaw::host {
namespace {

using nlohmann::json;

// Steps that contacts do not agree in, which the run warns of, before a scene is given up: each takes
// a thousand times as long as another.
constexpr std::int64_t most_unsolved = 20;

constexpr const char* scene_name = "stress.json";

// Results that must be the same to the bit. Energies are sums over active contacts, in their order: they are
// left out where other contacts are active.
struct Bits {
  Dofs u, v;
  std::array<double, 3> energies;

  explicit Bits(const Integrator& integrator) : u(integrator.displacement()), v(integrator.velocity()) {
    const EnergyReport energy = integrator.energy();
    energies = {energy.interface_work, energy.reaction_work, energy.by_law[ILAW_ENERGY_FRICTION]};
  }
};

bool same(const Dofs& a, const Dofs& b) {
  return std::memcmp(a.data(), b.data(), static_cast<std::size_t>(a.size()) * sizeof(double)) == 0;
}

struct Run {
  explicit Run(const json& source)
      : scene(read_scene(source, scene_name)),
        integrator(*scene.model, scene.loads, scene.interfaces, scene.dt) {}
  void advance(std::int64_t steps) {
    while (integrator.steps() < steps) integrator.step();
  }
  Scene scene;
  Integrator integrator;
};

json without_skip(json source) {
  for (json& interface : source["interfaces"]) interface["skip"] = false;
  return source;
}

// The name of the way in which a run to the same step ends with other bits; empty: none does.
std::string other_bits(const json& source, std::int64_t steps, const Bits& expected) {
  using Words = std::array<std::uint64_t, 3>;  // NaN is compared, too
  const auto differs = [&](const Run& run, bool with_energies) {
    const Bits found(run.integrator);
    return !same(found.u, expected.u) || !same(found.v, expected.v) ||
           (with_energies && std::bit_cast<Words>(found.energies) != std::bit_cast<Words>(expected.energies));
  };
  omp_set_num_threads(2);
  Run threaded(source);
  threaded.advance(steps);
  omp_set_num_threads(1);
  if (differs(threaded, true)) return "with two threads";

  Run all(without_skip(source));
  all.advance(steps);
  if (differs(all, false)) return "without skipping";

  Run first(source), second(source);
  first.advance(steps / 2);
  std::stringstream checkpoint;
  first.integrator.save(checkpoint);
  second.integrator.load(checkpoint);
  second.advance(steps);
  return differs(second, true) ? "resumed from a checkpoint" : "";
}

// Where a run may have to stop: it says of contacts that share nodes that no solution was found, explicit
// springs and large deformations have steps of their own, and a law may say that a step has no one solution.
bool may_stop(const Run& run, const std::string& reason) {
  return reason.find("the law's equations have ") != std::string::npos ||
         reason.find("have no common solution") != std::string::npos ||
         run.integrator.tally().stable_step < run.scene.dt ||
         run.scene.dt > run.scene.model->critical_step() || !run.scene.model->is_linear();
}

class Judge {
 public:
  explicit Judge(const json& source) : source_(source) {}

  StressVerdict run() {
    try {
      validate_scene(source_);
      run_.emplace(source_);
    } catch (const SceneError& refusal) {
      verdict_.ending = StressEnding::refused;
      verdict_.reason = refusal.what();
      return verdict_;
    }
    try {
      advance();
    } catch (const std::exception& stop) {
      if (may_stop(*run_, stop.what()))
        end(StressEnding::stopped, "", stop.what());
      else
        end(StressEnding::failed, "stops", stop.what());
    }
    return verdict_;
  }

 private:
  void end(StressEnding ending, const char* invariant, const std::string& reason) {
    verdict_.ending = ending;
    verdict_.invariant = invariant;
    verdict_.reason = reason;
  }

  void advance() {
    Integrator& integrator = run_->integrator;
    Ledger ledger(run_->scene);
    const std::int64_t steps = run_->scene.steps,
                       prefix = std::max<std::int64_t>(1, std::min<std::int64_t>(steps / 8, 2000));
    std::optional<Bits> bits;
    ledger.open(integrator);
    integrator.start();
    ledger.close(integrator);
    while (integrator.steps() < steps) {
      ledger.open(integrator);
      integrator.step();
      ledger.close(integrator);
      if (integrator.tally().unconverged > most_unsolved)
        return end(StressEnding::stopped, "", "contacts that share nodes are not solved in many steps");
      if (integrator.steps() == prefix) bits.emplace(integrator);
    }
    compare(ledger);
    if (verdict_.ending != StressEnding::passed) return;
    if (const std::string how = other_bits(source_, prefix, *bits); !how.empty())
      end(StressEnding::failed, "bits", "other bits " + how);
  }

  // A figure against its bound.
  void hold(const char* invariant, double figure, double bound) {
    const double part = figure > 0.0 ? figure / bound : 0.0;
    if (part <= 1.0 || verdict_.ending == StressEnding::failed) return;
    end(StressEnding::failed, invariant,
        formatted("%s: found %.3g, expected at most %.3g", invariant, figure, bound));
  }

  void compare(const Ledger& ledger) {
    const Integrator& integrator = run_->integrator;
    const Tally& tally = integrator.tally();
    const EnergyReport energy = integrator.energy();
    const bool is_explicit = std::isfinite(tally.stable_step);
    StressFigures& figures = verdict_.figures;
    figures.steps = integrator.steps();
    figures.node_steps = tally.active + tally.skipped;
    figures.balance = energy.balance_error;
    const bool is_beyond = run_->scene.dt > run_->scene.model->critical_step() * (1.0 + rounding);
    if (is_beyond && run_->scene.warnings.empty())
      return end(StressEnding::failed, "warning", "nothing says that the step is beyond the critical one");
    const double open = energy.balance_error * energy.scale;
    figures.worst_bound = open > 0.0 ? open / ledger.balance_bound() : 0.0;
    hold("energy balance", open, ledger.balance_bound());
    if (is_explicit) return hold_explicit(energy, ledger.added_bound(tally));
    figures.added = energy.scale > 0.0 ? std::abs(energy.reaction_work) / energy.scale : 0.0;
    figures.penetration =
        ledger.fastest() > 0.0 ? ledger.penetration() / (run_->scene.dt * ledger.fastest()) : 0.0;
    if (energy.reaction_work != 0.0)
      figures.worst_bound =
          std::max(figures.worst_bound, std::abs(energy.reaction_work) / ledger.added_bound(tally));
    hold("energy added by interfaces", std::abs(energy.reaction_work), ledger.added_bound(tally));
    hold("dissipation of a node", -energy.least_dissipation, ledger.dissipation_bound());
    hold("penetration", ledger.penetration(), ledger.penetration_bound());
    hold("velocities", ledger.worst_velocity(), 1.0);
  }

  // An explicit spring may add energy; if it is much, the run must say so.
  void hold_explicit(const EnergyReport& energy, double rounded) {
    if (energy.reaction_work > 0.1 * energy.scale + rounded && run_->integrator.warnings().empty())
      end(StressEnding::failed, "warning", "an explicit spring adds much energy, and no warning says so");
  }

  const json& source_;
  std::optional<Run> run_;
  StressVerdict verdict_;
};

}  // namespace

StressVerdict stress_scene(const json& source) { return Judge(source).run(); }

}  // namespace ilaw::host
