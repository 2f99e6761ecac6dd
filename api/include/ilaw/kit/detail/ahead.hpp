// ahead.hpp - which arrays of a batch are asked for ahead.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit/detail/block_room.hpp>
#include <ilaw/kit/detail/instance.hpp>

namespace ilaw::kit::inline ILAW_KIT_LEVEL::detail {

// Of batches whose arrays lie in memory, and are copied in part. Nothing is asked for of listed nodes.
template <class Law, class Layout>
class arrays_ahead {
 public:
  // is_read_again: whether a block is gone through several times.
  arrays_ahead(const instance<Law>& made, const ilaw_kit_batch& batch, bool is_read_again)
      : holds_floats_(holds_floats(batch)), asks_all_(!is_in_place<Layout> || is_read_again) {
    if (batch.node_count < streams::fewest_nodes || batch.index || batch.index64) return;
    is_needed_ = is_in_place<Layout> && is_read_again;
    expect_arrays(made, batch);
  }

  // Null where nothing is to be asked for.
  const streams* get() const { return is_needed_ ? &streams_ : nullptr; }

 private:
  // All that is read or written where nodes follow each other, if any of it is copied. Of a batch whose
  // vectors stay where they are, and are read once, only what is copied: the rest comes sooner unasked.
  void expect_arrays(const instance<Law>& made, const ilaw_kit_batch& batch) {
    const int dimension = static_cast<int>(made.dimension), states = state_entries<Law>(dimension);
    if (asks_all_)
      for (const ilaw_kit_input* one : {&batch.v_free, &batch.v_previous, &batch.normal})
        expect(*one, dimension);
    if (asks_all_)
      for (const ilaw_kit_output* one : {&batch.impulse, &batch.velocity}) expect(*one, dimension);
    expect(batch.delassus, delassus_numbers(made.delassus_form, dimension));
    for (const ilaw_kit_input* one : {&batch.gap, &batch.gap_offset, &batch.area}) expect(*one, 1);
    expect(batch.tangent, dimension);
    if (!has_state_rows<Layout>) expect_doubles(batch.state_in, states);
    expect(batch.energy, ILAW_ENERGY_COUNT);
    if (!has_state_rows<Layout> && batch.state_out.values != batch.state_in.values)
      expect_doubles(batch.state_out, states);
    for (std::uint32_t k = 0; k < made.per_node_count; ++k) expect(batch.per_node_parameters[k], 1);
  }

  template <class Array>
  void expect(const Array& array, int numbers) {
    if (!holds_floats_) return expect_doubles(array, numbers);
    if (array.values && add(array.node_stride != 1 || !is_of_floats<Layout>))
      streams_.add(as_floats(array.values), array.node_stride, array.component_stride, numbers);
  }
  template <class Array>
  void expect_doubles(const Array& array, int numbers) {
    if (array.values && add(array.node_stride != 1))
      streams_.add(array.values, array.node_stride, array.component_stride, numbers);
  }
  // Whether an array is asked for.
  bool add(bool is_copied) {
    is_needed_ = is_needed_ || is_copied;
    return is_copied || asks_all_;
  }

  bool holds_floats_, asks_all_, is_needed_ = false;
  streams streams_;
};

}  // namespace ilaw::kit::detail
