// law.hpp - a law as this host holds it: the library, the instance made from a scene's parameters,
// and its two calls, initialise and evaluate.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "contact/law_arguments.hpp"

#include <ilaw/loader.hpp>

#include <cstdint>
#include <string>
#include <vector>

namespace ilaw::host {

// What a law answered: ILAW_OK and the stable step of all, or the code and the report of the first
// part of the batch that it refused.
struct Answer {
  std::int32_t code;
  ilaw_report report;
};

class Law {
 public:
  // Loads the library, by name or path, and creates the law; throws as create_law.
  Law(const std::string& library, const std::string& law, const Arguments& arguments, const Vector& tangent,
      int dimension);

  const ilaw::library& library() const { return library_; }
  const ilaw_instance_info& info() const { return info_; }
  bool acts_at_distance() const { return (info_.capabilities & ILAW_CAN_ACT_AT_DISTANCE) != 0; }
  // Whether a contact whose last status was ILAW_FREE does nothing out of reach (ilaw.h, ILAW_CAN_REST).
  bool rests() const { return (info_.capabilities & ILAW_CAN_REST) != 0; }
  // Whether the state holds axes, which turn with the normal from step to step.
  bool carries_axes() const;

  // Both work on the listed entries of the batch's arrays; evaluate shares a long list among
  // threads.
  Answer initialise(ilaw_batch batch, const std::vector<std::int32_t>& contacts) const;
  Answer evaluate(const ilaw_batch& batch, const std::vector<std::int32_t>& contacts) const;

  // Contacts of one call where threads share a batch.
  static constexpr int chunk = 2048;

 private:
  ilaw::library library_;
  ilaw::interface interface_;
  ilaw_instance_info info_;
};

}  // namespace ilaw::host
