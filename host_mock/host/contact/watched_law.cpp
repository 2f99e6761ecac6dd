// SPDX-License-Identifier: BSD-3-Clause
#include "contact/watched_law.hpp"

#include "contact/law_faults.hpp"

#include <array>
#include <cmath>

namespace ilaw::host {

WatchedLaw::WatchedLaw(const Law& law, int dimension)
    : law_(law), dimension_(static_cast<std::size_t>(dimension)), entry_{} {
  entry_.struct_size = sizeof entry_;
  entry_.outputs = law.outputs();
  entry_.id = law.id();
  entry_.info = info_of;
  entry_.evaluate = evaluate_of;
}

// Why an impulse is none, before other laws see its velocity and are blamed; null: all are. Which node a
// place of the batch is, the solver knows.
const char* WatchedLaw::wild_impulse(const ilaw_batch& batch) const {
  constexpr std::array<double, ILAW_ENERGY_COUNT> no_energy{};
  std::array<double, 3> impulse{};
  for (std::int64_t i = 0; i < batch.node_count; ++i) {
    const double* const first = batch.impulse.values + i * batch.impulse.node_stride;
    bool is_finite = true;
    for (std::size_t c = 0; c < dimension_; ++c) {
      impulse[c] = first[static_cast<std::int64_t>(c) * batch.impulse.component_stride];
      is_finite = is_finite && std::isfinite(impulse[c]);
    }
    if (!is_finite)
      return fault_of(impulse.data(), static_cast<int>(dimension_), no_energy.data(), ILAW_FREE);
  }
  return nullptr;
}

std::int32_t ILAW_CALL WatchedLaw::info_of(const ilaw_instance* instance, ilaw_instance_info* info) {
  *info = reinterpret_cast<const WatchedLaw*>(instance)->law_.info();
  info->inputs |= ILAW_INPUT_NORMAL;  // the solver knows the global frame by it
  return ILAW_OK;
}

// Contacts with bad input are left to the solver, which goes on with the others.
std::int32_t ILAW_CALL WatchedLaw::evaluate_of(const ilaw_instance* instance, const ilaw_batch* batch,
                                               ilaw_report* report) {
  const auto& watched = *reinterpret_cast<const WatchedLaw*>(instance);
  const Answer answer = watched.law_.evaluate(*batch);
  *report = answer.report;
  if (answer.code != ILAW_OK) return answer.code;
  report->reason = watched.wild_impulse(*batch);
  return report->reason ? ILAW_BAD_LIBRARY : ILAW_OK;
}

}  // namespace ilaw::host
