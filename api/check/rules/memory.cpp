// Rules: which memory evaluate and initialise read and write.
// SPDX-License-Identifier: BSD-3-Clause
#include "check/rule.hpp"

#include <algorithm>
#include <cmath>

namespace ilaw::check {
namespace {

using Flush = GuardedPages::Flush;

// A fault ends the process, and is the finding of the rule.
Judge between_guards(Use guarded, std::uint32_t outputs) {
  return on_trials_per_node_too([=](const Trial& trial, Draw& draw) {
    const Script script = draw_script(trial, draw, {13, 2});
    for (const Flush flush : {Flush::with_the_end, Flush::with_the_beginning})
      for (const Layout& layout :
           {Layout{.outputs = outputs},
            Layout{.order = Order::spread, .list = List::of_32_bits, .outputs = outputs},
            Layout{.order = Order::by_component, .list = List::of_64_bits, .outputs = outputs}}) {
        GuardedPages pages(flush, guarded);
        run(trial, script, layout, &pages);
      }
    return true;
  });
}

bool beside(const Trial& trial, Draw& draw) {
  const Script script = draw_script(trial, draw, {13, 2});
  for (const List list : {List::none, List::of_32_bits, List::of_64_bits}) {
    const Layout layout{.order = Order::spread, .list = list, .spare = list == List::none ? 0U : 6U};
    Started arrays(trial, script[0], layout);
    for (const Inputs& in : script) {
      arrays.evaluate(in);
      if (const char* name = arrays.written_beside())
        fail(trial, in, 0, joined("the array ", name, " was written where no node of the batch is"),
             "outputs of the nodes of the batch");
    }
  }
  return true;
}

// Outputs that begin as one number or another end the same.
bool all_written(const Trial& trial, Draw& draw) {
  const Script script = draw_script(trial, draw, {11, 3});
  for (const Results& found : run(trial, script)) {
    const auto expect = [&](const char* array, const auto& values, auto unwritten) {
      if (std::find(values.begin(), values.end(), unwritten) != values.end())
        fail(trial, script[0], 0, joined("the array ", array, " was not written at all nodes"),
             "every component of every node of the batch");
    };
    for (const Results::Numbers& array : found.numbers()) expect(array.name, *array.values, sentinel);
    expect("status", found.status, status_sentinel);
  }
  return true;
}

// initialise reads no state and no motion, so that the rest of the batch may be zero.
bool initialise_reads(const Trial& trial, Draw& draw) {
  if (trial.info.state_size == 0) return false;
  const Script script = draw_script(trial, draw, {6, 1});
  Arrays arrays(trial, script[0]);
  if (arrays.initialise(script[0]) < 0) return false;
  const std::vector<double> expected = arrays.state();
  ilaw_batch& batch = arrays.batch();
  for (ilaw_input* one : {&batch.v_free, &batch.v_smooth, &batch.delassus, &batch.gap, &batch.gap_offset,
                          &batch.v_previous, &batch.state_in, &batch.spin_free, &batch.spin_previous})
    *one = {};
  for (ilaw_output* one : {&batch.impulse, &batch.velocity, &batch.energy, &batch.moment, &batch.spin})
    *one = {};
  batch.status = nullptr;
  batch.amounts = nullptr;
  batch.velocity_step = batch.position_step = 0.0;
  arrays.set_state(std::vector<double>(expected.size(), std::nan("")));
  const std::int32_t code = trial.instance.initialise(batch, nullptr);
  const std::vector<double> found = arrays.state();
  for (std::size_t k = 0; k < found.size(); ++k)
    if (code < 0 || !(found[k] == expected[k]))
      fail(trial, script[0], k / trial.info.state_size,
           joined("with the rest of the batch zero initialise returned ", code, " and wrote state ", found[k],
                  ", else ", expected[k]),
           "the same first state");
  return true;
}

}  // namespace

std::vector<Rule> memory_rules() {
  return {{"memory-reads", "No input is read outside the nodes of the batch, and none is written.",
           "ilaw.h, ilaw_batch", between_guards(Use::input, all_outputs)},
          {"memory-writes", "No output is written, or read, outside the nodes of the batch.",
           "ilaw.h, ilaw_batch", between_guards(Use::output, all_outputs)},
          {"memory-unneeded", "An array that the instance does not ask for is not read.",
           "ilaw.h, ilaw_instance_info.inputs", between_guards(Use::unneeded, ILAW_OUTPUT_VELOCITY)},
          {"memory-beside", "Nothing is written between strides, nor at nodes that are on no list.",
           "ilaw.h, ilaw_batch.index", on_trials_per_node_too(beside)},
          {"outputs-written", "Every output that is asked for is written at every node.", "abi.md, Outputs",
           on_trials(all_written)},
          {"initialise-reads", "initialise reads times, areas, axes and parameters per node alone.",
           "ilaw.h, ilaw_law.initialise", on_trials(initialise_reads, "the law has no state")}};
}

}  // namespace ilaw::check
