// Rules: bad input at a node is contained there.
// SPDX-License-Identifier: BSD-3-Clause
#include "check/rule.hpp"

#include <cmath>
#include <limits>

namespace ilaw::check {
namespace {

const double nan = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t spoilt = 5;

struct Bad {
  const char* name;
  std::vector<double> Inputs::*array;
  double value;
  std::uint32_t input;  // the law must read it; 0: all do
  bool every_component;
};

const Bad bad_inputs[] = {
    {"v_free NaN", &Inputs::v_free, nan, 0, false},
    {"v_free infinite", &Inputs::v_free, -infinity, 0, false},
    {"v_smooth NaN", &Inputs::v_smooth, nan, ILAW_INPUT_V_SMOOTH, false},
    {"v_smooth infinite", &Inputs::v_smooth, infinity, ILAW_INPUT_V_SMOOTH, false},
    {"delassus 0", &Inputs::delassus, 0.0, 0, true},
    {"delassus negative", &Inputs::delassus, -1.0, 0, true},
    {"delassus NaN", &Inputs::delassus, nan, 0, false},
    {"delassus infinite", &Inputs::delassus, infinity, 0, false},
    {"gap NaN", &Inputs::gap, nan, ILAW_INPUT_GAP, false},
    {"gap infinite", &Inputs::gap, -infinity, ILAW_INPUT_GAP, false},
    {"gap_offset NaN", &Inputs::gap_offset, nan, ILAW_INPUT_GAP, false},
    {"v_previous NaN", &Inputs::v_previous, nan, ILAW_INPUT_V_PREVIOUS, false},
    {"area NaN", &Inputs::area, nan, ILAW_INPUT_AREA, false},
    {"area negative", &Inputs::area, -1.0, ILAW_INPUT_AREA, false},
    {"normal NaN", &Inputs::normal, nan, ILAW_INPUT_NORMAL, false},
    {"normal 0", &Inputs::normal, 0.0, ILAW_INPUT_NORMAL, true},
    {"normal no unit vector", &Inputs::normal, 3.0, ILAW_INPUT_NORMAL, true},
    {"tangent NaN", &Inputs::tangent, nan, ILAW_INPUT_TANGENT, false},
    {"tangent 0", &Inputs::tangent, 0.0, ILAW_INPUT_TANGENT, true},
    {"spin_free NaN", &Inputs::spin_free, nan, 0, false},
    {"spin_previous infinite", &Inputs::spin_previous, infinity, ILAW_INPUT_V_PREVIOUS, false}};

void spoil(Inputs& in, const Bad& bad) {
  std::vector<double>& values = in.*bad.array;
  const std::size_t width = values.size() / in.count;
  for (std::size_t c = 0; c < (bad.every_component ? width : 1); ++c) values[spoilt * width + c] = bad.value;
}

// Two steps, the second with something spoilt; calls look with the results without and with it.
struct Spoilt {
  const Trial& trial;
  const Inputs& in;
  const std::vector<double>& state;  // before the step
  const Results &good, &bad;
  std::string name;
};

Judge on_bad_inputs(void (*look)(const Spoilt& s)) {
  return on_trials([look](const Trial& trial, Draw& draw) {
    for (const bool in_place : {false, true}) {
      const Script script = draw_script(trial, draw, {11, 2}, true);
      Started arrays(trial, script[0], {.in_place = in_place});
      arrays.evaluate(script[0]);
      const std::vector<double> state = arrays.state();
      const Results good = arrays.evaluate(script[1]);
      if (good.code != ILAW_OK) continue;
      for (const Bad& bad : bad_inputs) {
        if ((script[1].*bad.array).empty() || (bad.input && !trial.reads(bad.input))) continue;
        Inputs in = script[1];
        spoil(in, bad);
        arrays.set_state(state);
        const Results found = arrays.evaluate(in);
        look(Spoilt{trial, in, state, good, found, bad.name});
      }
    }
    return true;
  });
}

void reported(const Spoilt& s) {
  const ilaw_report& said = s.bad.report;
  if (s.bad.code != ILAW_BAD_NODES || said.bad_count != 1 || said.first_bad_node != spoilt || !said.reason)
    fail(s.trial, s.in, spoilt,
         joined(s.name, ": code ", s.bad.code, ", bad_count ", said.bad_count, ", first_bad_node ",
                said.first_bad_node, (said.reason ? "" : ", no reason")),
         "ILAW_BAD_NODES (1), 1, node 5 and a reason");
}

// The node number is that of the arrays, without index_base.
bool reported_in_lists(const Trial& trial, Draw& draw) {
  const Script script = draw_script(trial, draw, {6, 1}, true);
  Inputs in = script[0];
  Started arrays(trial, in, {.list = List::of_32_bits, .index_base = 1});
  if (arrays.evaluate(in).code != ILAW_OK) return false;
  in.v_free[2 * in.dimension] = in.v_free[4 * in.dimension] = nan;
  arrays.initialise(script[0]);
  const Results found = arrays.evaluate(in);
  // Listed in reverse: node 2 of the script stands third, at place 3.
  if (found.report.bad_count != 2 || found.report.first_bad_node != 3)
    fail(trial, in, 2,
         joined("bad_count ", found.report.bad_count, ", first_bad_node ", found.report.first_bad_node),
         "2 and 3: index[2] - index_base");
  return true;
}

void at_the_node(const Spoilt& s) {
  const std::size_t d = s.in.dimension, size = s.trial.info.state_size;
  const auto say = [&](const std::string& seen, const std::string& allowed) {
    fail(s.trial, s.in, spoilt, joined(s.name, ": ", seen), allowed);
  };
  expect_nothing(s.trial, s.in, s.bad, spoilt, s.name);
  for (std::size_t c = 0; c < size; ++c)
    if (!same_bits(s.bad.state[spoilt * size + c], s.state[spoilt * size + c]))
      say(joined("state_out ", s.bad.state[spoilt * size + c]),
          joined("state_in, ", s.state[spoilt * size + c]));
  if (!s.bad.status.empty() && s.bad.status[spoilt] != ILAW_BAD_INPUT)
    say(joined("status ", s.bad.status[spoilt]), "ILAW_BAD_INPUT (7)");
  const auto expect_free = [&](const char* name, const std::vector<double>& after,
                               const std::vector<double>& free) {
    for (std::size_t c = spoilt * d; !after.empty() && c < (spoilt + 1) * d; ++c)
      if (!(after[c] == free[c] || (std::isnan(after[c]) && std::isnan(free[c]))))
        say(joined(name, after[c]), joined("that without interface, ", free[c]));
  };
  expect_free("velocity ", s.bad.velocity, s.in.v_free);
  expect_free("spin ", s.bad.spin, s.in.spin_free);
}

void elsewhere(const Spoilt& s) {
  std::vector<std::size_t> others = numbers_below(s.in.count);
  others.erase(others.begin() + spoilt);
  Results good = s.good.of_nodes(others), bad = s.bad.of_nodes(others);
  bad.code = good.code;
  if (const auto differs = difference(good, bad))
    fail(s.trial, s.in, others[differs->node], joined(s.name, " at node 5: ", differs->text),
         "as without it");
}

// A full H with a negative eigenvalue and a positive diagonal, or k^2 > h_T j_T.
bool indefinite(const Trial& trial, Draw& draw) {
  const bool is_full = trial.setup.form == ILAW_DELASSUS_FULL && trial.setup.dimension > 1;
  if (!is_full && !trial.setup.spins()) return false;
  Inputs in = draw_script(trial, draw, {11, 1}, true)[0];
  Started arrays(trial, in);
  if (arrays.evaluate(in).code != ILAW_OK) return false;
  in.delassus[spoilt * in.form_width + (is_full ? in.dimension : 2)] = 5.0;
  arrays.initialise(in);
  const Results found = arrays.evaluate(in);
  if (found.code != ILAW_BAD_NODES || found.report.first_bad_node != spoilt)
    fail(trial, in, spoilt, joined("code ", found.code), "ILAW_BAD_NODES (1) at node 5");
  return true;
}

// Numbers as large and small as there are: finite impulses, or bad input.
bool extremes(const Trial& trial, Draw& draw) {
  Script script = draw_script(trial, draw, {24, 2});
  for (Inputs& in : script)
    for (std::size_t i = 0; i < in.count; ++i) {
      const double most = trial.setup.floats() ? 38.0 : 308.0;
      const double size = std::pow(10.0, draw.within(-most - 12.0, most));
      for (std::size_t c = 0; c < in.dimension; ++c) in.v_free[i * in.dimension + c] *= size;
      if (!in.v_smooth.empty() && i % 4 != 0) in.set_vector(in.v_smooth, i, size * in.vector(in.v_smooth, i));
      if (in.spins()) in.set_vector(in.spin_free, i, (i % 5 == 0 ? 1.0 : size) * in.vector(in.spin_free, i));
      if (i % 3 == 0) in.gap[i] *= std::pow(10.0, draw.within(-most, most));
      const double scale = std::pow(10.0, draw.within(-0.65 * most, 0.65 * most));
      for (std::size_t c = 0; i % 2 == 0 && c < in.form_width; ++c)
        in.delassus[i * in.form_width + c] *= scale;
    }
  const std::vector<Results> results = run(trial, script);
  for (std::size_t k = 0; k < script.size(); ++k) expect_finite(trial, script[k], results[k]);
  return true;
}

}  // namespace

std::vector<Rule> bad_input_rules() {
  constexpr const char* source = "ilaw.h, ilaw_law.evaluate";
  return {{"bad-input-report", "Bad input is reported: the code, how many nodes, the first and why.",
           "ilaw.h, ilaw_report", on_bad_inputs(reported)},
          {"bad-input-list", "The first bad node is named by its number, without index_base.",
           "ilaw.h, ilaw_report.first_bad_node", on_trials(reported_in_lists)},
          {"bad-input-node",
           "A node with bad input gets r = 0, state_out = state_in, status ILAW_BAD_INPUT, energy "
           "and amounts 0 and velocity = v_free; moment 0 and spin = spin_free.",
           source, on_bad_inputs(at_the_node)},
          {"bad-input-others", "Bad input at a node changes no bit of the others.", source,
           on_bad_inputs(elsewhere)},
          {"bad-input-definite",
           "An H that is not positive definite, with its spins where it has them, is bad input.",
           "ilaw.h, ilaw_batch.delassus", on_trials(indefinite, "the law serves neither a full H nor spins")},
          {"impulse-finite", "An impulse and a moment are finite, in floats below 2^126, whatever comes in.",
           "abi.md, Errors", on_trials(extremes)}};
}

}  // namespace ilaw::check
