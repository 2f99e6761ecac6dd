// Rules: what evaluate and initialise return, and which calls they refuse.
// SPDX-License-Identifier: BSD-3-Clause
#include "check/rule.hpp"

#include "check/sandbox.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <type_traits>

namespace ilaw::check {
namespace {

std::string text_of_code(const Results& found) {
  return "evaluate returned " + std::to_string(found.code) + ": " +
         (found.report.reason ? found.report.reason : "no reason");
}

// Plain motions and gaps, also large and tiny ones.
bool returns(const Trial& trial, Draw& draw) {
  for (const bool isotropic : {true, false}) {
    const Script script = draw_script(trial, draw, {}, isotropic);
    for (const Results& found : run(trial, script))
      if (found.code != ILAW_OK && found.code != ILAW_BAD_NODES)
        fail(trial, script[0], 0, text_of_code(found), "ILAW_OK");
  }
  return true;
}

// The step of a batch, and smaller ones where that is refused for being too large.
Results served_by(const Trial& trial, Arrays& arrays, Inputs in) {
  const std::vector<double> before = arrays.state();
  Results found = arrays.evaluate(in);
  for (int k = 0; k < 5 && trial.may_soften() && found.code == ILAW_BAD_NODES; ++k) {
    in.velocity_step *= 0x1p-6;
    in.position_step *= 0x1p-6;
    arrays.set_state(before);
    found = arrays.evaluate(in);
  }
  return found;
}

// Nodes that rest, touch or do not slip exactly: what is divided by its own size is 0/0 there.
Inputs with_zeros(Inputs in, Draw& draw) {
  for (std::vector<double> Inputs::*array :
       {&Inputs::v_free, &Inputs::v_previous, &Inputs::v_smooth, &Inputs::spin_free, &Inputs::spin_previous})
    for (std::size_t i = 0; i < in.count && !(in.*array).empty(); ++i) {
      const bool stops = draw.one_in(3), sticks = in.normal.empty() && draw.one_in(3);
      for (std::size_t c = stops ? 0 : 1; (stops || sticks) && c < in.dimension; ++c)
        (in.*array)[i * in.dimension + c] = 0.0;
    }
  for (std::size_t i = 0; i < in.count; ++i)
    if (draw.one_in(3)) in.gap[i] = in.gap_offset[i];
  return in;
}

bool served(const Trial& trial, Draw& draw) {
  const Script script = draw_script(trial, draw, {}, true);
  Arrays arrays(trial, script.front());
  for (const bool rests : {false, true}) {
    arrays.initialise(script.front());
    for (const Inputs& drawn : script) {
      const Inputs in = rests ? with_zeros(drawn, draw) : drawn;
      const Results found = served_by(trial, arrays, in);
      if (found.code != ILAW_OK)
        fail(trial, in, static_cast<std::size_t>(std::max<std::int64_t>(0, found.report.first_bad_node)),
             text_of_code(found), "ILAW_OK");
      expect_finite(trial, in, found);
    }
  }
  return true;
}

struct Wrong {
  std::string what;
  std::function<void(ilaw_batch& b)> spoil;
  bool for_initialise = false;
};

// Two nodes, evaluated once.
class TwoNodes {
 public:
  TwoNodes(const Trial& trial, Draw& draw)
      : trial_(trial), in_(draw_script(trial, draw, {2, 1}, true)[0]), arrays_(trial, in_) {
    arrays_.evaluate(in_);
  }

  // Calls must return a code and write nothing.
  void expect_refused(const Wrong& wrong, std::int32_t code = ILAW_INVALID_ARGUMENT) {
    expect_refused(wrong, code, false);
    if (wrong.for_initialise) expect_refused(wrong, code, true);
  }

  // Calls look with each array that the instance reads or writes: its name, its member and whether it may be
  // null.
  template <class Look>
  void for_arrays(Look look) {
    for (const NodeArray& array : node_arrays)
      if (!(in_.*array.values).empty() && (trial_.info.inputs & array.asked) == array.asked)
        look(array.name, array.given, array.is_optional);
    if (trial_.info.state_size > 0) look("state_in", &ilaw_batch::state_in, false);
    for (const OutputArray& array : output_arrays)
      if ((arrays_.batch().*array.given).node_stride != 0)
        look(array.name, array.given, array.values != &Results::impulse && array.values != &Results::moment);
  }
  const ilaw_batch& batch() { return arrays_.batch(); }

 private:
  void expect_refused(const Wrong& wrong, std::int32_t code, bool initial) {
    ilaw_batch batch = arrays_.batch();
    wrong.spoil(batch);
    const Results before = arrays_.results();
    ilaw_report report{};
    report.struct_size = sizeof report;
    set_setting(joined(trial_.text(), "; ", wrong.what));
    const std::int32_t found =
        initial ? trial_.instance.initialise(batch, &report) : trial_.instance.evaluate(batch, &report);
    const std::string call = joined(initial ? "initialise" : "evaluate", ", given ", wrong.what, ", ");
    if (found != code) fail(trial_, in_, 0, joined(call, "returned ", found), joined("code ", code));
    if (difference(before, arrays_.results()))
      fail(trial_, in_, 0, call + "wrote results", "nothing written");
    if (!report.reason) fail(trial_, in_, 0, call + "gave no reason", "a reason in the report");
  }

  const Trial& trial_;
  const Inputs in_;
  Started arrays_;
};

bool calls_refused(const Trial& trial, Draw& draw) {
  static constexpr std::int32_t below[] = {1, 0}, good[] = {0, 1};
  static constexpr std::int64_t negative[] = {0, -1}, good_64[] = {0, 1};
  static const Wrong wrong_calls[] = {
      {"node_count -1", [](ilaw_batch& b) { b.node_count = -1; }, true},
      {"velocity_step 0", [](ilaw_batch& b) { b.velocity_step = 0.0; }},
      {"velocity_step NaN", [](ilaw_batch& b) { b.velocity_step = std::nan(""); }},
      {"position_step -1", [](ilaw_batch& b) { b.position_step = -1.0; }},
      {"position_step inf", [](ilaw_batch& b) { b.position_step = infinity; }},
      {"time NaN", [](ilaw_batch& b) { b.time = std::nan(""); }, true},
      {"index_base 2", [](ilaw_batch& b) { b.index_base = 2; }, true},
      {"a node below index_base", [](ilaw_batch& b) { b.index = below, b.index_base = 1; }, true},
      {"a negative node", [](ilaw_batch& b) { b.index64 = negative; }, true},
      {"index and index64", [](ilaw_batch& b) { b.index = good, b.index64 = good_64; }, true}};
  TwoNodes nodes(trial, draw);
  for (const Wrong& wrong : wrong_calls) nodes.expect_refused(wrong);
  nodes.for_arrays([&](const std::string& name, auto member, bool is_optional) {
    if (!is_optional) nodes.expect_refused({name + " null", [=](ilaw_batch& b) { b.*member = {}; }});
    if constexpr (std::is_same_v<decltype(member), ilaw_output ilaw_batch::*>)
      nodes.expect_refused(
          {name + " with node_stride 0", [=](ilaw_batch& b) { (b.*member).node_stride = 0; }});
  });
  if (trial.setup.dimension == 1) return true;
  nodes.expect_refused(
      {"v_free with component_stride 0", [](ilaw_batch& b) { b.v_free.component_stride = 0; }});
  if (trial.reads(ILAW_INPUT_NORMAL))
    nodes.expect_refused(
        {"normal with component_stride 0", [](ilaw_batch& b) { b.normal.component_stride = 0; }});
  return true;
}

// Both pointers of an array, or the one of the other number type.
template <class Array>
void set_other(Array& array, bool both) {
  static double doubles[64];
  static float floats[64];
  const bool has_floats = array.floats != nullptr;
  if (both || has_floats) array.values = doubles;
  if (both || !has_floats) array.floats = floats;
  if (!both && has_floats) array.floats = nullptr;
  if (!both && !has_floats) array.values = nullptr;
}

bool array_numbers(const Trial& trial, Draw& draw) {
  TwoNodes nodes(trial, draw);
  for (const bool both : {true, false}) {
    const std::string how = both ? " with both pointers" : " of the other number type";
    nodes.for_arrays([&](const std::string& name, auto member, bool) {
      nodes.expect_refused({name + how, [=](ilaw_batch& b) { set_other(b.*member, both); }});
    });
    if (trial.info.amount_count == 0) continue;
    std::vector<ilaw_output> amounts(nodes.batch().amounts, nodes.batch().amounts + trial.info.amount_count);
    set_other(amounts.back(), both);
    nodes.expect_refused({"an amount" + how, [&](ilaw_batch& b) { b.amounts = amounts.data(); }});
  }
  return true;
}

// Whether evaluate refuses a batch of these outputs that lacks one of its inputs.
void expect_code_without(const Trial& trial, const Inputs& in, ilaw_input ilaw_batch::*input,
                         std::uint32_t outputs, bool refused, const std::string& what) {
  Started arrays(trial, in, {.outputs = outputs});
  arrays.evaluate(in);
  ilaw_batch batch = arrays.batch();
  batch.*input = {};
  set_setting(joined(trial.text(), "; without ", what));
  const std::int32_t code = trial.instance.evaluate(batch, nullptr);
  if (refused ? code != ILAW_INVALID_ARGUMENT : code < 0)
    fail(trial, in, 0, joined("without ", what, ", evaluate returned ", code),
         refused ? "ILAW_INVALID_ARGUMENT (-1)" : "as with it");
}

// Inputs that only energies and amounts need may be missing where neither is requested.
bool balance_inputs(const Trial& trial, Draw& draw) {
  const ilaw_inputs more = trial.info.balance_inputs & ~trial.info.inputs;
  if (!(more & ILAW_INPUT_V_PREVIOUS)) return false;
  const Script script = draw_script(trial, draw, {2, 1}, true);
  const auto expect = [&](std::uint32_t outputs, bool refused, const std::string& what) {
    expect_code_without(trial, script[0], &ilaw_batch::v_previous, outputs, refused, "v_previous, " + what);
    if (trial.setup.spins())
      expect_code_without(trial, script[0], &ilaw_batch::spin_previous, outputs, refused,
                          "spin_previous, " + what);
  };
  expect(ILAW_OUTPUT_STATUS, false, "and neither energy nor amounts");
  if (trial.writes(ILAW_OUTPUT_ENERGY)) expect(ILAW_OUTPUT_ENERGY, true, "with energy");
  if (trial.info.amount_count > 0) expect(amounts_output, true, "with amounts");
  return true;
}

bool batch_flags(const Trial& trial, Draw& draw) {
  TwoNodes nodes(trial, draw);
  const auto expect_refused = [&](const char* what, std::uint64_t flags) {
    nodes.expect_refused({what, [=](ilaw_batch& b) { b.flags = flags; }, true}, ILAW_UNSUPPORTED);
  };
  expect_refused("flags to hold and to break", ILAW_BATCH_HOLD_BONDS | ILAW_BATCH_BREAK_BONDS);
  expect_refused("bit 2 of flags", 4);
  expect_refused("bit 63 of flags", std::uint64_t{1} << 63);
  if (!trial.can(ILAW_CAN_HOLD_BONDS)) expect_refused("bit 0 of flags", ILAW_BATCH_HOLD_BONDS);
  return true;
}

bool empty_batch(const Trial& trial, Draw&) {
  ilaw_batch batch{};
  batch.struct_size = sizeof batch;
  batch.velocity_step = batch.position_step = 1e-3;
  ilaw_report report{};
  report.struct_size = sizeof report;
  for (const std::int32_t code :
       {trial.instance.initialise(batch, &report), trial.instance.evaluate(batch, &report)})
    if (code != ILAW_OK) fail(trial, joined("a batch of no nodes returned ", code), "ILAW_OK");
  return true;
}

bool report_null(const Trial& trial, Draw& draw) {
  const Script script = draw_script(trial, draw, {3, 1});
  Started arrays(trial, script[0]);
  arrays.evaluate(script[0]);
  set_setting(joined(trial.text(), "; report null"));
  const std::int32_t initial = trial.instance.initialise(arrays.batch(), nullptr);
  const std::int32_t code = trial.instance.evaluate(arrays.batch(), nullptr);
  if (initial < 0 || code < 0)
    fail(trial, script[0], 0, joined("without a report evaluate returned ", code), "as with one");
  return true;
}

// Hosts that look for the smallest step pass over NaN: it would take the limit off.
void expect_steps(const Trial& trial, const Script& script) {
  const std::vector<Results> all = run(trial, script);
  for (std::size_t k = 0; k < all.size(); ++k)
    if (const double step = all[k].report.stable_velocity_step; all[k].code >= 0 && !(step >= 0.0))
      fail(trial, script[k], 0, joined("stable_velocity_step ", step),
           "a number above 0, infinity, or 0 where the law does not say");
}

bool report_clean(const Trial& trial, Draw& draw) {
  const Script script = draw_script(trial, draw, {5, 2}, true);
  for (const Results& found : run(trial, script)) {
    if (found.code != ILAW_OK) continue;
    const ilaw_report& said = found.report;
    if (said.bad_count != 0 || said.first_bad_node != -1 || said.reason)
      fail(trial, script[0], 0,
           joined("bad_count ", said.bad_count, ", first_bad_node ", said.first_bad_node,
                  (said.reason ? ", a reason" : ""), " beside ILAW_OK"),
           "0, -1 and no reason");
  }
  Script with_bad_node = draw_script(trial, draw, {5, 2});
  with_bad_node[1].v_free[0] = std::nan("");
  expect_steps(trial, script);
  expect_steps(trial, with_bad_node);
  return true;
}

// The largest stable step of a batch is the smallest of its nodes.
bool stable_step(const Trial& trial, Draw& draw) {
  const Script script = draw_script(trial, draw, {5, 1}, true);
  const double all = run(trial, script)[0].report.stable_velocity_step;
  if (all == 0.0) return false;
  double least = infinity;
  for (std::size_t i = 0; i < script[0].count; ++i) {
    Layout one;
    one.nodes = {i};
    least = std::fmin(least, run(trial, script, one)[0].report.stable_velocity_step);
  }
  if (all != least)
    fail(trial, script[0], 0, joined("stable_velocity_step ", all),
         joined("the smallest of its nodes, ", least));
  return true;
}

}  // namespace

std::vector<Rule> call_rules() {
  return {
      {returns_id, "Every function returns: none crashes, hangs, throws, exits or raises a signal.",
       "ilaw.h, Conventions", on_instances(returns)},
      {"good-input-served",
       "A node whose inputs are sound, with an isotropic H, is evaluated; a bond that may soften may ask "
       "for smaller steps.",
       "ilaw.h, ilaw_law.evaluate", on_trials(served)},
      {"call-refused",
       "A call that is wrong as a whole returns ILAW_INVALID_ARGUMENT, a reason, and writes nothing.",
       "ilaw.h, ILAW_INVALID_ARGUMENT", on_trials(calls_refused)},
      {"array-numbers",
       "An array with both pointers, or of the number type that the setup does not have, is refused, and "
       "nothing written.",
       "ilaw.h, ilaw_input", on_trials(array_numbers)},
      {"balance-inputs",
       "Inputs for balances are needed where energy or an amount is asked for, and only there.",
       "ilaw.h, ilaw_instance_info.balance_inputs",
       on_trials(balance_inputs, "the law needs no other inputs for energies and amounts")},
      {"batch-flags",
       "A bit of the batch's flags that the law does not know is refused, and nothing written.",
       "ilaw.h, ilaw_batch.flags", on_trials(batch_flags)},
      {"empty-batch", "A batch of no nodes is done, whatever its arrays.", "ilaw.h, ilaw_batch.node_count",
       on_trials(empty_batch)},
      {"report-null", "The report may be null.", "ilaw.h, ilaw_law.evaluate", on_trials(report_null)},
      {"report-clean",
       "Where nothing is wrong the report says so: 0 bad nodes, the first -1, no reason. Its stable step is "
       "never NaN or negative.",
       "ilaw.h, ilaw_report", on_trials_per_node_too(report_clean)},
      {"stable-step", "The stable step of a batch is the smallest of its nodes.",
       "ilaw.h, ilaw_report.stable_velocity_step",
       on_trials_per_node_too(stable_step, "the law does not say its stable step")}};
}

}  // namespace ilaw::check
