// stable_step.hpp - the smallest stable step of a block's nodes, in vector code.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/kit/detail/kernel.hpp>
#include <ilaw/kit/pack.hpp>

namespace ilaw::kit::inline ILAW_KIT_LEVEL::detail {

// Whether a form's stable step follows from one number of a node, and never grows with it: then the largest
// says all, and one root and division do for a block.
template <class Form, class Node>
concept falls_with_one_number = requires(const Form& form, const Node& node) {
  form.stable_step_at(form.step_falls_with(node));
};

// What is the smallest at the node with the smallest stable step.
template <class Law, class Delassus, class Frame, class Layout, scope Scope, class Form>
double rank_of_step(const Form& law, const node_block<Law>& b, int i) {
  auto node = load_node<Law, Delassus, Frame, Layout, Scope>(b, i);
  if constexpr (falls_with_one_number<Form, decltype(node)>)
    return -law.step_falls_with(node);
  else
    return law.stable_velocity_step(node);
}

// The smallest stable step of a block's good nodes, by the form that its loop ran with.
template <class Law, class Delassus, class Frame, class Layout, scope Scope, class Form>
[[gnu::noinline, gnu::flatten]] double least_stable_step(const Form& form, const node_block<Law>& b) {
  const Form law = form;
  const node_block<Law> own = b;
  column ranks;
  for (int i = own.count; i < in_whole_packs(own.count); ++i) ranks.values[i] = infinity;
#pragma omp simd
  for (int i = 0; i < own.count; ++i) {
    const double rank = rank_of_step<Law, Delassus, Frame, Layout, Scope>(law, own, i);
    ranks.values[i] = own.refused[i] == 0.0 ? rank : infinity;
  }
  pack least = infinity;
  for (int i = 0; i < own.count; i += pack_size) least = smaller(pack::load(ranks.values + i), least);
  double smallest = infinity;
  for (int lane = 0; lane < pack_size; ++lane) smallest = smaller(least[lane], smallest);
  if constexpr (falls_with_one_number<Form, node_in<Law, Delassus, Frame>>)
    return smallest < infinity ? law.stable_step_at(-smallest) : infinity;
  return smallest;
}

// A form that limits no step.
template <class Form>
concept always_stable = Form::is_always_stable;

}  // namespace ilaw::kit::detail
