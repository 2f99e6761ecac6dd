// node_checks.hpp - what finds bad nodes in a pack, and in the careful loop the reason of each.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit/detail/view.hpp>

namespace ilaw::kit::inline ILAW_KIT_LEVEL::detail {

// Finds bad lanes: a product of all numbers that must be finite, zero where they are. Careful: and why.
template <class V, bool Careful>
struct checks {
  V found = 0.0;

  ILAW_KIT_INLINE void finite(V x, reason) { found = found * x; }
  template <class Vector>
  ILAW_KIT_INLINE void finite_vector(Vector a, reason, bool /*of_frame*/ = false) {
    found = residual(a, found);
  }
  ILAW_KIT_INLINE void require(mask_of<V> good, reason) { found = nan_unless(good, found); }
  ILAW_KIT_INLINE void frame(mask_of<V>) {}
  ILAW_KIT_INLINE mask_of<V> bad() const { return !(found == 0.0); }
};
template <class V>
struct checks<V, true> {
  V code = 0.0;
  mask_of<V> framed = V(0.0) == V(0.0);

  ILAW_KIT_INLINE void require(mask_of<V> good, reason why) {
    code = select((code == 0.0) & (!good), V(static_cast<double>(why)), code);
  }
  ILAW_KIT_INLINE void finite(V x, reason why) { require(0.0 * x == 0.0, why); }
  // A vector that was turned by a frame that is none says nothing.
  template <class Vector>
  ILAW_KIT_INLINE void finite_vector(Vector a, reason why, bool of_frame = false) {
    const auto good = residual(a, V(0.0)) == 0.0;
    require(of_frame ? good | !framed : good, why);
  }
  ILAW_KIT_INLINE void frame(mask_of<V> good) { framed = good; }
  ILAW_KIT_INLINE mask_of<V> bad() const { return code != 0.0; }
};

}  // namespace ilaw::kit::detail
