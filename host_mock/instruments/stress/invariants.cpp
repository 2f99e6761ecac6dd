// SPDX-License-Identifier: BSD-3-Clause
#include "stress/invariants.hpp"

#include "base/scene_error.hpp"
#include "base/words.hpp"
#include "scene/validation.hpp"
#include "stress/ledger.hpp"
#include "stress/relations.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <exception>
#include <optional>

namespace ilaw::host {
namespace {

using nlohmann::json;

// Steps that contacts do not agree in, which the run warns of, before a scene is given up: each takes
// a thousand times as long as another.
constexpr std::int64_t most_unsolved = 20;

// Steps of a scene beside others that are related to it.
constexpr std::int64_t most_related_steps = 200;
constexpr const char* most_work = "largest work of an impulse [J]";

constexpr const char* scene_name = "stress.json";

struct Run {
  explicit Run(const json& source)
      : scene(read_scene(source, scene_name)),
        integrator(*scene.model, scene.loads, scene.interfaces, scene.dt) {}
  Scene scene;
  Integrator integrator;
};

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
    const std::int64_t steps = run_->scene.steps;
    ledger.open(integrator);
    integrator.start();
    ledger.close(integrator);
    while (integrator.steps() < steps) {
      ledger.open(integrator);
      integrator.step();
      ledger.close(integrator);
      if (integrator.tally().unconverged > most_unsolved)
        return end(StressEnding::stopped, "", "contacts that share nodes are not solved in many steps");
    }
    compare(ledger);
    if (verdict_.ending != StressEnding::passed) return;
    const RelationReport report =
        check_relations(source_, scene_name, std::clamp<std::int64_t>(steps / 8, 1, most_related_steps));
    if (!report.broken.empty()) end(StressEnding::failed, "relations", report.broken.front());
  }

  // A figure against its bound, and where a run had the worst of what may be its cause.
  void hold(const char* invariant, double figure, double bound, const Worst& at = {},
            const char* cause = "largest") {
    const double part = figure > 0.0 ? figure / bound : 0.0;
    if (part <= 1.0 || verdict_.ending == StressEnding::failed) return;
    end(StressEnding::failed, invariant,
        formatted("%s: found %.3g, expected at most %.3g", invariant, figure, bound) +
            (at.node < 0 ? ""
                         : formatted("; %s at node %d in step %lld: %.3g", cause, at.node,
                                     static_cast<long long>(at.step), at.value)));
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
    hold("energy balance", open, ledger.balance_bound(), ledger.work(), most_work);
    if (is_explicit) return hold_explicit(energy, ledger.added_bound(tally));
    figures.added = energy.scale > 0.0 ? std::abs(energy.reaction_work) / energy.scale : 0.0;
    figures.penetration =
        ledger.fastest() > 0.0 ? ledger.penetration().value / (run_->scene.dt * ledger.fastest()) : 0.0;
    if (energy.reaction_work != 0.0)
      figures.worst_bound =
          std::max(figures.worst_bound, std::abs(energy.reaction_work) / ledger.added_bound(tally));
    hold("energy added by interfaces", std::abs(energy.reaction_work), ledger.added_bound(tally),
         ledger.work(), most_work);
    hold("dissipation of a node", -energy.least_dissipation, ledger.dissipation_bound(), ledger.work(),
         most_work);
    if (tally.unconverged == 0)  // else laws were not obeyed, as the run says
      hold("penetration", ledger.penetration().value, ledger.penetration_bound(), ledger.penetration());
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
