// gather.hpp - moves a block of nodes between the host's arrays and columns of consecutive doubles.
// Arrays that are consecutive already are used in place.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/ilaw.h>
#include <ilaw/kit/detail/level.hpp>

#include <cstdint>

namespace ilaw::kit::inline ILAW_KIT_LEVEL {

// Nodes worked on together: enough to fill vectors and hide loop overhead, few enough to stay in the first
// cache.
inline constexpr int block_size = 64;

struct alignas(64) column {
  double values[block_size];
};

inline constexpr column zeros{};

// The nodes of a block: consecutive from first, or listed.
struct node_range {
  const std::int32_t* index;    // null: consecutive, or
  const std::int64_t* index64;  // in 64 bits
  std::int64_t first;           // position in the batch
  std::int32_t index_base;
  int count;

  bool listed() const { return index || index64; }
  std::int64_t node(int i) const {
    if (index64) return index64[first + i] - index_base;
    return index ? std::int64_t{index[first + i]} - index_base : first + i;
  }
};

// Asks for the same part of the next block while this one is worked on: hardware prefetchers lose the many
// streams of a batch at block boundaries.
inline void prefetch_next(const double* values, std::int64_t doubles) {
  for (std::int64_t k = 0; k < doubles; k += 8) __builtin_prefetch(values + doubles + k);
}

// Gives consecutive values of one component, in the host's array or in room.
inline const double* gather(const ilaw_input& input, int component, const node_range& nodes, double* room) {
  const double* values = input.values + component * input.component_stride;
  const std::int64_t stride = input.node_stride;
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
    return values;
  }
  for (int i = 0; i < count; ++i) room[i] = values[i * stride];
  return room;
}

// Gives the three components of a block of vectors; (3,n) arrays are transposed in one pass.
inline void gather_vector(const ilaw_input& input, int dimension, const node_range& nodes, column* room,
                          const double** components) {
  if (dimension == 3 && !nodes.listed() && input.node_stride == 3 && input.component_stride == 1) {
    const double* __restrict__ values = input.values + 3 * nodes.first;
    prefetch_next(values, 3 * nodes.count);
    double* __restrict__ a = room[0].values, * __restrict__ b = room[1].values, * __restrict__ c = room[2].values;
#pragma omp simd
    for (int i = 0; i < nodes.count; ++i) {
      a[i] = values[3 * i];
      b[i] = values[3 * i + 1];
      c[i] = values[3 * i + 2];
    }
    for (int k = 0; k < 3; ++k) components[k] = room[k].values;
    return;
  }
  for (int k = 0; k < 3; ++k)
    components[k] = k < dimension ? gather(input, k, nodes, room[k].values) : zeros.values;
}

// Where to write one component: in the host's array if it is consecutive, else in room, to be scattered.
inline double* target(const ilaw_output& output, int component, const node_range& nodes, double* room) {
  if (nodes.listed() || output.node_stride != 1) return room;
  return output.values + component * output.component_stride + nodes.first;
}

// Copies a component written to room to the host's array; nothing to do for what was written in place.
inline void scatter(const ilaw_output& output, int component, const node_range& nodes,
                    const double* written) {
  double* values = output.values + component * output.component_stride;
  const std::int64_t stride = output.node_stride;
  if (nodes.index) {
    const std::int32_t* index = nodes.index + nodes.first;
    for (int i = 0; i < nodes.count; ++i)
      values[(std::int64_t{index[i]} - nodes.index_base) * stride] = written[i];
    return;
  }
  if (nodes.index64) {
    for (int i = 0; i < nodes.count; ++i) values[nodes.node(i) * stride] = written[i];
    return;
  }
  values += nodes.first * stride;
  if (values == written) return;
  for (int i = 0; i < nodes.count; ++i) values[i * stride] = written[i];
}

inline void scatter_vector(const ilaw_output& output, int dimension, const node_range& nodes,
                           double* const* components) {
  if (dimension == 3 && !nodes.listed() && output.node_stride == 3 && output.component_stride == 1) {
    double* __restrict__ values = output.values + 3 * nodes.first;
    const double* __restrict__ a = components[0], * __restrict__ b = components[1], * __restrict__ c = components[2];
#pragma omp simd
    for (int i = 0; i < nodes.count; ++i) {
      values[3 * i] = a[i];
      values[3 * i + 1] = b[i];
      values[3 * i + 2] = c[i];
    }
    return;
  }
  for (int k = 0; k < dimension; ++k) scatter(output, k, nodes, components[k]);
}

}  // namespace ilaw::kit
