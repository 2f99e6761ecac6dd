// Rules: a result at a node does not depend on how the batch is laid out, nor on the other nodes in it.
// SPDX-License-Identifier: BSD-3-Clause
#include "check/rule.hpp"

#include <algorithm>
#include <cmath>

namespace ilaw::check {
namespace {

struct NamedLayout {
  const char* how;
  Layout layout;
};

bool any(const Trial&) { return true; }

// The script in each layout gives the bits of the plain one, in the outputs that it asks for.
Judge in_layouts(const std::vector<NamedLayout>& layouts, bool (*applies)(const Trial& trial) = any,
                 const char* otherwise = "the law accepted no parameters", const Layout& plain = {}) {
  return on_trials_per_node_too(
      [=](const Trial& trial, Draw& draw) {
        if (!applies(trial)) return false;
        const Script script = draw_script(trial, draw);
        const std::vector<Results> expected = run(trial, script, plain);
        for (const auto& [how, layout] : layouts)
          expect_same(trial, script, expected, run(trial, script, layout), how, layout.outputs);
        return true;
      },
      otherwise);
}

// From base 0 and 1.
Judge in_lists(const char* how, List list) {
  return in_layouts({{how, {.list = list, .index_base = 0, .spare = 4}},
                     {how, {.list = list, .index_base = 1, .spare = 4}}});
}

bool has_state(const Trial& trial) { return trial.info.state_size > 0; }
bool leaves_smooth_unasked(const Trial& trial) { return !trial.reads(ILAW_INPUT_V_SMOOTH); }

bool order(const Trial& trial, Draw& draw) {
  const Script script = draw_script(trial, draw);
  std::vector<std::size_t> nodes = numbers_below(script[0].count);
  std::reverse(nodes.begin(), nodes.end());
  expect_part(trial, script, run(trial, script), nodes, "in reverse order");
  std::rotate(nodes.begin(), nodes.begin() + static_cast<std::ptrdiff_t>(nodes.size() / 2), nodes.end());
  expect_part(trial, script, run(trial, script), nodes, "in another order");
  return true;
}

bool parts(const Trial& trial, Draw& draw) {
  const Script script = draw_script(trial, draw, {13, 3, true});
  const std::vector<Results> all = run(trial, script);
  for (std::size_t i = 0; i < 4; ++i) expect_part(trial, script, all, {3 * i}, "alone");
  expect_part(trial, script, all, {1, 2, 4, 5, 7, 8, 10}, "in a part of the batch");
  return true;
}

// Many nodes take other loops than few.
bool large_batch(const Trial& trial, Draw& draw) {
  const Script script = draw_script(trial, draw, {300, 1, true});
  const std::vector<Results> all = run(trial, script);
  for (const std::size_t i : {std::size_t{0}, std::size_t{65}, std::size_t{150}, std::size_t{299}})
    expect_part(trial, script, all, {i}, "alone");
  return true;
}

bool amounts(const Trial& trial, Draw& draw) {
  const Script script = draw_script(trial, draw);
  const std::vector<Results> all = run(trial, script);
  for (std::size_t k = 0; k < trial.info.amount_count; ++k)
    expect_same(trial, script, all, run(trial, script, {.no_amount = k}), "with one amount absent");
  if (trial.info.amount_count > 0)
    expect_same(trial, script, all, run(trial, script, {.outputs = amounts_output}), "with amounts alone",
                amounts_output);
  return trial.info.amount_count > 0;
}

// One value for all nodes, by a stride of 0: nothing else is there to be read.
bool shared_value(const Trial& trial, Draw& draw) {
  Inputs in = draw_script(trial, draw, {5, 1})[0], first_alone = in;
  for (const auto array : {&Inputs::delassus, &Inputs::area, &Inputs::normal, &Inputs::tangent}) {
    std::vector<double>&values = in.*array, &alone = first_alone.*array;
    const std::size_t width = values.size() / in.count;
    for (std::size_t k = width; k < values.size(); ++k) {
      values[k] = values[k - width];
      alone[k] = std::nan("");
    }
  }
  Started arrays(trial, in);
  Arrays others(trial, first_alone);
  const Results expected = arrays.evaluate(in);
  ilaw_batch& batch = others.batch();
  for (ilaw_input* one : {&batch.delassus, &batch.area, &batch.normal, &batch.tangent}) one->node_stride = 0;
  others.initialise(first_alone);
  if (const auto differs = difference(expected, others.evaluate(first_alone)))
    fail(trial, in, differs->node, joined("with node_stride 0 for H, area and axes: ", differs->text),
         "the same bits");
  return true;
}

bool gap_offset(const Trial& trial, Draw& draw) {
  if (!trial.reads(ILAW_INPUT_GAP)) return false;
  Script script = draw_script(trial, draw), without = script;
  for (std::size_t k = 0; k < script.size(); ++k) {
    for (std::size_t i = 0; i < script[k].count; ++i) {
      // No float is the difference of some two.
      if (trial.setup.rounded(script[k].slack(i)) != script[k].slack(i)) script[k].gap_offset[i] = 0.0;
      without[k].gap[i] = script[k].slack(i);
    }
    without[k].gap_offset.clear();
  }
  expect_same(trial, script, run(trial, without), run(trial, script),
              "with gap_offset instead of its difference");
  return true;
}

bool floats_rounded(const Trial& trial, Draw& draw) {
  Setup doubles = trial.setup;
  doubles.numbers = ILAW_NUMBERS_DOUBLE;
  if (!trial.setup.floats() || !(trial.law.numbers & ILAW_NUMBERS_DOUBLE) ||
      !create(trial.law, doubles, trial.values))
    return false;
  const Trial exact(trial.law, doubles, trial.values);
  if (exact.info.state_size != trial.info.state_size || exact.info.state_version != trial.info.state_version)
    fail(trial, "the number type changes the size or the version of the state", "the same state");
  const Script script = draw_script(trial, draw);
  const std::vector<Results> all = run(exact, script), found = run(trial, script);
  for (std::size_t k = 0; k < script.size(); ++k) {
    Results rounded = all[k];
    for (const OutputArray& array : output_arrays)
      for (double& value : rounded.*array.values)
        if (array.values != &Results::state) value = trial.setup.rounded(value);
    for (std::vector<double>& amount : rounded.amounts)
      for (double& value : amount) value = trial.setup.rounded(value);
    if (const auto differs = difference(rounded, found[k]))
      fail(trial, script[k], differs->node, joined("in floats ", differs->text),
           "as in doubles, rounded once");
  }
  return true;
}

}  // namespace

std::vector<Rule> independence_rules() {
  constexpr const char* alone = "ilaw.h, ilaw_law.evaluate";
  return {
      {"layout-components", "Arrays component by component give the same bits.", "ilaw.h, ilaw_input",
       in_layouts(
           {{"component by component", {.order = Order::by_component}},
            {"with state_out alone component by component", {.order_of_state_out = Order::by_component}},
            {"component by component but for state_out",
             {.order = Order::by_component, .order_of_state_out = Order::interleaved}}})},
      {"layout-strides", "Arrays with any strides give the same bits.", "ilaw.h, ilaw_input",
       in_layouts({{"with strides of 2 and more", {.order = Order::spread}},
                   {"with negative strides", {.order = Order::backward}},
                   {"with strides of state_out alone", {.order_of_state_out = Order::spread}},
                   {"with negative strides of all but state_out",
                    {.order = Order::backward, .order_of_state_out = Order::interleaved}}})},
      {"layout-shared", "A node stride of 0 gives all nodes the same value.", "ilaw.h, ilaw_input",
       on_trials_per_node_too(shared_value)},
      {"index-32", "A list of nodes in 32 bits gives the same bits, from base 0 and 1.",
       "ilaw.h, ilaw_batch.index", in_lists("by a list of 32 bits", List::of_32_bits)},
      {"index-64", "A list of nodes in 64 bits gives the same bits, from base 0 and 1.",
       "ilaw.h, ilaw_batch.index64", in_lists("by a list of 64 bits", List::of_64_bits)},
      {"state-in-place", "state_out may be the array of state_in.", "ilaw.h, ilaw_batch.state_out",
       in_layouts({{"with state_out as state_in", {.in_place = true}}}, has_state, "the law has no state")},
      {"batch-order", "The order of the nodes changes no bit.", alone, on_trials_per_node_too(order)},
      {"batch-parts", "A node gets the same bits alone as among others.", alone,
       on_trials_per_node_too(parts)},
      {"batch-large", "A node gets the same bits among hundreds as alone.", alone,
       on_trials_per_node_too(large_batch)},
      {"outputs-asked", "Which outputs are asked for changes no bit of the others.", alone,
       in_layouts({{"without optional outputs", {.outputs = 0}},
                   {"with the velocity alone", {.outputs = ILAW_OUTPUT_VELOCITY}},
                   {"with the status alone", {.outputs = ILAW_OUTPUT_STATUS}},
                   {"with the energy alone", {.outputs = ILAW_OUTPUT_ENERGY}},
                   {"with the spin alone", {.outputs = spin_output}},
                   {"without amounts", {.outputs = all_outputs & ~amounts_output}}})},
      {"amounts-asked", "Which amounts are asked for changes no bit of the other results.",
       "ilaw.h, ilaw_batch.amounts", on_trials_per_node_too(amounts, "the law has no amounts")},
      {"floats-rounded", "A float result is the double result rounded once; status and state are the same.",
       "ilaw.h, ILAW_NUMBERS_DOUBLE",
       on_trials_per_node_too(floats_rounded, "the law does not serve both number types")},
      {"smooth-unasked", "v_smooth changes no bit of an instance that does not ask for it.",
       "ilaw.h, ILAW_INPUT_V_SMOOTH",
       in_layouts({{"with a v_smooth of 123456.75", {}}}, leaves_smooth_unasked,
                  "every instance of the law asks for v_smooth", {.unasked = false})},
      {"gap-offset", "gap_offset is subtracted from the gap.", "ilaw.h, ilaw_batch.gap_offset",
       on_trials_per_node_too(gap_offset, "the law reads no gap")}};
}

}  // namespace ilaw::check
