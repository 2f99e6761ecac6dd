// float_environment.hpp - in place of the kit's own: leaves the floating-point environment as it is, to
// measure what the kit's costs.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit/detail/level.hpp>

namespace ilaw::kit::inline ILAW_KIT_LEVEL::detail {

class float_environment {
 public:
  float_environment() {}
  ~float_environment() {}
};

}  // namespace ilaw::kit::detail
