// Rules: a result depends on the node's inputs and the batch's scalars alone, not on what was before or
// beside.
// SPDX-License-Identifier: BSD-3-Clause
#include "check/rule.hpp"
#include "check/sandbox.hpp"
#include "check/watch.hpp"

#include <algorithm>
#include <optional>
#include <thread>

namespace ilaw::check {
namespace {

Draw other(const Draw& draw) {
  Draw copy = draw;
  return Draw(copy.below(1U << 30));
}

// The same call again and again, with nothing else between.
bool twice(const Trial& trial, Draw& draw) {
  const Script script = draw_script(trial, draw);
  Started arrays(trial, script[0]);
  for (const Inputs& in : script) {
    const std::vector<double> before = arrays.state();
    const Results first = arrays.evaluate(in);
    for (int k = 0; k < 2; ++k) {
      arrays.set_state(before);
      if (const auto differs = difference(first, arrays.evaluate(in)))
        fail(trial, in, differs->node, joined("evaluated again: ", differs->text), "the same bits");
    }
  }
  return true;
}

// Another motion in between changes nothing: an instance remembers nothing of what it evaluated.
bool instance_forgets(const Trial& trial, Draw& draw) {
  Draw apart = other(draw);
  const Script script = draw_script(trial, draw), between = draw_script(trial, apart, {9, 7});
  const std::vector<Results> expected = run(trial, script);
  run(trial, between);
  expect_same(trial, script, expected, run(trial, script), "after another motion of the same instance");
  return true;
}

bool instances_apart(const Trial& trial, Draw& draw) {
  Draw apart = other(draw);
  const std::optional<Values> values = draw_values(trial.law, trial.setup, apart);
  const Trial neighbour(trial.law, trial.setup, values ? *values : trial.values);
  const Script script = draw_script(trial, draw), beside = draw_script(neighbour, apart);
  const std::vector<Results> expected = run(trial, script);
  Started arrays(trial, script[0]), others(neighbour, beside[0]);
  std::vector<Results> found;
  for (std::size_t k = 0; k < script.size(); ++k) {
    others.evaluate(beside[k]);
    found.push_back(arrays.evaluate(script[k]));
  }
  expect_same(trial, script, expected, found, "in turn with another instance");
  return true;
}

bool threads(const Trial& trial, Draw& draw) {
  const Script script = draw_script(trial, draw, {13, 12, true});
  const std::vector<Results> expected = run(trial, script);
  constexpr std::size_t count = 3;
  std::vector<std::vector<Results>> found(count);
  {
    std::vector<std::jthread> workers;
    workers.reserve(count);
    for (std::vector<Results>& own : found)
      workers.emplace_back([&trial, &script, &own] { own = run(trial, script); });
  }
  for (const std::vector<Results>& own : found)
    expect_same(trial, script, expected, own, "on one of 3 threads that share the instance");
  return true;
}

void globals(const Subject& subject) {
  for_trials(
      subject,
      [&](const Trial& trial, Draw& draw) {
        const Script script = draw_script(trial, draw);
        const Globals before(subject.library.path());
        if (!before.found()) return false;
        run(trial, script);
        if (const std::size_t changed = before.changed())
          fail(trial, joined("evaluate changed ", changed, " bytes of the library's globals"), "none");
        return true;
      },
      "the library's globals were not found");
}

// New steps, old ones: nothing of an instance depends on them.
bool steps_change(const Trial& trial, Draw& draw) {
  const Script script = draw_script(trial, draw);
  Script coarse = script;
  for (Inputs& in : coarse) {
    in.velocity_step *= 7.0;
    in.position_step *= 3.0;
  }
  const Trial fresh(trial.law, trial.setup, trial.values);
  const std::vector<Results> expected = run(fresh, script);
  run(trial, coarse);
  expect_same(trial, script, expected, run(trial, script), "after steps of another size");
  return true;
}

// A second half that starts from stored state, in a process that saw nothing of the first.
bool restart(const Trial& trial, Draw& draw) {
  const Script script = draw_script(trial, draw, {13, 8, true});
  const Trial first(trial.law, trial.setup, trial.values);
  std::vector<Results> expected = run(first, script);
  const std::size_t half = std::max<std::size_t>(1, script.size() / 2);
  const Trial second(trial.law, trial.setup, trial.values);
  Arrays arrays(second, script[0]);
  arrays.set_state(expected[half - 1].state);
  std::vector<Results> found(expected.begin(), expected.begin() + static_cast<std::ptrdiff_t>(half));
  for (std::size_t k = half; k < script.size(); ++k) found.push_back(arrays.evaluate(script[k]));
  expect_same(trial, script, expected, found,
              "restarted from the state after step " + std::to_string(half - 1));
  return true;
}

}  // namespace

std::vector<Rule> purity_rules() {
  return {{"purity-twice", "The same call gives the same bits again.", "ilaw.h, ilaw_law.evaluate",
           on_trials(twice)},
          {"purity-history", "An instance remembers nothing of what it evaluated.", "ilaw.h, ilaw_instance",
           on_trials(instance_forgets)},
          {"purity-instances", "Two instances do not see each other.", "ilaw.h, ilaw_law.evaluate",
           on_trials(instances_apart)},
          {"purity-threads", "Any number of threads may evaluate one instance at a time.", "abi.md, Threads",
           on_trials(threads)},
          {"purity-globals", "evaluate changes no global of the library.", "ilaw.h, ilaw_law.evaluate",
           needing(Needs::motion, globals)},
          {"purity-steps", "Both steps may change at every call; nothing of an instance depends on them.",
           "abi.md, Which velocity, which step", on_trials(steps_change)},
          {"restart", "A motion goes on with the same bits from a stored state, in another instance.",
           "abi.md, State", on_trials(restart)}};
}

}  // namespace ilaw::check
