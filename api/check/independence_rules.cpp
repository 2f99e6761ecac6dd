// Rules: a result at a node does not depend on how the batch is laid out, nor on the other nodes in it.
// SPDX-License-Identifier: BSD-3-Clause
#include "check/rule.hpp"

#include <algorithm>
#include <cmath>

namespace ilaw::check {
namespace {

// The script in this layout gives the bits of the plain one.
void in_layout(
    const Subject& subject, const Layout& layout, const char* how,
    bool (*applies)(const Trial& trial) = [](const Trial&) { return true; },
    const char* otherwise = "the law accepted no parameters", const Layout& plain = {}) {
  for_trials_per_node_too(
      subject,
      [&](const Trial& trial, Draw& draw) {
        if (!applies(trial)) return false;
        const Script script = draw_script(trial, draw);
        expect_same(trial, script, run(trial, script, plain), run(trial, script, layout), how);
        return true;
      },
      otherwise);
}

void by_component(const Subject& subject) {
  in_layout(subject, {.order = Order::by_component}, "component by component");
}
void spread(const Subject& subject) {
  in_layout(subject, {.order = Order::spread}, "with strides of 2 and more");
  in_layout(subject, {.order = Order::backward}, "with negative strides");
}
void list_32(const Subject& subject) {
  for (const std::int32_t base : {0, 1})
    in_layout(subject, {.list = List::of_32_bits, .index_base = base, .spare = 4}, "by a list of 32 bits");
}
void list_64(const Subject& subject) {
  for (const std::int32_t base : {0, 1})
    in_layout(subject, {.list = List::of_64_bits, .index_base = base, .spare = 4}, "by a list of 64 bits");
}
void in_place(const Subject& subject) {
  in_layout(
      subject, {.in_place = true}, "with state_out as state_in",
      [](const Trial& trial) { return trial.info.state_size > 0; }, "the law has no state");
}

void order(const Subject& subject) {
  for_trials_per_node_too(subject, [](const Trial& trial, Draw& draw) {
    const Script script = draw_script(trial, draw);
    std::vector<std::size_t> nodes = numbers_below(script[0].count);
    std::reverse(nodes.begin(), nodes.end());
    expect_part(trial, script, run(trial, script), nodes, "in reverse order");
    std::rotate(nodes.begin(), nodes.begin() + static_cast<std::ptrdiff_t>(nodes.size() / 2), nodes.end());
    expect_part(trial, script, run(trial, script), nodes, "in another order");
    return true;
  });
}

void parts(const Subject& subject) {
  for_trials_per_node_too(subject, [](const Trial& trial, Draw& draw) {
    const Script script = draw_script(trial, draw, {13, 3, true});
    const std::vector<Results> all = run(trial, script);
    for (std::size_t i = 0; i < 4; ++i) expect_part(trial, script, all, {3 * i}, "alone");
    expect_part(trial, script, all, {1, 2, 4, 5, 7, 8, 10}, "in a part of the batch");
    return true;
  });
}

// Many nodes take other loops than few.
void large_batch(const Subject& subject) {
  for_trials_per_node_too(subject, [](const Trial& trial, Draw& draw) {
    const Script script = draw_script(trial, draw, {300, 1, true});
    const std::vector<Results> all = run(trial, script);
    for (const std::size_t i : {std::size_t{0}, std::size_t{65}, std::size_t{150}, std::size_t{299}})
      expect_part(trial, script, all, {i}, "alone");
    return true;
  });
}

void outputs(const Subject& subject) {
  for_trials_per_node_too(subject, [](const Trial& trial, Draw& draw) {
    const Script script = draw_script(trial, draw);
    const std::vector<Results> all = run(trial, script);
    for (const std::uint32_t asked :
         {0U, std::uint32_t{ILAW_OUTPUT_VELOCITY}, std::uint32_t{ILAW_OUTPUT_STATUS},
          std::uint32_t{ILAW_OUTPUT_ENERGY}, all_outputs & ~amounts_output})
      expect_same(trial, script, all, run(trial, script, {.outputs = asked}),
                  asked == 0 ? "without optional outputs" : "with fewer optional outputs", asked);
    if (trial.setup.spins())
      expect_same(trial, script, all, run(trial, script, {.outputs = spin_output}),
                  "with spins as the only optional output", spin_output);
    return true;
  });
}

void amounts(const Subject& subject) {
  for_trials_per_node_too(
      subject,
      [](const Trial& trial, Draw& draw) {
        const Script script = draw_script(trial, draw);
        const std::vector<Results> all = run(trial, script);
        for (std::size_t k = 0; k < trial.info.amount_count; ++k)
          expect_same(trial, script, all, run(trial, script, {.no_amount = k}), "with one amount absent");
        if (trial.info.amount_count > 0)
          expect_same(trial, script, all, run(trial, script, {.outputs = amounts_output}),
                      "with amounts alone", amounts_output);
        return trial.info.amount_count > 0;
      },
      "the law has no amounts");
}

// One value for all nodes, by a stride of 0: nothing else is there to be read.
void shared_value(const Subject& subject) {
  constexpr std::vector<double> Inputs::*shared[] = {&Inputs::delassus, &Inputs::area, &Inputs::normal,
                                                     &Inputs::tangent};
  for_trials_per_node_too(subject, [&](const Trial& trial, Draw& draw) {
    Inputs in = draw_script(trial, draw, {5, 1})[0];
    Inputs first_alone = in;
    for (const auto array : shared) {
      std::vector<double>&values = in.*array, &alone = first_alone.*array;
      const std::size_t width = values.size() / in.count;
      for (std::size_t k = width; k < values.size(); ++k) {
        values[k] = values[k - width];
        alone[k] = std::nan("");
      }
    }
    Heap heap;
    Arrays arrays(trial, in, {}, heap), others(trial, first_alone, {}, heap);
    arrays.initialise(in);
    const Results expected = arrays.evaluate(in);
    ilaw_batch& batch = others.batch();
    for (ilaw_input* one : {&batch.delassus, &batch.area, &batch.normal, &batch.tangent})
      one->node_stride = 0;
    others.initialise(first_alone);
    if (const auto differs = difference(expected, others.evaluate(first_alone)))
      fail(trial, in, differs->node, "with node_stride 0 for H, area and axes: " + differs->text,
           "the same bits");
    return true;
  });
}

// A host of coupled contacts may give it to all of its laws.
void smooth_unasked(const Subject& subject) {
  in_layout(subject, {}, "with a v_smooth of 123456.75",
            [](const Trial& trial) { return !trial.reads(ILAW_INPUT_V_SMOOTH); },
            "every instance of the law asks for v_smooth", {.unasked = false});
}

void gap_offset(const Subject& subject) {
  for_trials_per_node_too(
      subject,
      [](const Trial& trial, Draw& draw) {
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
      },
      "the law reads no gap");
}

// Each number of "found", of floats, is that of "exact" rounded once.
void expect_rounded(const Trial& trial, const Inputs& in, const char* array, const std::vector<double>& exact,
                    const std::vector<double>& found) {
  for (std::size_t k = 0; k < exact.size(); ++k)
    if (!same_bits(trial.setup.rounded(exact[k]), found[k]))
      fail(trial, in, k / (exact.size() / in.count),
           std::string("in floats ") + array + " " + text_of(found[k]) + ", in doubles " + text_of(exact[k]),
           "the double rounded once, " + text_of(trial.setup.rounded(exact[k])));
}

void floats_rounded(const Subject& subject) {
  for_trials_per_node_too(
      subject,
      [](const Trial& trial, Draw& draw) {
        Setup doubles = trial.setup;
        doubles.numbers = ILAW_NUMBERS_DOUBLE;
        if (!trial.setup.floats() || !(trial.law.numbers & ILAW_NUMBERS_DOUBLE) ||
            !create(trial.law, doubles, trial.values))
          return false;
        const Trial exact(trial.law, doubles, trial.values);
        if (exact.info.state_size != trial.info.state_size ||
            exact.info.state_version != trial.info.state_version)
          fail(trial, "the number type changes the size or the version of the state", "the same state");
        const Script script = draw_script(trial, draw);
        const std::vector<Results> all = run(exact, script), found = run(trial, script);
        for (std::size_t k = 0; k < script.size(); ++k) {
          Results expected = all[k], narrow = found[k];
          expect_rounded(trial, script[k], "impulse", expected.impulse, narrow.impulse);
          expect_rounded(trial, script[k], "velocity", expected.velocity, narrow.velocity);
          expect_rounded(trial, script[k], "moment", expected.moment, narrow.moment);
          expect_rounded(trial, script[k], "spin", expected.spin, narrow.spin);
          expect_rounded(trial, script[k], "energy", expected.energy, narrow.energy);
          for (std::size_t a = 0; a < expected.amounts.size(); ++a)
            expect_rounded(trial, script[k], "amount", expected.amounts[a], narrow.amounts[a]);
          narrow.impulse = expected.impulse;
          narrow.moment = expected.moment;
          if (const auto differs = difference(expected, narrow, ILAW_OUTPUT_STATUS))
            fail(trial, script[k], differs->node, "in floats " + differs->text, "as in doubles");
        }
        return true;
      },
      "the law does not serve both number types");
}

}  // namespace

std::vector<Rule> independence_rules() {
  constexpr const char* alone = "ilaw.h, ilaw_law.evaluate";
  return {
      {"layout-components", "Arrays component by component give the same bits.", "ilaw.h, ilaw_input",
       Needs::motion, by_component},
      {"layout-strides", "Arrays with any strides give the same bits.", "ilaw.h, ilaw_input", Needs::motion,
       spread},
      {"layout-shared", "A node stride of 0 gives all nodes the same value.", "ilaw.h, ilaw_input",
       Needs::motion, shared_value},
      {"index-32", "A list of nodes in 32 bits gives the same bits, from base 0 and 1.",
       "ilaw.h, ilaw_batch.index", Needs::motion, list_32},
      {"index-64", "A list of nodes in 64 bits gives the same bits, from base 0 and 1.",
       "ilaw.h, ilaw_batch.index64", Needs::motion, list_64},
      {"state-in-place", "state_out may be the array of state_in.", "ilaw.h, ilaw_batch.state_out",
       Needs::motion, in_place},
      {"batch-order", "The order of the nodes changes no bit.", alone, Needs::motion, order},
      {"batch-parts", "A node gets the same bits alone as among others.", alone, Needs::motion, parts},
      {"batch-large", "A node gets the same bits among hundreds as alone.", alone, Needs::motion,
       large_batch},
      {"outputs-asked", "Which outputs are asked for changes no bit of the others.", alone, Needs::motion,
       outputs},
      {"amounts-asked", "Which amounts are asked for changes no bit of the other results.",
       "ilaw.h, ilaw_batch.amounts", Needs::motion, amounts},
      {"floats-rounded", "A float result is the double result rounded once; status and state are the same.",
       "ilaw.h, ILAW_NUMBERS_DOUBLE", Needs::motion, floats_rounded},
      {"smooth-unasked", "v_smooth changes no bit of an instance that does not ask for it.",
       "ilaw.h, ILAW_INPUT_V_SMOOTH", Needs::motion, smooth_unasked},
      {"gap-offset", "gap_offset is subtracted from the gap.", "ilaw.h, ilaw_batch.gap_offset", Needs::motion,
       gap_offset}};
}

}  // namespace ilaw::check
