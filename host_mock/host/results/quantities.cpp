// SPDX-License-Identifier: BSD-3-Clause
#include "results/quantities.hpp"

#include "base/csv_file.hpp"
#include "base/scene_error.hpp"

#include <algorithm>
#include <cmath>

namespace ilaw::host {

using nlohmann::json;

std::vector<ShownState> shown_states(const ilaw_instance_info& info) {
  std::vector<ShownState> states;
  std::size_t entry = 0;
  for (std::uint32_t i = 0; i < info.state_variable_count; ++i) {
    const ilaw_state_variable& variable = *info.state_variables[i];
    const bool is_vector = variable.kind == ILAW_KIND_VECTOR || variable.kind == ILAW_KIND_TANGENTIAL;
    if (!(variable.flags & ILAW_FLAG_INTERNAL) && (is_vector || variable.kind == ILAW_KIND_SCALAR))
      states.push_back({variable.name, entry, variable.count, is_vector});
    entry += variable.count;
  }
  return states;
}

std::map<std::string, json> numbers_of(const json& summary) {
  std::map<std::string, json> numbers;
  const auto add = [&](const std::string& part, const json& values) {
    if (values.is_structured() && values.empty()) return;
    const json flat = json{{part, values}}.flatten();
    for (const auto& [pointer, value] : flat.items()) {
      std::string name = pointer.substr(1);
      std::replace(name.begin(), name.end(), '/', '.');
      if (!value.is_structured()) numbers[name] = value;
    }
  };
  for (const char* part : {"steps", "dt", "time", "failure", "interrupted", "penetration_max", "stable_step",
                           "energy", "status_counts", "forces", "coupling", "heat", "prestress", "seconds"})
    if (summary.contains(part)) add(part, summary[part]);
  for (const json& interface : summary.value("interfaces", json::array()))
    for (const char* part : {"first_contact", "amounts"})
      if (const json& values = interface.at(part); !values.is_structured() || !values.empty())
        add(interface.at("name"), {{part, values}});
  numbers["warnings"] = summary.value("warnings", json::array()).size();
  return numbers;
}

HistoryQuantity history_quantity(const std::string& name) {
  const std::size_t colon = name.rfind(':');
  const std::string kind = colon == std::string::npos ? "last" : name.substr(colon + 1);
  if (kind != "last" && kind != "min" && kind != "max" && kind != "mean")
    throw InputError(name + ": found '" + kind + "', expected one of last, min, max, mean");
  return {name.substr(0, colon), kind};
}

std::optional<double> value_of(const HistoryQuantity& quantity, const std::filesystem::path& folder) {
  CsvFile history(folder / "history.csv");
  const auto index = history.index_of(quantity.column);
  if (!index) return std::nullopt;
  double last = std::nan(""), least = HUGE_VAL, largest = -HUGE_VAL, sum = 0.0, count = 0.0;
  for (std::vector<double> row; history.next(row);) {
    last = row[*index];
    if (!std::isfinite(last)) continue;
    least = std::min(least, last);
    largest = std::max(largest, last);
    sum += last;
    ++count;
  }
  if (quantity.kind == "min") return least;
  if (quantity.kind == "max") return largest;
  return quantity.kind == "mean" ? sum / count : last;
}

}  // namespace ilaw::host
