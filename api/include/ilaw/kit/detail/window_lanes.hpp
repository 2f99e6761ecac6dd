// window_lanes.hpp - what the windows of a block of nodes (window_block.hpp) are worked on by: registers of
// doubles, vectors of them, and lists of nodes.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit/detail/gather.hpp>
#include <ilaw/kit/node.hpp>

#include <cstdint>

namespace ilaw::kit::inline ILAW_KIT_LEVEL::detail {

using lane_mask = register_mask;

// Of a double, or of a register of them.
template <class V>
V down_scale_of(V largest) {
  return power_scale_of(largest).down;
}

// Three numbers of as many nodes as a register holds. A pack (pack.hpp) is two, which these short loops would
// pass through memory.
struct lane_vector {
  lanes n, t1, t2;

  static lane_vector at(const column* c, int i) {
    return {lanes_at(c[0].values + i), lanes_at(c[1].values + i), lanes_at(c[2].values + i)};
  }
  void put(column* c, int i) const {
    put_lanes(n, c[0].values + i);
    put_lanes(t1, c[1].values + i);
    put_lanes(t2, c[2].values + i);
  }
  friend lane_vector operator+(const lane_vector& a, const lane_vector& b) {
    return {a.n + b.n, a.t1 + b.t1, a.t2 + b.t2};
  }
  friend lane_vector operator-(const lane_vector& a, const lane_vector& b) {
    return {a.n - b.n, a.t1 - b.t1, a.t2 - b.t2};
  }
  friend lane_vector operator*(double s, const lane_vector& a) { return {s * a.n, s * a.t1, s * a.t2}; }
  friend lane_vector select(lane_mask m, const lane_vector& a, const lane_vector& b) {
    return {m ? a.n : b.n, m ? a.t1 : b.t1, m ? a.t2 : b.t2};
  }
  lane_mask is_there() const { return (n != 0.0) | (t1 != 0.0) | (t2 != 0.0); }
};

// Nodes that are marked.
struct marks {
  alignas(64) std::int64_t of[block_size];

  void put(lane_mask m, int i) { __builtin_memcpy(of + i, &m, sizeof m); }
  int list(int count, int* nodes) const {
    int found = 0;
    for (int i = 0; i < count; ++i) {
      nodes[found] = i;
      found -= static_cast<int>(of[i]);
    }
    return found;
  }
};
}  // namespace ilaw::kit::detail
