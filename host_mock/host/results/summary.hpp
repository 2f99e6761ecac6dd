// summary.hpp - summary.json: what ran, and what came of it.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "scene/scene.hpp"
#include "step/integrator.hpp"

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace ilaw::host {

struct RunRecord {
  std::int64_t resumed_at = 0;  // step
  bool interrupted = false;
  std::string failure;                               // empty: none
  std::vector<std::string> warnings;                 // of the integrator, at the end
  std::string told;                                  // of them, during the run
  nlohmann::json forces = nlohmann::json::object();  // per name, as Forces sums them up
  double seconds_total = 0.0, seconds_output = 0.0;
  double seconds_steps = 0.0;  // of the processor, with what the steps write
};

nlohmann::json summary_of(const Scene& scene, const Integrator& integrator, const RunRecord& record);
// summary.json.
void write_summary(const nlohmann::json& summary, const std::filesystem::path& folder);

}  // namespace ilaw::host
