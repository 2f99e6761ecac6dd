// roots.hpp - the root of one equation with one unknown, between two numbers where it has different signs.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit/math.hpp>

namespace ilaw::kit::inline ILAW_KIT_LEVEL {

// Two ends 0 <= low < high of an interval and what a function is there: positive at low, not so at high.
template <class V>
struct bracket {
  V low, at_low, high, at_high;
};

// The end high of a bracket as narrow as numbers are. Secants that keep the root between them (Illinois; Dowell and
// Jarratt 1971), and every third time the middle, so that no shape takes long. Only lanes of `active` are moved.
template <class V, class Function>
V root_in(bracket<V> b, mask_of<V> active, Function f) {
  constexpr int most_iterations = 200;
  constexpr double far = 4.0, smallest_part = 0x1p-80;
  V last = 0.0;  // the sign of the value before
  for (int k = 0; k < most_iterations; ++k) {
    const V secant = b.low + (b.high - b.low) * (b.at_low / (b.at_low - b.at_high));
    // As bits count where the ends are far apart, so that a root of any size is found.
    const V middle = select(b.high <= far * b.low, 0.5 * (b.low + b.high),
                            halfway(larger(b.low, smallest_part * b.high), b.high));
    const V x = select((secant > b.low) & (secant < b.high) & (k % 3 != 2), secant, middle);
    active = active & (b.at_high < 0.0) & (x > b.low) & (x < b.high);
    if (!any(active)) break;
    const V value = f(x), factor = select(last * value > 0.0, V(0.5), V(1.0));
    const mask_of<V> rises = active & (value > 0.0), falls = active & !(value > 0.0);
    b.low = select(rises, x, b.low);
    b.high = select(falls, x, b.high);
    b.at_low = select(rises, value, select(falls, b.at_low * factor, b.at_low));
    b.at_high = select(falls, value, select(rises, b.at_high * factor, b.at_high));
    last = select(active, select(rises, V(1.0), V(-1.0)), last);
  }
  return b.high;
}

}  // namespace ilaw::kit
