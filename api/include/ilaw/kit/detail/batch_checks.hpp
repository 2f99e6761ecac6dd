// batch_checks.hpp - what is known of an instance and its batches, whatever the law; and what is wrong with
// the arrays and numbers of a batch, before any node is looked at.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit/detail/dispatch.hpp>
#include <ilaw/kit/detail/view.hpp>
#include <ilaw/kit/math.hpp>
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
  const ilaw_kit_part* part;       // of the level that the instance uses
  ilaw_kit_loop loop, float_loop;  // null: floats are converted to doubles
  careful_function careful;
  scalar_function scalar;

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

// Options of a view of a batch that its arrays do not decide.
inline view_options options_of(const instance_base& made, const ilaw_batch& b, std::int64_t count) {
  return {.count = count,
          .step = {b.time, b.velocity_step, b.position_step, 1.0 / b.position_step},
          .of_bonds = b.flags & ILAW_BATCH_HOLD_BONDS    ? bonds::hold
                      : b.flags & ILAW_BATCH_BREAK_BONDS ? bonds::break_all
                                                         : bonds::decided_by_law,
          .impulse_guard = made.numbers == ILAW_NUMBERS_FLOAT ? 0x1p898 : 4.0,
          .dimension = static_cast<int>(made.dimension),
          .tangents_from = made.tangents_from(),
          .is_scalar = made.delassus_numbers() == 1,
          .reads_previous = (made.inputs & ILAW_INPUT_V_PREVIOUS) != 0,
          .frame_follows = made.frame_follows,
          .varying = made.per_node_count > 0,
          .in_memory = false,
          .moves = false,
          .has_balance = false,
          .has_amounts = false,
          .tables = made.node_tables,
          .careful = made.careful,
          .scalar = made.scalar};
}

// Flags that say what becomes of bonds are for instances that can hold them.
inline const char* wrong_flags(std::uint32_t capabilities, const ilaw_batch& b) {
  constexpr ilaw_batch_flags of_bonds = ILAW_BATCH_HOLD_BONDS | ILAW_BATCH_BREAK_BONDS;
  if (b.flags & ~of_bonds) return "flags of the batch are not known";
  if (b.flags == of_bonds) return "the batch tells bonds to hold and to break";
  if (capabilities & ILAW_CAN_HOLD_BONDS) return nullptr;
  return "the batch tells bonds to hold or break, of a law that cannot hold bonds";
}

// The inputs that a batch is read for: of what its law reads, and of energies.
inline std::uint32_t inputs_read(const instance_base& made, const ilaw_batch& b) {
  return reads_motion | (made.has_spins() ? reads_spins : 0U) | made.inputs |
         (wants_balance(made, b) ? made.balance_inputs : 0U);
}

// An array of numbers that are not the setup's, or with both pointers.
template <class Array>
bool is_of_other_numbers(const instance_base& made, const Array& a) {
  return made.numbers == ILAW_NUMBERS_FLOAT ? static_cast<bool>(a.values) : static_cast<bool>(a.floats);
}
inline constexpr const char* other_numbers =
    "an array is of other numbers than the setup's, or has both pointers";

// Says what is wrong with the arrays that are read; null when nothing is. A vector whose components have one
// address comes from a flat array of all degrees of freedom, whose first numbers would be taken in silence
// for every component.
inline const char* wrong_input(const instance_base& made, const ilaw_batch& b, std::uint32_t read) {
  const int dimension = static_cast<int>(made.dimension);
  const char* wrong = nullptr;
  const auto check = [&](const array_card& card, const ilaw_input& a) {
    if (wrong || !card.is_in(read)) return;
    if (card.is_required && is_absent(made, a))
      wrong = card.absent;
    else if ((a.values || a.floats) && card.count(dimension) > 1 && a.component_stride == 0)
      wrong = card.flat;
    else if (is_of_other_numbers(made, a))
      wrong = other_numbers;
  };
  for_inputs(check, b);
  if (wrong || made.per_node_count == 0) return wrong;
  if (!b.per_node_parameters) return "per_node_parameters is null";
  for (std::uint32_t k = 0; k < made.per_node_count; ++k) {
    if (is_absent(made, b.per_node_parameters[k])) return "values of a per-node parameter are null";
    if (is_of_other_numbers(made, b.per_node_parameters[k])) return other_numbers;
  }
  return nullptr;
}

// The smallest of a list of nodes: below index_base it would lead before the arrays.
template <class Integer>
Integer smallest(const Integer* index, std::int64_t count) {
  Integer least = std::numeric_limits<Integer>::max();
  for (std::int64_t k = 0; k < count; ++k) least = index[k] < least ? index[k] : least;
  return least;
}

// is_here: the list can be read.
inline const char* wrong_index(const ilaw_batch& b, bool is_here) {
  if (b.index_base != 0 && b.index_base != 1) return "index_base is neither 0 nor 1";
  if (b.index && b.index64) return "index and index64 are both given";
  if (!is_here) return nullptr;
  if ((b.index && smallest(b.index, b.node_count) < b.index_base) ||
      (b.index64 && smallest(b.index64, b.node_count) < b.index_base))
    return "a node of the index list lies below index_base";
  return nullptr;
}

inline const char* wrong_scalars(const ilaw_batch& b, bool list_is_here = true) {
  if (b.node_count < 0) return "node_count is negative";
  if (!is_finite(b.time)) return "time is not finite";
  return wrong_index(b, list_is_here);
}

// Whether an output gives two numbers the same place.
inline bool collides(const ilaw_output& a, std::int64_t nodes, std::int64_t components) {
  return (a.values || a.floats) && components > 0 &&
         ((nodes > 1 && a.node_stride == 0) || (components > 1 && a.component_stride == 0));
}

inline const char* wrong_state_out(const instance_base& made, const ilaw_batch& b) {
  if (made.state_size > 0 && !b.state_out.values) return "state_out is null";
  if (made.state_size > 0 && b.state_out.floats) return other_numbers;
  const bool is_bad = collides(b.state_out, b.node_count, static_cast<std::int64_t>(made.state_size));
  return is_bad ? "state_out has a stride of 0" : nullptr;
}

inline const char* wrong_output(const instance_base& made, const ilaw_batch& b, std::uint32_t read) {
  const int dimension = static_cast<int>(made.dimension);
  const char* wrong = nullptr;
  const auto check = [&](const array_card& card, const ilaw_output& a) {
    if (wrong || !card.is_in(read)) return;
    if (card.is_required && is_absent(made, a))
      wrong = card.absent;
    else if (collides(a, b.node_count, card.count(dimension)))
      wrong = card.collides;
    else if (is_of_other_numbers(made, a))
      wrong = other_numbers;
  };
  for_outputs(check, b);
  if (wrong) return wrong;
  if (b.status && b.node_count > 1 && b.status_stride == 0) return "status_stride is 0";
  for (std::uint32_t k = 0; b.amounts && k < made.amount_count; ++k) {
    if (collides(b.amounts[k], b.node_count, 1)) return "an amount has a stride of 0";
    if (is_of_other_numbers(made, b.amounts[k])) return other_numbers;
  }
  return wrong_state_out(made, b);
}

inline const char* wrong_batch(const instance_base& made, const ilaw_batch& b, bool list_is_here = true) {
  if (const char* wrong = wrong_scalars(b, list_is_here)) return wrong;
  if (!(b.velocity_step > 0.0) || !is_finite(b.velocity_step))
    return "velocity_step is not a finite number > 0";
  if (!(b.position_step > 0.0) || !is_finite(b.position_step))
    return "position_step is not a finite number > 0";
  if (b.node_count == 0) return nullptr;
  const std::uint32_t read = inputs_read(made, b);
  if (const char* wrong = wrong_input(made, b, read)) return wrong;
  if (is_absent(made, b.delassus)) return "delassus is null";
  if (is_of_other_numbers(made, b.delassus)) return other_numbers;
  if (made.state_size > 0 && !b.state_in.values) return "state_in is null";
  if (made.state_size > 0 && b.state_in.floats) return other_numbers;
  return wrong_output(made, b, read);
}

inline const char* wrong_initial(const instance_base& made, const ilaw_batch& b) {
  if (const char* wrong = wrong_scalars(b)) return wrong;
  if (b.node_count == 0) return nullptr;
  const std::uint32_t read = made.inputs & (ILAW_INPUT_AREA | ILAW_INPUT_NORMAL | ILAW_INPUT_TANGENT);
  if (const char* wrong = wrong_input(made, b, read)) return wrong;
  return wrong_state_out(made, b);
}

}  // namespace ilaw::kit::detail
