// quantities.hpp - numbers of a run by their names, as results and the "expect" of a scene use them.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/ilaw.h>

#include <nlohmann/json.hpp>

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace ilaw::host {

// A named variable and where it stands in the state of a node. Histories and what is internal mean nothing
// outside their law and are left out.
struct ShownState {
  std::string name;
  std::size_t entry, count;
  bool is_vector;
};
std::vector<ShownState> shown_states(const ilaw_instance_info& info);

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
