// Rules: what a law makes of its state, of v_smooth, and of nodes that are out of reach.
// SPDX-License-Identifier: BSD-3-Clause
#include "check/rule.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace ilaw::check {
namespace {

bool same_bits_at(const std::vector<double>& a, const std::vector<double>& b, std::size_t node,
                  std::size_t width) {
  return width == 0 || std::memcmp(&a[node * width], &b[node * width], width * sizeof(double)) == 0;
}

// Closes the gap exactly but for rounding, or an ulp beside that.
double draw_closing(const Inputs& in, std::size_t node, Draw& draw) {
  const double closing = -in.slack(node) / in.position_step;
  return draw.one_in(3)   ? closing
         : draw.one_in(2) ? std::nextafter(closing, -1e9)
                          : std::nextafter(closing, 1e9);
}

Vector along_normal(const Inputs& in, const Vector& n, double speed) {
  Vector v = Vector::Zero();
  for (std::size_t c = 0; c < in.dimension; ++c) v[c] = in.normal.empty() && c > 0 ? 0.25 : speed * n[c];
  return v;
}

// Velocities that close the gap or just do not; one of v_free and v_smooth may leave it wide open.
void draw_borderline(Inputs& in, Draw& draw) {
  for (std::size_t i = 0; i < in.count; ++i) {
    const double gap = 1e-3 * static_cast<double>(1 + draw.below(99));
    in.gap[i] = in.gap_offset[i] + gap;
    const Vector n = in.normal_at(i);
    double along = draw_closing(in, i, draw);
    if (!in.v_smooth.empty()) {
      in.set_vector(in.v_smooth, i, along_normal(in, n, draw.one_in(3) ? 1.0 : draw_closing(in, i, draw)));
      if (draw.one_in(3)) along = 1.0;
    }
    in.set_vector(in.v_free, i, along_normal(in, n, along));
    in.set_vector(in.v_previous, i, -3.0 * n);
  }
}

void expect_left_alone(const Trial& trial, const Inputs& in, std::size_t i, const std::vector<double>& state,
                       const Results& found) {
  expect_nothing(trial, in, found, i, "out of reach");
  if (!same_bits_at(state, found.state, i, trial.info.state_size))
    fail(trial, in, i, "out of reach, its state changed", "the same bits of state");
  if (!found.status.empty() && found.status[i] != ILAW_FREE && found.status[i] != ILAW_BAD_INPUT)
    fail(trial, in, i, joined("out of reach, status ", found.status[i]), "ILAW_FREE (0)");
}

bool skip_fresh(const Trial& trial, Draw& draw) {
  if (!trial.permits(ILAW_MAY_SKIP_FRESH) || !trial.reads(ILAW_INPUT_GAP)) return false;
  Script script = draw_script(trial, draw, {40, 3, true}, true);
  Arrays arrays(trial, script[0]);
  for (Inputs& in : script) {
    if (&in != &script[0]) draw_borderline(in, draw);
    in.round_to(trial.setup);
    arrays.initialise(in);
    const std::vector<double> state = arrays.state();
    const Results found = arrays.evaluate(in);
    for (std::size_t i = 0; i < in.count; ++i)
      if (in.is_out_of_reach(i)) expect_left_alone(trial, in, i, state, found);
  }
  return true;
}

bool skip_free(const Trial& trial, Draw& draw) {
  if (!trial.permits(ILAW_MAY_SKIP_FREE) || !trial.writes(ILAW_OUTPUT_STATUS) || !trial.reads(ILAW_INPUT_GAP))
    return false;
  Script script = draw_script(trial, draw, {30, 16, true}, true);
  Started arrays(trial, script[0]);
  for (std::size_t k = 0; k + 1 < script.size(); k += 2) {
    const Results before = arrays.evaluate(script[k]);
    Inputs& in = script[k + 1];
    draw_borderline(in, draw);
    in.round_to(trial.setup);
    const Results found = arrays.evaluate(in);
    for (std::size_t i = 0; i < in.count; ++i)
      if (before.status[i] == ILAW_FREE && in.is_out_of_reach(i))
        expect_left_alone(trial, in, i, before.state, found);
  }
  return true;
}

bool smooth_absent(const Trial& trial, Draw& draw) {
  if (!trial.reads(ILAW_INPUT_V_SMOOTH)) return false;
  Script with = draw_script(trial, draw), without = with;
  for (std::size_t k = 0; k < with.size(); ++k) {
    with[k].v_smooth = with[k].v_free;
    without[k].v_smooth.clear();
  }
  expect_same(trial, with, run(trial, without), run(trial, with), "with v_free as v_smooth, too");
  return true;
}

// Whether an entry of the state is one of a history: numbers that the law may not read again.
bool is_history(const Trial& trial, std::size_t entry) {
  for (std::uint32_t k = 0; k < trial.info.state_variable_count; ++k) {
    const ilaw_state_variable& variable = *trial.info.state_variables[k];
    if (entry < variable.count) return variable.kind == ILAW_KIND_HISTORY;
    entry -= variable.count;
  }
  return false;
}

// The state of one node replaced: bad input, or a finite result; the others as ever.
void expect_contained(const Trial& trial, const Inputs& in, Arrays& arrays, const std::vector<double>& state,
                      const Results& good, std::size_t entry, double value) {
  constexpr std::size_t node = 2;
  const std::size_t size = trial.info.state_size, d = in.dimension, moment_width = in.spins() ? 3 : 0;
  std::vector<double> foreign = state;
  foreign[node * size + entry] = value;
  arrays.set_state(foreign);
  const Results found = arrays.evaluate(in);
  const auto say = [&](std::size_t at, const std::string& seen, const std::string& allowed) {
    fail(trial, in, at, joined("state_in[", entry, "] of node 2 = ", value, ": ", seen), allowed);
  };
  for (std::size_t i = 0; i < in.count; ++i) {
    if (i == node) continue;
    if (!same_bits_at(good.impulse, found.impulse, i, d) || !same_bits_at(good.state, found.state, i, size) ||
        !same_bits_at(good.moment, found.moment, i, moment_width))
      say(i, joined("node ", i, " changed"), "as ever at the other nodes");
  }
  for (std::size_t c = 0; c < d; ++c)
    if (!std::isfinite(found.impulse[node * d + c]))
      say(node, "an impulse that is not finite", "a finite impulse");
  const Vector m = found.action(node).tail<3>();
  for (const double component : m)
    if (!std::isfinite(component)) say(node, "a moment that is not finite", "a finite moment");
  const bool refused = found.code == ILAW_BAD_NODES;
  if (!std::isfinite(value) && !refused && !is_history(trial, entry))
    say(node, joined("code ", found.code), "ILAW_BAD_NODES (1)");
  if (!std::isfinite(value) && !refused &&
      !(same_bits_at(good.impulse, found.impulse, node, d) &&
        same_bits_at(good.moment, found.moment, node, moment_width)))
    say(node, "an impulse that depends on it",
        "bad input, or the same impulse if this step does not read it");
  if (!refused) return;
  for (std::size_t c = 0; c < d; ++c)
    if (found.impulse[node * d + c] != 0.0 || m[c] != 0.0) say(node, "bad input with an impulse", "r = 0");
  if (!same_bits_at(foreign, found.state, node, size))
    say(node, "bad input with another state", "state_out = state_in");
}

bool foreign_state(const Trial& trial, Draw& draw) {
  const std::size_t size = trial.info.state_size;
  if (size == 0) return false;
  const Script script = draw_script(trial, draw, {5, 4}, true);
  Started arrays(trial, script[0]);
  for (std::size_t k = 0; k < 3; ++k) arrays.evaluate(script[k]);
  const std::vector<double> state = arrays.state();
  const Results good = arrays.evaluate(script[3]);
  if (good.code != ILAW_OK) return false;
  for (std::size_t k = 0; k < std::min<std::size_t>(size, 24); ++k)
    for (const double value :
         {std::nan(""), infinity, -infinity, 1e300, -1e300, 1e18, 4096.0, -17.0, 0.5, 1e-310})
      expect_contained(trial, script[3], arrays, state, good, k, value);
  return true;
}

}  // namespace

std::vector<Rule> state_rules() {
  return {
      {"skip-fresh",
       "With ILAW_MAY_SKIP_FRESH a fresh node out of reach gets r = 0, no energy, no amounts, and keeps its "
       "state, bit for bit.",
       "ilaw.h, ILAW_MAY_SKIP_FRESH", on_trials(skip_fresh, "the law does not permit it")},
      {"skip-free",
       "With ILAW_MAY_SKIP_FREE a node that was free gets r = 0, no energy, no amounts, and keeps its state "
       "out of reach.",
       "ilaw.h, ILAW_MAY_SKIP_FREE", on_trials(skip_free, "the law does not permit it")},
      {"smooth-absent", "Without v_smooth the law gives the bits that it gives with v_free as v_smooth.",
       "ilaw.h, ilaw_batch.v_smooth",
       on_trials_per_node_too(smooth_absent, "the law does not ask for v_smooth")},
      {"foreign-state",
       "A state that the law cannot have written is bad input, or does no harm; NaN and infinity "
       "are bad input, in a history in the step that reads them.",
       "abi.md, State", on_trials(foreign_state, "the law has no state")}};
}

}  // namespace ilaw::check
