// SPDX-License-Identifier: BSD-3-Clause
#include "check/reach.hpp"

#include <algorithm>
#include <cmath>

namespace ilaw::check {

void Reach::add(const ilaw_instance_info& info, const std::vector<double>& before,
                const std::vector<double>& after, const std::vector<std::uint8_t>& status) {
  for (const std::uint8_t one : status)
    if (one < ILAW_STATUS_COUNT) ++statuses[one];
  const std::size_t width = info.state_size, nodes = width == 0 ? 0 : after.size() / width;
  steps += std::max(nodes, status.size());
  for (std::size_t k = 0, first = 0; k < info.state_variable_count; ++k) {
    const ilaw_state_variable& variable = *info.state_variables[k];
    Range& range = states[variable.name];
    for (std::size_t i = 0; i < nodes; ++i)
      for (std::size_t at = i * width + first; at < i * width + first + variable.count; ++at) {
        if (!std::isfinite(after[at])) continue;
        range.least = std::min(range.least, after[at]);
        range.largest = std::max(range.largest, after[at]);
        range.changed = range.changed || after[at] != before[at];
      }
    first += variable.count;
  }
}

void Reach::add(const Reach& other) {
  steps += other.steps;
  for (std::size_t k = 0; k < statuses.size(); ++k) statuses[k] += other.statuses[k];
  for (const auto& [name, more] : other.states) {
    Range& range = states[name];
    range.least = std::min(range.least, more.least);
    range.largest = std::max(range.largest, more.largest);
    range.changed = range.changed || more.changed;
  }
}

Reach& reach_of_thread() {
  static thread_local Reach all;
  return all;
}

const char* name_of_status(std::size_t status) {
  static constexpr std::array<const char*, ILAW_STATUS_COUNT> names{
      "free", "closed", "stick", "slip", "bonded", "broken", "healed", "bad input"};
  return names[status];
}

std::vector<std::string> missing_in(const Reach& one, const Reach& all) {
  std::vector<std::string> missing;
  for (std::size_t k = 0; k < one.statuses.size(); ++k)
    if (k != ILAW_BAD_INPUT && one.statuses[k] == 0 && all.statuses[k] > 0)
      missing.push_back(std::string("status ") + name_of_status(k));
  for (const auto& [name, range] : all.states) {
    const auto found = one.states.find(name);
    if (found == one.states.end() || !found->second.changed) missing.push_back("state " + name);
  }
  return missing;
}

}  // namespace ilaw::check
