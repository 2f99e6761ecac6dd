// interleaving.hpp - which batches are worked on in (3,n) arrays where they are: nothing of their vectors is
// copied, and a core computes one node while it waits for the lines of others.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit/detail/instance.hpp>
#include <ilaw/kit/detail/one_step.hpp>

namespace ilaw::kit::inline ILAW_KIT_LEVEL::detail {

template <class Law>
inline constexpr bool in_space = (Law::card.dimensions & ILAW_DIMENSION_3) != 0;

// Whether the vectors that a kernel may read and write in place are (3,n) arrays, and no more is asked than
// the kernels of such arrays give: impulses, or velocities and statuses besides.
template <class Law>
bool all_interleaved(const instance<Law>& made, const ilaw_batch& b) {
  if (b.energy.values || (b.status && !b.velocity.values)) return false;
  const auto is_interleaved = [](const auto& a) { return a.node_stride == 3 && a.component_stride == 1; };
  const auto may_be = [is_interleaved](const auto& a) { return !a.values || is_interleaved(a); };
  return made.dimension == 3 && !b.index && !b.index64 && !holds_floats(b) && is_interleaved(b.v_free) &&
         is_interleaved(b.impulse) && may_be(b.v_previous) && may_be(b.velocity) &&
         (made.frame == ILAW_FRAME_LOCAL || is_interleaved(b.normal));
}
// For which laws they are worth their loops. One that asks first reads its nodes several times, which columns
// serve better where H leaves much to solve.
template <class Law, class Delassus, class Frame>
inline constexpr bool may_interleave =
    in_space<Law> && !is_for_old_processors && !std::is_same_v<Frame, stored_frame> &&
    (std::is_same_v<Delassus, transverse_delassus> || !asks_first<Law, node_in<Law, Delassus, Frame>>);

}  // namespace ilaw::kit::detail
