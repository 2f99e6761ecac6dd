// instance_base.hpp - what is known of an instance and its batches, whatever the law.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit/detail/view.hpp>
#include <ilaw/kit/window.hpp>

namespace ilaw::kit::inline ILAW_KIT_LEVEL::detail {

// The part of an instance that the loops need, whatever its law.
struct instance_base {
  std::uint32_t dimension, delassus_form, frame, has_tangent, numbers;
  std::uint32_t inputs, balance_inputs;
  bool carries_frame, frame_follows;
  bool asks = false;     // these parameters need the solver, where the law has a step beside it
  window_size window{};  // duration 0: none
  int states;            // numbers of struct state, and for each the entry of the host's state; -1: none
  const int* state_entries;
  std::int64_t history_offset, history_size, frame_offset;
  std::uint64_t state_size;
  std::uint32_t per_node_count;
  int per_node_parameters[most_parameters];  // which of the law's
  const table* node_tables = nullptr;        // by parameter: over fields that come per node; null: none
  std::uint32_t amount_count;

  tangents tangents_from() const {
    if (dimension < 3) return tangents::of_plane;
    if (has_tangent) return tangents::given;
    return carries_frame ? tangents::carried : tangents::chosen;
  }
  bool has_spins() const { return delassus_form == ILAW_DELASSUS_TRANSVERSE_SPIN; }
  bool is_transverse() const {
    return delassus_form == ILAW_DELASSUS_SCALAR || delassus_form == ILAW_DELASSUS_TRANSVERSE || has_spins();
  }
  int delassus_numbers() const {
    const int d = static_cast<int>(dimension);
    switch (delassus_form) {
      case ILAW_DELASSUS_SCALAR:
        return 1;
      case ILAW_DELASSUS_TRANSVERSE:
        return d == 1 ? 1 : 2;
      case ILAW_DELASSUS_TRANSVERSE_SPIN:
        return 5;
      case ILAW_DELASSUS_DIAGONAL:
        return d;
      default:
        return d * (d + 1) / 2;
    }
  }
};

// An impulse times this must be finite.
constexpr double impulse_guard(bool is_float) { return is_float ? 0x1p898 : 4.0; }

template <class Number, class Array>
auto numbers_in(const Array& a) {
  if constexpr (std::is_same_v<Number, float>)
    return a.floats;
  else
    return a.values;
}

// An array of the setup's numbers is there; one of other numbers is as none.
template <class Array>
bool is_absent(const instance_base& made, const Array& a) {
  return made.numbers == ILAW_NUMBERS_FLOAT ? !a.floats : !a.values;
}
// Whether energy or an amount is asked for.
inline bool wants_balance(const instance_base& made, const ilaw_batch& b) {
  if (!is_absent(made, b.energy)) return true;
  for (std::uint32_t k = 0; b.amounts && k < made.amount_count; ++k)
    if (!is_absent(made, b.amounts[k])) return true;
  return false;
}

}  // namespace ilaw::kit::detail
