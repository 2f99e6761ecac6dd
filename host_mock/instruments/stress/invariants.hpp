// invariants.hpp - what a scene must fulfil, whatever it is, and by how much rounding may break it.
// Bounds are sums of what is rounded, times `rounding` (ledger.hpp).
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "scene/scene.hpp"
#include "step/integrator.hpp"

#include <nlohmann/json.hpp>

#include <cstdint>
#include <string>

namespace ilaw::host {

// Figures of a scene; errors and gains relative to its largest energy.
struct StressFigures {
  std::int64_t steps = 0, node_steps = 0;
  double balance = 0.0;      // how far the energy balance is open
  double added = 0.0;        // energy that interfaces added, beside what laws account for
  double penetration = 0.0;  // into rigid laws' obstacles, beyond the start, in steps at the largest speed
  double worst_bound = 0.0;  // the larger part of its bound that balance or added took
};

enum class StressEnding {
  passed,
  refused,  // before the run, with a reason
  stopped,  // with a reason, where the scene may have no solution
  failed    // an invariant
};

struct StressVerdict {
  StressEnding ending = StressEnding::passed;
  std::string reason;     // empty where it passed
  std::string invariant;  // that failed
  StressFigures figures;
};

// Runs a scene and, over a part of its steps, the scenes that are related to it (relations.hpp). Sets the
// number of threads.
StressVerdict stress_scene(const nlohmann::json& source);

}  // namespace ilaw::host
