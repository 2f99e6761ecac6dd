// law_checks.hpp - what a law must have to be one, each with the line that says what to write.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit/node.hpp>

namespace ilaw::kit::inline ILAW_KIT_LEVEL::detail {

template <template <class> class Law>
constexpr bool checked() {
  return true;
}

}  // namespace ilaw::kit::detail
