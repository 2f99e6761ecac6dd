// gather.hpp - moves a block of nodes between the host's arrays and columns of consecutive doubles.
// Arrays of doubles that are consecutive already are used in place.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit/detail/kit_batch.hpp>
#include <ilaw/kit/detail/rows.hpp>

#include <bit>
#include <cstdint>
#include <type_traits>

namespace ilaw::kit::inline ILAW_KIT_LEVEL::detail {

// Nodes worked on together, at most: enough to fill vectors and to hide what a block costs besides its nodes,
// few enough to stay in the first cache. Fewer where arrays in memory are copied: the copy and the work on it
// add up, and less is gained by more of either at once.
inline constexpr int block_size = 128, short_block = 64;

template <int Length>
struct alignas(64) column_to {
  double values[Length];
};
struct column : column_to<block_size> {};

inline constexpr column zeros{};

// How many numbers of a column are read, where it is read by packs.
inline int in_whole_packs(int count) {
  static_assert(block_size % pack_size == 0);
  return (count + pack_size - 1) / pack_size * pack_size;
}

// Whether any of some numbers that are 0.0 or 1.0 is 1: by their bits, since sums of integers vectorise.
template <class Number>
bool any_one(const Number* values, int count) {
  using bits = std::conditional_t<sizeof(Number) == sizeof(float), std::uint32_t, std::uint64_t>;
  bits found = 0;
  for (int i = 0; i < count; ++i) found |= std::bit_cast<bits>(values[i]);
  return found != 0;
}

// In the flags of a checked batch: its arrays hold floats, those of the state excepted.
inline constexpr std::uint64_t arrays_of_float = 1;
inline bool holds_floats(const ilaw_kit_batch& checked) { return checked.flags == arrays_of_float; }

// An array of the host, once its number type is checked.
inline ilaw_kit_input in_kit(const ilaw_input& a) {
  const auto* values = a.values ? a.values : reinterpret_cast<const double*>(a.floats);
  return {values, a.node_stride, a.component_stride};
}
inline ilaw_kit_output in_kit(const ilaw_output& a) {
  auto* values = a.values ? a.values : reinterpret_cast<double*>(a.floats);
  return {values, a.node_stride, a.component_stride};
}

// The nodes of a block: consecutive from first, or listed.
struct node_range {
  const std::int32_t* index;    // null: consecutive, or
  const std::int64_t* index64;  // in 64 bits
  std::int64_t first;           // position in the batch
  std::int32_t index_base;
  int count;
  bool of_floats;  // see arrays_of_float

  bool listed() const { return index || index64; }
  std::int64_t node(int i) const {
    if (index64) return index64[first + i] - index_base;
    return index ? std::int64_t{index[first + i]} - index_base : first + i;
  }
};

// The host's arrays as what they hold.
inline const float* as_floats(const double* values) { return reinterpret_cast<const float*>(values); }
inline float* as_floats(double* values) { return reinterpret_cast<float*>(values); }

// Gives consecutive values of one component, in the host's array or in room.
template <class Number>
const double* gather_of(const Number* values, std::int64_t stride, const node_range& nodes, double* room) {
  const int count = nodes.count;
  if (nodes.index) {
    const std::int32_t* index = nodes.index + nodes.first;
    for (int i = 0; i < count; ++i) room[i] = values[(std::int64_t{index[i]} - nodes.index_base) * stride];
    return room;
  }
  if (nodes.index64) {
    for (int i = 0; i < count; ++i) room[i] = values[nodes.node(i) * stride];
    return room;
  }
  values += nodes.first * stride;
  if (stride == 1) {
    if constexpr (std::is_same_v<Number, double>) return values;
    for (int i = 0; i < count; ++i) room[i] = values[i];
  } else {
    for (int i = 0; i < count; ++i) room[i] = values[i * stride];
  }
  return room;
}
inline const double* gather(const ilaw_kit_input& input, const node_range& nodes, double* room) {
  if (!nodes.of_floats) return gather_of(input.values, input.node_stride, nodes, room);
  return gather_of(as_floats(input.values), input.node_stride, nodes, room);
}

// Of rows of six numbers compilers make no vector code.
template <int Pair, class Column>
void put_pair(const vectors_of_rows& low, const vectors_of_rows& high, Column* room, int i) {
  const lanes a = low.pair<Pair>(), b = high.pair<Pair>();
  put_lanes(column_of_six<2 * Pair>(a, b, each_lane), room[2 * Pair].values + i);
  put_lanes(column_of_six<2 * Pair + 1>(a, b, each_lane), room[2 * Pair + 1].values + i);
}
template <class Number, class Column>
void separate_sixes(const Number* values, int count, Column* room) {
  int i = 0;
  if constexpr (std::is_same_v<Number, double>)
    for (; i + register_size <= count; i += register_size) {
      const vectors_of_rows low(values + 6 * i), high(values + 6 * i + 3 * register_size);
      put_pair<0>(low, high, room, i);
      put_pair<1>(low, high, room, i);
      put_pair<2>(low, high, room, i);
    }
  for (; i < count; ++i)
    for (int k = 0; k < 6; ++k) room[k].values[i] = values[6 * i + k];
}

// Gives the components of a block of nodes; where a node's are neighbours, in one pass over them.
template <class Number, class Column>
void gather_components_of(const Number* values, std::int64_t node_stride, std::int64_t component_stride,
                          int numbers, const node_range& nodes, Column* room, const double** components) {
  const bool are_rows = !nodes.listed() && component_stride == 1;
  const bool in_rows = are_rows && node_stride == numbers;
  const Number* rows = values + nodes.first * node_stride;
  for (int k = 0; k < numbers; ++k) components[k] = room[k].values;
  if (in_rows && numbers == 2) return separate_pairs(rows, nodes.count, room[0].values, room[1].values);
  if (in_rows && numbers == 3)
    return separate_triples(rows, nodes.count, room[0].values, room[1].values, room[2].values);
  if (in_rows && numbers == 6) return separate_sixes(rows, nodes.count, room);
  if constexpr (std::is_same_v<Number, double>)
    if (are_rows && are_long(numbers))
      return separate_rows(rows, node_stride, numbers, nodes.count, [room](int k) { return room[k].values; });
  for (int k = 0; k < numbers; ++k)
    components[k] = gather_of(values + k * component_stride, node_stride, nodes, room[k].values);
}
template <class Column>
void gather_doubles(const ilaw_kit_input& input, int numbers, const node_range& nodes, Column* room,
                    const double** components) {
  gather_components_of(input.values, input.node_stride, input.component_stride, numbers, nodes, room,
                       components);
}
template <class Column>
void gather_components(const ilaw_kit_input& input, int numbers, const node_range& nodes, Column* room,
                       const double** components) {
  if (!nodes.of_floats) return gather_doubles(input, numbers, nodes, room, components);
  gather_components_of(as_floats(input.values), input.node_stride, input.component_stride, numbers, nodes,
                       room, components);
}

// The three components of a block of vectors.
template <class Column>
void gather_vector(const ilaw_kit_input& input, int dimension, const node_range& nodes, Column* room,
                   const double** components) {
  gather_components(input, dimension, nodes, room, components);
  for (int k = dimension; k < 3; ++k) components[k] = zeros.values;
}

// Where to write one component: in the host's array if it is consecutive, else in room, to be scattered.
inline double* target(const ilaw_kit_output& output, int component, const node_range& nodes, double* room) {
  if (nodes.listed() || nodes.of_floats || output.node_stride != 1) return room;
  return output.values + component * output.component_stride + nodes.first;
}

// Copies a component written to room to the host's array; nothing to do for what was written in place.
template <class Number>
void scatter_of(Number* values, std::int64_t stride, const node_range& nodes, const double* written) {
  if (nodes.index) {
    const std::int32_t* index = nodes.index + nodes.first;
    for (int i = 0; i < nodes.count; ++i)
      values[(std::int64_t{index[i]} - nodes.index_base) * stride] = static_cast<Number>(written[i]);
    return;
  }
  if (nodes.index64) {
    for (int i = 0; i < nodes.count; ++i) values[nodes.node(i) * stride] = static_cast<Number>(written[i]);
    return;
  }
  values += nodes.first * stride;
  if constexpr (std::is_same_v<Number, double>)
    if (values == written) return;
  for (int i = 0; i < nodes.count; ++i) values[i * stride] = static_cast<Number>(written[i]);
}
template <class Number>
void scatter_components_of(Number* values, std::int64_t node_stride, std::int64_t component_stride,
                           int numbers, const node_range& nodes, double* const* components) {
  const bool are_rows = !nodes.listed() && component_stride == 1;
  Number* const rows = values + nodes.first * node_stride;
  if (are_rows && numbers == 3 && node_stride == 3) return interleave(components, nodes.count, rows);
  if constexpr (std::is_same_v<Number, double>)
    if (are_rows && are_long(numbers)) return join_rows(components, numbers, nodes.count, rows, node_stride);
  for (int k = 0; k < numbers; ++k)
    scatter_of(values + k * component_stride, node_stride, nodes, components[k]);
}
inline void scatter_doubles(const ilaw_kit_output& output, int numbers, const node_range& nodes,
                            double* const* components) {
  scatter_components_of(output.values, output.node_stride, output.component_stride, numbers, nodes,
                        components);
}
inline void scatter_components(const ilaw_kit_output& output, int numbers, const node_range& nodes,
                               double* const* components) {
  if (!nodes.of_floats) return scatter_doubles(output, numbers, nodes, components);
  scatter_components_of(as_floats(output.values), output.node_stride, output.component_stride, numbers, nodes,
                        components);
}

}  // namespace ilaw::kit::detail
