// watched_law.hpp - a law as the solver of coupled contacts calls it, from any of its threads: results are
// checked as those of the host's own calls are.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "contact/law.hpp"

#include <cstddef>
#include <cstdint>

namespace ilaw::host {

class WatchedLaw {
 public:
  // law must live as long.
  WatchedLaw(const Law& law, int dimension);
  WatchedLaw(WatchedLaw&&) = default;  // before the first call: instance() is its address

  // Members of ilaw_contacts.
  const ilaw_law* law() const { return &entry_; }
  const ilaw_instance* instance() const { return reinterpret_cast<const ilaw_instance*>(this); }

 private:
  static std::int32_t ILAW_CALL info_of(const ilaw_instance* instance, ilaw_instance_info* info);
  static std::int32_t ILAW_CALL evaluate_of(const ilaw_instance* instance, const ilaw_batch* batch,
                                            ilaw_report* report);
  const char* wild_impulse(const ilaw_batch& batch) const;

  const Law& law_;
  std::size_t dimension_;
  ilaw_law entry_;
};

}  // namespace ilaw::host
