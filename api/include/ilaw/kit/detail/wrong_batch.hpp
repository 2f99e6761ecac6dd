// wrong_batch.hpp - what is wrong with the arrays and numbers of a batch, before any node is looked at.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit/detail/batch_walk.hpp>

namespace ilaw::kit::inline ILAW_KIT_LEVEL::detail {

// What is wrong with the arrays that evaluate or initialise needs; null when nothing is.
template <class Law>
const char* missing_input(const instance<Law>& made, const ilaw_kit_batch& b, std::uint32_t needed) {
  if ((needed & ILAW_INPUT_GAP) && !b.gap.values) return "gap is null";
  if ((needed & ILAW_INPUT_V_PREVIOUS) && !b.v_previous.values) return "v_previous is null";
  if ((needed & ILAW_INPUT_AREA) && !b.area.values) return "area is null";
  if ((needed & ILAW_INPUT_NORMAL) && !b.normal.values) return "normal is null";
  if ((needed & ILAW_INPUT_TANGENT) && !b.tangent.values) return "tangent is null";
  if (made.per_node_count > 0 && !b.per_node_parameters) return "per_node_parameters is null";
  for (std::uint32_t k = 0; k < made.per_node_count; ++k)
    if (!in_kit(b.per_node_parameters[k]).values) return "values of a per-node parameter are null";
  if (made.state_size > 0 && !b.state_out.values) return "state_out is null";
  return nullptr;
}

// The smallest of a list of nodes: below index_base it would lead before the arrays.
template <class Integer>
Integer smallest(const Integer* index, std::int64_t count) {
  Integer least = std::numeric_limits<Integer>::max();
#pragma omp simd reduction(min : least)
  for (std::int64_t k = 0; k < count; ++k) least = index[k] < least ? index[k] : least;
  return least;
}

inline const char* wrong_index(const ilaw_kit_batch& b) {
  if (b.index_base != 0 && b.index_base != 1) return "index_base is neither 0 nor 1";
  if (b.index && b.index64) return "index and index64 are both given";
  if ((b.index && smallest(b.index, b.node_count) < b.index_base) ||
      (b.index64 && smallest(b.index64, b.node_count) < b.index_base))
    return "a node of the index list lies below index_base";
  return nullptr;
}

inline const char* wrong_scalars(const ilaw_kit_batch& b) {
  if (b.node_count < 0) return "node_count is negative";
  if (!is_finite(b.time)) return "time is not finite";
  return wrong_index(b);
}

// Whether an output gives two numbers the same place.
inline bool collides(const ilaw_kit_output& a, std::int64_t nodes, std::int64_t components) {
  return a.values && components > 0 &&
         ((nodes > 1 && a.node_stride == 0) || (components > 1 && a.component_stride == 0));
}

template <class Law>
const char* colliding_state(const instance<Law>& made, const ilaw_kit_batch& b) {
  const bool is_bad = collides(b.state_out, b.node_count, static_cast<std::int64_t>(made.state_size));
  return is_bad ? "state_out has a stride of 0" : nullptr;
}

template <class Law>
const char* colliding_output(const instance<Law>& made, const ilaw_kit_batch& b) {
  const std::int64_t n = b.node_count, d = made.dimension;
  if (collides(b.impulse, n, d)) return "impulse has a stride of 0";
  if (collides(b.velocity, n, d)) return "velocity has a stride of 0";
  if (collides(b.energy, n, ILAW_ENERGY_COUNT)) return "energy has a stride of 0";
  if (b.status && n > 1 && b.status_stride == 0) return "status_stride is 0";
  return colliding_state(made, b);
}

template <class Law>
const char* wrong_batch(const instance<Law>& made, const ilaw_kit_batch& b) {
  if (const char* wrong = wrong_scalars(b)) return wrong;
  if (!(b.velocity_step > 0.0) || !is_finite(b.velocity_step))
    return "velocity_step is not a finite number > 0";
  if (!(b.position_step > 0.0) || !is_finite(b.position_step))
    return "position_step is not a finite number > 0";
  if (b.node_count == 0) return nullptr;
  if (!b.v_free.values) return "v_free is null";
  if (!b.delassus.values) return "delassus is null";
  if (!b.impulse.values) return "impulse is null";
  if (made.state_size > 0 && !b.state_in.values) return "state_in is null";
  if (const char* wrong = colliding_output(made, b)) return wrong;
  return missing_input(made, b, made.inputs() | (b.energy.values ? made.energy_inputs() : 0U));
}

}  // namespace ilaw::kit::detail
