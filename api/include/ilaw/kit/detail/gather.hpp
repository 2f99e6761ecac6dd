// gather.hpp - moves a block of nodes between the host's arrays and columns of consecutive doubles.
// Arrays of doubles that are consecutive already are used in place.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/ilaw.h>
#include <ilaw/kit/detail/level.hpp>

#include <cstdint>
#include <type_traits>

namespace ilaw::kit::inline ILAW_KIT_LEVEL::detail {

// Nodes worked on together: enough to fill vectors and hide loop overhead, few enough to stay in the first
// cache.
inline constexpr int block_size = 64;

struct alignas(64) column {
  double values[block_size];
};

inline constexpr column zeros{};

// In the flags of a batch, once checked: its arrays, but those of the state, hold floats (ilaw/float.h). No
// host can set it, since every flag of a host's is refused.
inline constexpr std::uint64_t arrays_of_float = 1;
inline bool holds_floats(const ilaw_batch& checked) { return checked.flags == arrays_of_float; }

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

// Asks for the same part of the next block while this one is worked on: hardware prefetchers lose the many
// streams of a batch at block boundaries.
template <class Number>
void prefetch_next(const Number* values, std::int64_t count) {
  constexpr std::int64_t line = 64 / sizeof(Number);
  for (std::int64_t k = 0; k < count; k += line) __builtin_prefetch(values + count + k);
}

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
    prefetch_next(values, count);
    if constexpr (std::is_same_v<Number, double>) return values;
    for (int i = 0; i < count; ++i) room[i] = values[i];
  } else if (stride == 2) {  // pairs, as of a transverse H, in vector code
    prefetch_next(values, 2 * count);
    for (int i = 0; i < count; ++i) room[i] = values[2 * i];
  } else {
    for (int i = 0; i < count; ++i) room[i] = values[i * stride];
  }
  return room;
}
inline const double* gather_doubles(const ilaw_input& input, int component, const node_range& nodes,
                                    double* room) {
  return gather_of(input.values + component * input.component_stride, input.node_stride, nodes, room);
}
inline const double* gather(const ilaw_input& input, int component, const node_range& nodes, double* room) {
  if (!nodes.of_floats) return gather_doubles(input, component, nodes, room);
  const float* values = as_floats(input.values) + component * input.component_stride;
  return gather_of(values, input.node_stride, nodes, room);
}

// The components of a block of an (3,n) array.
template <class Number>
void separate(const Number* __restrict__ values, int count, column* room) {
  prefetch_next(values, 3 * count);
  double* __restrict__ a = room[0].values, * __restrict__ b = room[1].values, * __restrict__ c = room[2].values;
#pragma omp simd
  for (int i = 0; i < count; ++i) {
    a[i] = values[3 * i];
    b[i] = values[3 * i + 1];
    c[i] = values[3 * i + 2];
  }
}
template <class Number>
void interleave(double* const* components, int count, Number* __restrict__ values) {
  const double* __restrict__ a = components[0], * __restrict__ b = components[1], * __restrict__ c = components[2];
#pragma omp simd
  for (int i = 0; i < count; ++i) {
    values[3 * i] = static_cast<Number>(a[i]);
    values[3 * i + 1] = static_cast<Number>(b[i]);
    values[3 * i + 2] = static_cast<Number>(c[i]);
  }
}

// Gives the three components of a block of vectors; (3,n) arrays are transposed in one pass.
inline void gather_vector(const ilaw_input& input, int dimension, const node_range& nodes, column* room,
                          const double** components) {
  if (dimension == 3 && !nodes.listed() && input.node_stride == 3 && input.component_stride == 1) {
    if (nodes.of_floats)
      separate(as_floats(input.values) + 3 * nodes.first, nodes.count, room);
    else
      separate(input.values + 3 * nodes.first, nodes.count, room);
    for (int k = 0; k < 3; ++k) components[k] = room[k].values;
    return;
  }
  for (int k = 0; k < 3; ++k)
    components[k] = k < dimension ? gather(input, k, nodes, room[k].values) : zeros.values;
}

// Where to write one component: in the host's array if it is consecutive, else in room, to be scattered.
inline double* target(const ilaw_output& output, int component, const node_range& nodes, double* room) {
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
inline void scatter_doubles(const ilaw_output& output, int component, const node_range& nodes,
                            const double* written) {
  scatter_of(output.values + component * output.component_stride, output.node_stride, nodes, written);
}
inline void scatter(const ilaw_output& output, int component, const node_range& nodes,
                    const double* written) {
  if (!nodes.of_floats) return scatter_doubles(output, component, nodes, written);
  float* values = as_floats(output.values) + component * output.component_stride;
  scatter_of(values, output.node_stride, nodes, written);
}

inline void scatter_vector(const ilaw_output& output, int dimension, const node_range& nodes,
                           double* const* components) {
  if (dimension == 3 && !nodes.listed() && output.node_stride == 3 && output.component_stride == 1) {
    if (nodes.of_floats)
      interleave(components, nodes.count, as_floats(output.values) + 3 * nodes.first);
    else
      interleave(components, nodes.count, output.values + 3 * nodes.first);
    return;
  }
  for (int k = 0; k < dimension; ++k) scatter(output, k, nodes, components[k]);
}

}  // namespace ilaw::kit::detail
