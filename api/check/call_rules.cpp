// Rules: what evaluate and initialise return, and which calls they refuse.
// SPDX-License-Identifier: BSD-3-Clause
#include "check/rule.hpp"

#include "check/sandbox.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace ilaw::check {
namespace {

std::string text_of_code(const Results& found) {
  return "evaluate returned " + std::to_string(found.code) + ": " +
         (found.report.reason ? found.report.reason : "no reason");
}

// Plain motions and gaps, also large and tiny ones.
void returns(const Subject& subject) {
  for_trials(subject, [](const Trial& trial, Draw& draw) {
    for (const bool isotropic : {true, false}) {
      const Script script = draw_script(trial, draw, {}, isotropic);
      for (const Results& found : run(trial, script))
        if (found.code != ILAW_OK && found.code != ILAW_BAD_NODES)
          fail(trial, script[0], 0, text_of_code(found), "ILAW_OK");
    }
    return true;
  });
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

void served(const Subject& subject) {
  for_trials(subject, [](const Trial& trial, Draw& draw) {
    const Script script = draw_script(trial, draw, {}, true);
    Heap heap;
    Arrays arrays(trial, script.front(), {}, heap);
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
  });
}

struct Wrong {
  const char* what;
  void (*spoil)(ilaw_batch& batch);
  bool for_initialise;
  std::uint32_t input = 0;  // the instance must read it; 0: any
  bool spins = false;       // the setup must have them
  bool plane = false;       // it must have dimension 2 or 3
};

std::int32_t list_below[] = {1, 0};
std::int64_t list_negative[] = {0, -1};
std::int32_t list_good[] = {0, 1};
std::int64_t list_good_64[] = {0, 1};

const Wrong wrong_calls[] = {
    {"v_free null", [](ilaw_batch& b) { b.v_free = {}; }, false},
    {"delassus null", [](ilaw_batch& b) { b.delassus = {}; }, false},
    {"impulse null", [](ilaw_batch& b) { b.impulse = {}; }, false},
    {"node_count -1", [](ilaw_batch& b) { b.node_count = -1; }, true},
    {"velocity_step 0", [](ilaw_batch& b) { b.velocity_step = 0.0; }, false},
    {"velocity_step NaN", [](ilaw_batch& b) { b.velocity_step = std::nan(""); }, false},
    {"position_step -1", [](ilaw_batch& b) { b.position_step = -1.0; }, false},
    {"position_step inf", [](ilaw_batch& b) { b.position_step = infinity; }, false},
    {"time NaN", [](ilaw_batch& b) { b.time = std::nan(""); }, true},
    {"index_base 2", [](ilaw_batch& b) { b.index_base = 2; }, true},
    {"a node below index_base",
     [](ilaw_batch& b) {
       b.index = list_below;
       b.index_base = 1;
     },
     true},
    {"a negative node", [](ilaw_batch& b) { b.index64 = list_negative; }, true},
    {"index and index64",
     [](ilaw_batch& b) {
       b.index = list_good;
       b.index64 = list_good_64;
     },
     true},
    {"an impulse with node_stride 0", [](ilaw_batch& b) { b.impulse.node_stride = 0; }, false},
    {"a v_free with component_stride 0", [](ilaw_batch& b) { b.v_free.component_stride = 0; }, false, 0,
     false, true},
    {"a normal with component_stride 0", [](ilaw_batch& b) { b.normal.component_stride = 0; }, false,
     ILAW_INPUT_NORMAL, false, true},
    {"gap null", [](ilaw_batch& b) { b.gap = {}; }, false, ILAW_INPUT_GAP},
    {"v_previous null", [](ilaw_batch& b) { b.v_previous = {}; }, false, ILAW_INPUT_V_PREVIOUS},
    {"area null", [](ilaw_batch& b) { b.area = {}; }, false, ILAW_INPUT_AREA},
    {"normal null", [](ilaw_batch& b) { b.normal = {}; }, false, ILAW_INPUT_NORMAL},
    {"tangent null", [](ilaw_batch& b) { b.tangent = {}; }, false, ILAW_INPUT_TANGENT},
    {"spin_free null", [](ilaw_batch& b) { b.spin_free = {}; }, false, 0, true},
    {"moment null", [](ilaw_batch& b) { b.moment = {}; }, false, 0, true},
    {"a moment with node_stride 0", [](ilaw_batch& b) { b.moment.node_stride = 0; }, false, 0, true},
    {"a spin with node_stride 0", [](ilaw_batch& b) { b.spin.node_stride = 0; }, false, 0, true},
    {"spin_previous null", [](ilaw_batch& b) { b.spin_previous = {}; }, false, ILAW_INPUT_V_PREVIOUS, true}};

// Calls that must return a code and write nothing.
void expect_refused(const Trial& trial, Arrays& arrays, const Inputs& in, const std::vector<double>& before,
                    const Wrong& wrong, std::int32_t code) {
  for (const bool initial : {false, true}) {
    if (initial && !wrong.for_initialise) continue;
    ilaw_batch batch = arrays.batch();
    wrong.spoil(batch);
    const std::vector<double> state = arrays.state(), amounts = arrays.amounts();
    ilaw_report report{};
    report.struct_size = sizeof report;
    set_setting(trial.text() + "; " + wrong.what);
    const std::int32_t found =
        initial ? trial.instance.initialise(batch, &report) : trial.instance.evaluate(batch, &report);
    const std::string call =
        std::string(initial ? "initialise" : "evaluate") + ", given " + wrong.what + ", ";
    if (found != code)
      fail(trial, in, 0, call + "returned " + std::to_string(found), "code " + std::to_string(code));
    if (arrays.state() != state || arrays.impulses() != before || arrays.amounts() != amounts)
      fail(trial, in, 0, call + "wrote results", "nothing written");
    if (!report.reason) fail(trial, in, 0, call + "gave no reason", "a reason in the report");
  }
}

template <class Look>
void with_two_nodes(const Subject& subject, Look look) {
  for_trials(subject, [&](const Trial& trial, Draw& draw) {
    const Script script = draw_script(trial, draw, {2, 1}, true);
    Heap heap;
    Arrays arrays(trial, script[0], {}, heap);
    arrays.initialise(script[0]);
    arrays.evaluate(script[0]);
    look(trial, arrays, script[0], arrays.impulses());
    return true;
  });
}

void calls_refused(const Subject& subject) {
  with_two_nodes(subject, [](const Trial& trial, Arrays& arrays, const Inputs& in,
                             const std::vector<double>& before) {
    for (const Wrong& wrong : wrong_calls)
      if ((wrong.input == 0 || trial.reads(wrong.input)) && (!wrong.spins || trial.setup.spins()) &&
          (!wrong.plane || trial.setup.dimension > 1))
        expect_refused(trial, arrays, in, before, wrong, ILAW_INVALID_ARGUMENT);
    if (trial.info.state_size > 0)
      expect_refused(trial, arrays, in, before,
                     {"state_in null", [](ilaw_batch& b) { b.state_in = {}; }, false}, ILAW_INVALID_ARGUMENT);
  });
}

double other_doubles[64];
float other_floats[64];

// Both pointers of an array, or the one of the other number type.
template <class Array>
void set_other(Array& array, bool both) {
  const bool floats = array.floats != nullptr;
  if (both || floats) array.values = other_doubles;
  if (both || !floats) array.floats = other_floats;
  if (!both && floats) array.floats = nullptr;
  if (!both && !floats) array.values = nullptr;
}
template <bool both, auto member>
Wrong other_numbers(const char* what) {
  return {what, [](ilaw_batch& b) { set_other(b.*member, both); }, false};
}

void array_numbers(const Subject& subject) {
  with_two_nodes(
      subject, [](const Trial& trial, Arrays& arrays, const Inputs& in, const std::vector<double>& before) {
        struct Array {
          bool is_used;
          Wrong both, other;
        };
#define ILAW_CHECK_ARRAY(used, member)                                                 \
  Array {                                                                              \
    used, other_numbers<true, &ilaw_batch::member>(#member " with both pointers"),     \
        other_numbers<false, &ilaw_batch::member>(#member " of the other number type") \
  }
        const Array all[] = {
            ILAW_CHECK_ARRAY(true, v_free),
            ILAW_CHECK_ARRAY(!in.v_smooth.empty(), v_smooth),
            ILAW_CHECK_ARRAY(true, delassus),
            ILAW_CHECK_ARRAY(trial.reads(ILAW_INPUT_GAP), gap),
            ILAW_CHECK_ARRAY(trial.reads(ILAW_INPUT_GAP), gap_offset),
            ILAW_CHECK_ARRAY(trial.reads(ILAW_INPUT_V_PREVIOUS), v_previous),
            ILAW_CHECK_ARRAY(trial.reads(ILAW_INPUT_AREA), area),
            ILAW_CHECK_ARRAY(trial.reads(ILAW_INPUT_NORMAL), normal),
            ILAW_CHECK_ARRAY(trial.reads(ILAW_INPUT_TANGENT), tangent),
            ILAW_CHECK_ARRAY(trial.info.state_size > 0, state_in),
            ILAW_CHECK_ARRAY(trial.info.state_size > 0, state_out),
            ILAW_CHECK_ARRAY(true, impulse),
            ILAW_CHECK_ARRAY(trial.writes(ILAW_OUTPUT_VELOCITY), velocity),
            ILAW_CHECK_ARRAY(trial.writes(ILAW_OUTPUT_ENERGY), energy),
            ILAW_CHECK_ARRAY(trial.setup.spins(), spin_free),
            ILAW_CHECK_ARRAY(trial.setup.spins() && trial.reads(ILAW_INPUT_V_PREVIOUS), spin_previous),
            ILAW_CHECK_ARRAY(trial.setup.spins(), moment),
            ILAW_CHECK_ARRAY(trial.setup.spins(), spin)};
#undef ILAW_CHECK_ARRAY
        for (const Array& array : all)
          for (const Wrong& wrong : {array.both, array.other})
            if (array.is_used) expect_refused(trial, arrays, in, before, wrong, ILAW_INVALID_ARGUMENT);
        if (trial.info.amount_count == 0) return;
        static std::vector<ilaw_output> amounts;
        for (const bool both : {true, false}) {
          amounts.assign(arrays.batch().amounts, arrays.batch().amounts + trial.info.amount_count);
          set_other(amounts.back(), both);
          expect_refused(trial, arrays, in, before,
                         {"an amount with both pointers or of the other number type",
                          [](ilaw_batch& b) { b.amounts = amounts.data(); }, false},
                         ILAW_INVALID_ARGUMENT);
        }
      });
}

// Whether evaluate refuses a batch of these outputs that lacks one of its inputs.
void expect_code_without(const Trial& trial, const Inputs& in, ilaw_input ilaw_batch::*input,
                         std::uint32_t outputs, bool refused, const std::string& what) {
  Heap heap;
  Arrays arrays(trial, in, {.outputs = outputs}, heap);
  arrays.initialise(in);
  arrays.evaluate(in);
  ilaw_batch batch = arrays.batch();
  batch.*input = {};
  set_setting(trial.text() + "; without " + what);
  const std::int32_t code = trial.instance.evaluate(batch, nullptr);
  if (refused ? code != ILAW_INVALID_ARGUMENT : code < 0)
    fail(trial, in, 0, "without " + what + ", evaluate returned " + std::to_string(code),
         refused ? "ILAW_INVALID_ARGUMENT (-1)" : "as with it");
}

// Inputs that only energies and amounts need may be missing where neither is requested.
void balance_inputs(const Subject& subject) {
  for_trials(
      subject,
      [](const Trial& trial, Draw& draw) {
        const ilaw_inputs more = trial.info.balance_inputs & ~trial.info.inputs;
        if (!(more & ILAW_INPUT_V_PREVIOUS)) return false;
        const Script script = draw_script(trial, draw, {2, 1}, true);
        const auto expect = [&](std::uint32_t outputs, bool refused, const std::string& what) {
          expect_code_without(trial, script[0], &ilaw_batch::v_previous, outputs, refused,
                              "v_previous, " + what);
          if (trial.setup.spins())
            expect_code_without(trial, script[0], &ilaw_batch::spin_previous, outputs, refused,
                                "spin_previous, " + what);
        };
        expect(ILAW_OUTPUT_STATUS, false, "and neither energy nor amounts");
        if (trial.writes(ILAW_OUTPUT_ENERGY)) expect(ILAW_OUTPUT_ENERGY, true, "with energy");
        if (trial.info.amount_count > 0) expect(amounts_output, true, "with amounts");
        return true;
      },
      "the law needs no other inputs for energies and amounts");
}

void batch_flags(const Subject& subject) {
  with_two_nodes(
      subject, [](const Trial& trial, Arrays& arrays, const Inputs& in, const std::vector<double>& before) {
        for (const Wrong& wrong :
             {Wrong{"flags to hold and to break", [](ilaw_batch& b) { b.flags = 3; }, true},
              Wrong{"bit 2 of flags", [](ilaw_batch& b) { b.flags = 4; }, true},
              Wrong{"bit 63 of flags", [](ilaw_batch& b) { b.flags = std::uint64_t{1} << 63; }, true}})
          expect_refused(trial, arrays, in, before, wrong, ILAW_UNSUPPORTED);
        if (!trial.can(ILAW_CAN_HOLD_BONDS))
          expect_refused(trial, arrays, in, before,
                         {"bit 0 of flags", [](ilaw_batch& b) { b.flags = ILAW_BATCH_HOLD_BONDS; }, true},
                         ILAW_UNSUPPORTED);
      });
}

void empty_batch(const Subject& subject) {
  for_trials(subject, [](const Trial& trial, Draw&) {
    ilaw_batch batch{};
    batch.struct_size = sizeof batch;
    batch.velocity_step = batch.position_step = 1e-3;
    ilaw_report report{};
    report.struct_size = sizeof report;
    for (const std::int32_t code :
         {trial.instance.initialise(batch, &report), trial.instance.evaluate(batch, &report)})
      if (code != ILAW_OK) fail(trial, "a batch of no nodes returned " + std::to_string(code), "ILAW_OK");
    return true;
  });
}

void report_null(const Subject& subject) {
  for_trials(subject, [](const Trial& trial, Draw& draw) {
    const Script script = draw_script(trial, draw, {3, 1});
    Heap heap;
    Arrays arrays(trial, script[0], {}, heap);
    arrays.initialise(script[0]);
    arrays.evaluate(script[0]);
    set_setting(trial.text() + "; report null");
    const std::int32_t initial = trial.instance.initialise(arrays.batch(), nullptr);
    const std::int32_t code = trial.instance.evaluate(arrays.batch(), nullptr);
    if (initial < 0 || code < 0)
      fail(trial, script[0], 0, "without a report evaluate returned " + std::to_string(code), "as with one");
    return true;
  });
}

// Hosts that look for the smallest step pass over NaN: it would take the limit off.
void expect_steps(const Trial& trial, const Script& script) {
  const std::vector<Results> all = run(trial, script);
  for (std::size_t k = 0; k < all.size(); ++k)
    if (const double step = all[k].report.stable_velocity_step; all[k].code >= 0 && !(step >= 0.0))
      fail(trial, script[k], 0, "stable_velocity_step " + text_of(step),
           "a number above 0, infinity, or 0 where the law does not say");
}

void report_clean(const Subject& subject) {
  for_trials_per_node_too(subject, [](const Trial& trial, Draw& draw) {
    const Script script = draw_script(trial, draw, {5, 2}, true);
    for (const Results& found : run(trial, script)) {
      if (found.code != ILAW_OK) continue;
      const ilaw_report& said = found.report;
      if (said.bad_count != 0 || said.first_bad_node != -1 || said.reason)
        fail(trial, script[0], 0,
             "bad_count " + std::to_string(said.bad_count) + ", first_bad_node " +
                 std::to_string(said.first_bad_node) + (said.reason ? ", a reason" : "") + " beside ILAW_OK",
             "0, -1 and no reason");
    }
    Script with_bad_node = draw_script(trial, draw, {5, 2});
    with_bad_node[1].v_free[0] = std::nan("");
    expect_steps(trial, script);
    expect_steps(trial, with_bad_node);
    return true;
  });
}

// The largest stable step of a batch is the smallest of its nodes.
void stable_step(const Subject& subject) {
  for_trials_per_node_too(
      subject,
      [](const Trial& trial, Draw& draw) {
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
          fail(trial, script[0], 0, "stable_velocity_step " + text_of(all),
               "the smallest of its nodes, " + text_of(least));
        return true;
      },
      "the law does not say its stable step");
}

}  // namespace

std::vector<Rule> call_rules() {
  return {
      {returns_id, "Every function returns: none crashes, hangs, throws, exits or raises a signal.",
       "ilaw.h, Conventions", Needs::instance, returns},
      {"good-input-served",
       "A node whose inputs are sound, with an isotropic H, is evaluated; a bond that may soften may ask "
       "for smaller steps.",
       "ilaw.h, ilaw_law.evaluate", Needs::motion, served},
      {"call-refused",
       "A call that is wrong as a whole returns ILAW_INVALID_ARGUMENT, a reason, and writes nothing.",
       "ilaw.h, ILAW_INVALID_ARGUMENT", Needs::motion, calls_refused},
      {"array-numbers",
       "An array with both pointers, or of the number type that the setup does not have, is refused, and "
       "nothing written.",
       "ilaw.h, ilaw_input", Needs::motion, array_numbers},
      {"balance-inputs",
       "Inputs for balances are needed where energy or an amount is asked for, and only there.",
       "ilaw.h, ilaw_instance_info.balance_inputs", Needs::motion, balance_inputs},
      {"batch-flags",
       "A bit of the batch's flags that the law does not know is refused, and nothing written.",
       "ilaw.h, ilaw_batch.flags", Needs::motion, batch_flags},
      {"empty-batch", "A batch of no nodes is done, whatever its arrays.", "ilaw.h, ilaw_batch.node_count",
       Needs::motion, empty_batch},
      {"report-null", "The report may be null.", "ilaw.h, ilaw_law.evaluate", Needs::motion, report_null},
      {"report-clean",
       "Where nothing is wrong the report says so: 0 bad nodes, the first -1, no reason. Its stable step is "
       "never NaN or negative.",
       "ilaw.h, ilaw_report", Needs::motion, report_clean},
      {"stable-step", "The stable step of a batch is the smallest of its nodes.",
       "ilaw.h, ilaw_report.stable_velocity_step", Needs::motion, stable_step}};
}

}  // namespace ilaw::check
