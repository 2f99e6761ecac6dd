// relations.hpp - a scene beside others whose motion follows from its own: a second oracle, which asks
// neither the solver nor the law whether a result is right.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nlohmann/json.hpp>

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace ilaw::host {

struct RelationReport {
  std::map<std::string, std::int64_t> held;  // relations by name
  std::int64_t vague = 0;           // it hangs on the last digit of the scene, or a step is not solved
  std::vector<std::string> broken;  // "relation: how"
  double worst = 0.0;               // the largest difference over its bound
};

// Runs a scene, and scenes related to it, for some steps. file: where relative paths start from. Sets the
// number of threads to 1.
RelationReport check_relations(const nlohmann::json& source, const std::filesystem::path& file,
                               std::int64_t steps);

}  // namespace ilaw::host
