// parameter_range.hpp - the values that a parameter may have, for numbers and packs.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit/math.hpp>

namespace ilaw::kit::inline ILAW_KIT_LEVEL::detail {

struct parameter_range {
  double minimum, excluded, maximum, beyond;

  constexpr parameter_range(double least, bool excludes, double most, bool allows_infinity)
      : minimum(least),
        excluded(excludes ? least : not_a_number),
        maximum(smaller(most, std::numeric_limits<double>::max())),
        beyond(allows_infinity ? infinity : not_a_number) {}
  template <class V>
  ILAW_KIT_INLINE auto has(V value) const {
    return (value >= minimum) & (value != excluded) & ((value <= maximum) | (value == beyond));
  }
};

}  // namespace ilaw::kit::detail
