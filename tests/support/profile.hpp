// profile.hpp - what a law of the kit says of its own work.
#pragma once

#include "support/law_batch.hpp"

#include <ilaw/ext/draft/profile.h>

namespace ilaw::testing {

// Evaluates the nodes, bad ones among them; returns how many were solved one by one.
inline std::int64_t one_by_one(LawBatch& nodes) {
  const auto* profile = static_cast<const ilaw_profile*>(nodes.law->law().extension(ILAW_PROFILE));
  std::int64_t count = -1;
  const ilaw_batch b = nodes.batch();
  EXPECT_GE(profile->evaluate_counting(nodes.law->instance(), &b, &nodes.report, &count), ILAW_OK);
  return count;
}

}  // namespace ilaw::testing
