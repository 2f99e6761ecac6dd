// block_copies.hpp - arrays of a host, copied to columns of a block of nodes and back, and the windows of a
// block: read before the loop over it, written after it.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit/detail/load_store.hpp>
#include <ilaw/kit/window.hpp>

#include <ilaw/ilaw.h>

namespace ilaw::kit::inline ILAW_KIT_LEVEL::detail {

// The nodes of a part of a batch.
inline constexpr int block_nodes = 64;  // at most: their copies stay in the first cache
struct node_range {
  std::int64_t first, count;
  bool listed;
  std::int64_t where[block_nodes];

  node_range(const ilaw_batch& b, std::int64_t start, std::int64_t n)
      : first(start), count(n), listed(b.index || b.index64) {
    if (b.index64)
      for (std::int64_t i = 0; i < n; ++i) where[i] = b.index64[start + i] - b.index_base;
    else if (b.index)
      for (std::int64_t i = 0; i < n; ++i) where[i] = std::int64_t{b.index[start + i]} - b.index_base;
  }
  std::int64_t operator()(std::int64_t i) const { return listed ? where[i] : first + i; }
};

template <class T, class From>
[[gnu::noinline]] inline void gather_column(const From* values, std::int64_t stride, const node_range& n,
                                            T* to) {
  if (n.listed)
    for (std::int64_t i = 0; i < n.count; ++i) to[i] = static_cast<T>(values[n.where[i] * stride]);
  else
    for (std::int64_t i = 0; i < n.count; ++i) to[i] = static_cast<T>(values[(n.first + i) * stride]);
}
template <class T, class From>
[[gnu::noinline]] inline void scatter_column(T* values, std::int64_t stride, const node_range& n,
                                             const From* from) {
  if (n.listed)
    for (std::int64_t i = 0; i < n.count; ++i) values[n.where[i] * stride] = static_cast<T>(from[i]);
  else
    for (std::int64_t i = 0; i < n.count; ++i) values[(n.first + i) * stride] = static_cast<T>(from[i]);
}
// Rows of four numbers or more, four nodes by four numbers at a time; the last four may overlap the others.
using four = double __attribute__((vector_size(32)));
ILAW_KIT_INLINE void transpose(four (&m)[4]) {
  const four a = __builtin_shufflevector(m[0], m[1], 0, 4, 2, 6),
             b = __builtin_shufflevector(m[0], m[1], 1, 5, 3, 7),
             c = __builtin_shufflevector(m[2], m[3], 0, 4, 2, 6),
             d = __builtin_shufflevector(m[2], m[3], 1, 5, 3, 7);
  m[0] = __builtin_shufflevector(a, c, 0, 1, 4, 5);
  m[1] = __builtin_shufflevector(b, d, 0, 1, 4, 5);
  m[2] = __builtin_shufflevector(a, c, 2, 3, 6, 7);
  m[3] = __builtin_shufflevector(b, d, 2, 3, 6, 7);
}
[[gnu::noinline]] inline void gather_rows(const double* values, std::int64_t stride, int count,
                                          const node_range& n, double* to) {
  std::int64_t i = 0;
  for (; i + 4 <= n.count; i += 4) {
    const double* const at[4] = {values + n(i) * stride, values + n(i + 1) * stride,
                                 values + n(i + 2) * stride, values + n(i + 3) * stride};
    for (int c = 0; c < count; c += 4) {
      const int first = c + 4 <= count ? c : count - 4;
      four m[4];
#pragma GCC unroll 4
      for (int k = 0; k < 4; ++k) __builtin_memcpy(&m[k], at[k] + first, sizeof(four));
      transpose(m);
#pragma GCC unroll 4
      for (int k = 0; k < 4; ++k) __builtin_memcpy(to + (first + k) * block_nodes + i, &m[k], sizeof(four));
    }
  }
  for (; i < n.count; ++i)
    for (int c = 0; c < count; ++c) to[c * block_nodes + i] = values[n(i) * stride + c];
}
[[gnu::noinline]] inline void scatter_rows(double* values, std::int64_t stride, int count,
                                           const node_range& n, const double* from) {
  std::int64_t i = 0;
  for (; i + 4 <= n.count; i += 4) {
    double* const at[4] = {values + n(i) * stride, values + n(i + 1) * stride, values + n(i + 2) * stride,
                           values + n(i + 3) * stride};
    for (int c = 0; c < count; c += 4) {
      const int first = c + 4 <= count ? c : count - 4;
      four m[4];
#pragma GCC unroll 4
      for (int k = 0; k < 4; ++k) __builtin_memcpy(&m[k], from + (first + k) * block_nodes + i, sizeof(four));
      transpose(m);
#pragma GCC unroll 4
      for (int k = 0; k < 4; ++k) __builtin_memcpy(at[k] + first, &m[k], sizeof(four));
    }
  }
  for (; i < n.count; ++i)
    for (int c = 0; c < count; ++c) values[n(i) * stride + c] = from[c * block_nodes + i];
}
// Numbers side by side, of floats to doubles and back.
template <class From, class To>
[[gnu::noinline]] void convert(const From* from, To* to, std::int64_t count) {
  std::int64_t k = 0;
  for (; k + register_lanes <= count; k += register_lanes)
    put_one(narrowed<To>(widened(one_at(from + k))), to + k);
  for (; k < count; ++k) to[k] = static_cast<To>(from[k]);
}
// Components that lie in other lines of memory: node by node.
template <class T, class From>
[[gnu::noinline]] inline void gather_three(const From* values, std::int64_t stride, std::int64_t component,
                                           const node_range& n, T* to) {
  for (std::int64_t i = 0; i < n.count; ++i) {
    const From* const at = values + n(i) * stride;
    to[i] = static_cast<T>(at[0]);
    to[block_nodes + i] = static_cast<T>(at[component]);
    to[2 * block_nodes + i] = static_cast<T>(at[2 * component]);
  }
}
template <class T, class From>
[[gnu::noinline]] inline void scatter_three(T* values, std::int64_t stride, std::int64_t component,
                                            const node_range& n, const From* from) {
  for (std::int64_t i = 0; i < n.count; ++i) {
    T* const at = values + n(i) * stride;
    at[0] = static_cast<T>(from[i]);
    at[component] = static_cast<T>(from[block_nodes + i]);
    at[2 * component] = static_cast<T>(from[2 * block_nodes + i]);
  }
}

struct window_block {
  alignas(64) double earlier[3][block_nodes], refused[block_nodes];
  alignas(64) double given[3][block_nodes], adds[block_nodes], clears[block_nodes];
};
// Where the windows of a block stand: that of the first node, the strides, and the nodes where they are
// listed.
struct window_place {
  double* first;
  std::int64_t node_stride, component_stride, count;
  const std::int64_t* nodes;

  // Calls work with the windows of each pack of nodes; lanes without a node have that of the last one.
  template <class Work>
  ILAW_KIT_INLINE void for_packs(Work work) const {
    constexpr int lanes = lanes_of<pack>;
    for (std::int64_t i = 0; i < count; i += lanes) {
      if (node_stride == 1 && !nodes && i + lanes <= count) {
        work(i, window_columns<pack>{first + i, component_stride});
      } else {
        window_rows own;
        own.stride = component_stride;
        const std::int64_t last = count - 1 - i;
#pragma GCC unroll 8
        for (int lane = 0; lane < lanes; ++lane) {
          const std::int64_t k = i + (lane < last ? lane : last);
          own.first[lane] = first + (nodes ? nodes[k] : k) * node_stride;
        }
        work(i, own);
      }
    }
  }
};
[[gnu::noinline, gnu::flatten]] inline void read_windows(const window& w, const window_place& place,
                                                         window_block& block) {
  place.for_packs([&](std::int64_t i, const auto& own) {
    vector<pack> sum;
    store(w.read(own, sum), block.refused + i);
    store(sum.n, block.earlier[0] + i);
    store(sum.t1, block.earlier[1] + i);
    store(sum.t2, block.earlier[2] + i);
  });
}
[[gnu::noinline, gnu::flatten]] inline void write_windows(const window& w, const window_place& place,
                                                          window_block& block) {
  for (std::int64_t i = place.count; i % lanes_of<pack> != 0; ++i) block.adds[i] = block.clears[i] = 0.0;
  place.for_packs([&](std::int64_t i, const auto& own) {
    const vector<pack> impulse{load<pack>(block.given[0] + i), load<pack>(block.given[1] + i),
                               load<pack>(block.given[2] + i)};
    w.write(own, load<pack>(block.clears + i) != 0.0, load<pack>(block.adds + i) != 0.0, impulse);
  });
}

}  // namespace ilaw::kit::detail
