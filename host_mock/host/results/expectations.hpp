// expectations.hpp - "expect" of a scene: values that its run must give, and why.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nlohmann/json.hpp>

#include <filesystem>
#include <string>
#include <vector>

namespace ilaw::host {

// Throws SceneError for a quantity that is neither a number of the summary nor a column of the history.
void check_expectations(const nlohmann::json& expected, const nlohmann::json& summary,
                        const std::vector<std::string>& columns);

// The expectations, each with its "found" and whether that is "within" the tolerance. The history is
// complete.
nlohmann::json judge_expectations(const nlohmann::json& expected, const nlohmann::json& summary,
                                  const std::filesystem::path& folder);

// "n0.v0: expected 10 to 0.05, found 9.98".
std::string describe_judged(const nlohmann::json& judged);

}  // namespace ilaw::host
