// window_block.hpp - the windows of a block of nodes: read before the loop over it, written after it.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit/detail/block_copies.hpp>
#include <ilaw/kit/window.hpp>

namespace ilaw::kit::inline ILAW_KIT_LEVEL::detail {

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
