// quantities.hpp - a number of a run by its name, as `ilaw table` and the "expect" of a scene use it.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nlohmann/json.hpp>

#include <filesystem>
#include <map>
#include <optional>
#include <string>

namespace ilaw::host {

// The numbers of a summary, by names as "energy.kinetic".
std::map<std::string, nlohmann::json> numbers_of(const nlohmann::json& summary);

// "n0.u0:max": a column of the history and which of its values; the last without a colon.
struct HistoryQuantity {
  std::string column, kind;
};
// Throws InputError where the kind is none of last, min, max and mean.
HistoryQuantity history_quantity(const std::string& name);
// Nothing where the history of the folder has no such column.
std::optional<double> value_of(const HistoryQuantity& quantity, const std::filesystem::path& folder);

}  // namespace ilaw::host
