// run_block.hpp - a block of nodes from end to end: the windows of its law are read before its steps, and
// written after them.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit/detail/run_steps.hpp>
#include <ilaw/kit/detail/window_block.hpp>

namespace ilaw::kit::inline ILAW_KIT_LEVEL::detail {

// What a block keeps between its windows and its steps.
struct window_columns {
  window_block::block_reading earlier;
  given_impulses given;
  column reached;
};

// The law's window at node i, in the step of a block.
template <class Laws, class Law>
window_in_step window_at(const Laws& laws, const node_block<Law>& b, int i) {
  return laws.at(i).window_in(interval_of(b));
}
template <class Law>
histories histories_of(const node_block<Law>& b) {
  return {b.history_values, b.history_node_stride, b.history_component_stride, b.history_nodes};
}

// The windows of laws that forget stay zero.
template <class Law>
void aim_at(window_columns& kept, node_block<Law>& b, bool forgets) {
  for (int c = 0; c < 3; ++c) {
    if (!forgets) b.earlier[c] = kept.earlier.sum[c].values;
    b.given[c] = kept.given.impulse[c].values;
  }
  if (!forgets) b.earlier_refused = kept.earlier.refused.values;
  b.reached = kept.reached.values;
}

template <class Form, class Law>
void read_window(const Form& law, const node_block<Law>& b, int i, window_columns& kept) {
  const window_in_step::reading earlier =
      law.window_in(interval_of(b)).before(const_history(b.history_of(i)));
  kept.earlier.sum[0].values[i] = earlier.sum.n;
  kept.earlier.sum[1].values[i] = earlier.sum.t1;
  kept.earlier.sum[2].values[i] = earlier.sum.t2;
  kept.earlier.refused.values[i] = earlier.refused;
}

// The windows of a block before its steps. Parameters per node may give each node another window; else all
// have that of the first.
template <class Law, class Laws>
void read_windows(const Laws& laws, const node_block<Law>& b, const window_block& first,
                  window_columns& kept) {
  if constexpr (is_one_law<Laws>) {
    first.before(histories_of(b), b.count, kept.earlier);
  } else {
    for (int i = 0; i < b.count; ++i) read_window(laws.at(i), b, i, kept);
  }
}

template <class Law, class Laws>
void write_windows(const Laws& laws, const node_block<Law>& block, const window_block& first,
                   window_columns& kept) {
  const node_block<Law> b = block;  // a copy, so that no store can alias it
  given_impulses& given = kept.given;
#pragma omp simd
  for (int i = 0; i < b.count; ++i) {
    const bool good = b.refused[i] == 0.0;
    const double status = kept.reached.values[i];
    given.adds.values[i] = (good & Law::adds_to_window(status)) ? 1.0 : 0.0;
    given.clears.values[i] = (good & Law::clears_window(status)) ? 1.0 : 0.0;
  }
  if constexpr (is_one_law<Laws>) {
    first.add(histories_of(b), b.count, given, kept.earlier);
  } else {
    for (int i = 0; i < b.count; ++i) {
      const window_in_step window = window_at(laws, b, i);
      if (given.clears.values[i] != 0.0) window.clear(b.history_of(i));
      if (given.adds.values[i] != 0.0)
        window.add(b.history_of(i),
                   {given.impulse[0].values[i], given.impulse[1].values[i], given.impulse[2].values[i]});
    }
  }
}

// A window is read before the loops over a block and written after them, so that they need not work node by
// node.
template <class Law, class Delassus, class Frame, class Layout, scope Scope, class Laws>
int run_block(const Laws& laws, const node_block<Law>& b) {
  if constexpr (has_window<Law>) {
    window_columns kept;
    node_block<Law> own = b;
    const window_block first(window_at(laws, b, 0));
    const bool forgets = is_one_law<Laws> && first.forgets();
    aim_at(kept, own, forgets);
    if (!forgets) read_windows(laws, own, first, kept);
    const int one_by_one = run_steps<Law, Delassus, Frame, Layout, Scope>(laws, own);
    if (!forgets) write_windows(laws, own, first, kept);
    return one_by_one;
  } else {
    return run_steps<Law, Delassus, Frame, Layout, Scope>(laws, b);
  }
}

// A block for a node that is looked at alone, after the block was run.
template <class Law>
struct block_of_one : node_block<Law> {
  window_columns kept;

  block_of_one(const Law& law, const node_block<Law>& b, int i) : node_block<Law>(b) {
    if constexpr (has_window<Law>) {
      read_window(law, b, i, kept);
      aim_at(kept, static_cast<node_block<Law>&>(*this), false);
    }
  }
};

}  // namespace ilaw::kit::detail
