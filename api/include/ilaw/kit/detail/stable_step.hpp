// stable_step.hpp - the smallest stable step of a block's nodes, in vector code.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit/detail/kernel.hpp>
#include <ilaw/kit/pack.hpp>

namespace ilaw::kit::inline ILAW_KIT_LEVEL::detail {

template <class Law, class Delassus, class Frame, class Layout, scope Scope, class Form>
double stable_step_at(const Form& law, const node_block<Law>& b, int i) {
  auto node = load_node<Law, Delassus, Frame, Layout, Scope>(b, i);
  return law.stable_velocity_step(node);
}

// The smallest stable step of a block's good nodes, by the form that its loop ran with.
template <class Law, class Delassus, class Frame, class Layout, scope Scope, class Form>
[[gnu::noinline, gnu::flatten]] double least_stable_step(const Form& form, const node_block<Law>& b) {
  static_assert(block_size % pack_size == 0);
  const Form law = form;
  const node_block<Law> own = b;
  column steps;
  for (double& step : steps.values) step = infinity;
#pragma omp simd
  for (int i = 0; i < own.count; ++i) {
    const double step = stable_step_at<Law, Delassus, Frame, Layout, Scope>(law, own, i);
    steps.values[i] = own.refused[i] == 0.0 ? step : infinity;
  }
  pack least = infinity;
  for (int i = 0; i < block_size; i += pack_size) least = smaller(pack::load(steps.values + i), least);
  double smallest = infinity;
  for (int lane = 0; lane < pack_size; ++lane) smallest = smaller(least[lane], smallest);
  return smallest;
}

// A form that limits no step.
template <class Form>
concept always_stable = Form::is_always_stable;

}  // namespace ilaw::kit::detail
