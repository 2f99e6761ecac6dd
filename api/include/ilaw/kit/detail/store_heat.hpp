// store_heat.hpp - heat and wear of a step, for the host.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit/detail/view.hpp>
#include <ilaw/kit/heat.hpp>

namespace ilaw::kit::inline ILAW_KIT_LEVEL::detail {

// friction is what it dissipated, so that friction/|r_T| is the mean speed of slip where friction alone gives
// r_T (is_free: of bonds). Apart from the loop, which rarely needs it. first: the place of heat among the
// amounts.
template <class V, class Vector, class Number>
ILAW_KIT_APART void store_heat(const view<Number>& b, std::int64_t i, int first, V friction, Vector impulse,
                               Vector twice_mean, V partition, V coefficient, mask_of<V> is_free) {
  const V rubs = impulse.tangential_length(), rest = 1.0 - partition;
  const V speed = select(is_free & (rubs > 0.0), friction / rubs, 0.5 * twice_mean.tangential_length());
  const V area = b.area ? load<V>(b.area + i) : V(0.0);
  const V depth = coefficient * (impulse.n / area);  // per slip
  const mask_of<V> wears = (depth > 0.0) & (area > 0.0) & (speed > 0.0);
  const V amounts[heat_amount_count] = {zero_unless(partition > 0.0, partition * friction),
                                        zero_unless(rest > 0.0, rest * friction),
                                        zero_unless(wears, depth * speed)};
  for (int k = 0; k < heat_amount_count; ++k)
    if (b.amounts[first + k]) detail::store(amounts[k], b.amounts[first + k] + i);
}

}  // namespace ilaw::kit::detail
