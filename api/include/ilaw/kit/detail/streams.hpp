// streams.hpp - arrays that are asked for before they are needed.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit/detail/level.hpp>

#include <cstdint>

namespace ilaw::kit::inline ILAW_KIT_LEVEL::detail {

// Arrays that a batch reads or writes node by node, asked for a block ahead and some nodes at a time, where
// some of them are copied: a copy wants many lines at once, which hardware prefetchers bring too late, and a
// processor that is asked for more lines than it can wait for (some 16) does nothing else until they are
// there. Where all is worked on in place, lines are wanted evenly, and come sooner if nobody asks.
class streams {
 public:
  static constexpr int nodes_at_once = 16;
  static constexpr std::int64_t fewest_nodes = 16384;  // fewer are in the second cache, or may as well be

  // An array, where few numbers of a node lie apart.
  template <class Number>
  void add(const Number* values, std::int64_t node_stride, std::int64_t component_stride, int numbers) {
    constexpr std::int64_t widest = 8;
    if (node_stride < 1 || node_stride > widest) return;
    const int parts = component_stride == 1 ? 1 : numbers;
    for (int k = 0; k < parts && count_ < most; ++k)
      streams_[count_++] = {reinterpret_cast<const char*>(values + k * component_stride),
                            node_stride * std::int64_t{sizeof(Number)}};
  }

  void ask(std::int64_t node) const {
    constexpr std::int64_t line = 64;
    for (int k = 0; k < count_; ++k) {
      const stream& s = streams_[k];
      const char* begin = s.values + node * s.bytes_of_node;
      for (std::int64_t at = 0; at < nodes_at_once * s.bytes_of_node; at += line)
        __builtin_prefetch(begin + at);
    }
  }

 private:
  struct stream {
    const char* values;
    std::int64_t bytes_of_node;
  };
  static constexpr int most = 24;
  stream streams_[most];
  int count_ = 0;
};

}  // namespace ilaw::kit::detail
