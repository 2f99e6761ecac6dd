// watched_law.hpp - a law as the solver of coupled contacts calls it: each call is watched as the host's own
// are, so that a broken library is named.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "contact/law.hpp"

#include <cstddef>
#include <cstdint>
#include <string>

namespace ilaw::host {

class WatchedLaw {
 public:
  // law and interface must live as long.
  WatchedLaw(const Law& law, const std::string& interface, int dimension);
  WatchedLaw(WatchedLaw&&) = default;  // before the first call: instance() is its address

  // Members of ilaw_contacts.
  const ilaw_law* law() const { return &entry_; }
  const ilaw_instance* instance() const { return reinterpret_cast<const ilaw_instance*>(this); }

  // Before a step. watches_inputs: whether calls may not write to their inputs.
  void open(bool watches_inputs) {
    refusal_ = {};
    watches_inputs_ = watches_inputs;
  }
  // The first call since open() that ended a solve.
  const Refusal& refusal() const { return refusal_; }

 private:
  static std::int32_t ILAW_CALL info_of(const ilaw_instance* instance, ilaw_instance_info* info);
  static std::int32_t ILAW_CALL evaluate_of(const ilaw_instance* instance, const ilaw_batch* batch,
                                            ilaw_report* report);
  std::int32_t evaluate(const ilaw_batch& batch, ilaw_report* report);
  void find_wild_impulse(const ilaw_batch& batch, Refusal& refusal) const;

  const Law& law_;
  const std::string& interface_;
  std::size_t dimension_;
  ilaw_law entry_;
  Refusal refusal_;
  std::string reason_;
  bool watches_inputs_ = false;
};

}  // namespace ilaw::host
