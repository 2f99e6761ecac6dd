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

// The bits of a run come back in another one of the same script.
using Repeat = std::vector<Results> (*)(const Trial& trial, const Script& script, Draw& draw);
Judge on_repeats(const char* how, std::size_t step_count, Repeat repeat) {
  return on_trials([=](const Trial& trial, Draw& draw) {
    const Script script = draw_script(trial, draw, {13, step_count, true});
    const std::vector<Results> expected = run(Trial(trial.law, trial.setup, trial.values), script);
    expect_same(trial, script, expected, repeat(trial, script, draw), how);
    return true;
  });
}

std::vector<Results> after_another(const Trial& trial, const Script& script, Draw& draw) {
  run(trial, script);
  run(trial, draw_script(trial, draw, {9, 7}));
  return run(trial, script);
}

std::vector<Results> beside_another(const Trial& trial, const Script& script, Draw& draw) {
  const std::optional<Values> values = draw_values(trial.law, trial.setup, draw);
  const Trial neighbour(trial.law, trial.setup, values ? *values : trial.values);
  const Script beside = draw_script(neighbour, draw);
  Started arrays(trial, script[0]), others(neighbour, beside[0]);
  std::vector<Results> found;
  for (std::size_t k = 0; k < script.size(); ++k) {
    others.evaluate(beside[k % beside.size()]);
    found.push_back(arrays.evaluate(script[k]));
  }
  return found;
}

// New steps, old ones: nothing of an instance depends on them.
std::vector<Results> after_other_steps(const Trial& trial, const Script& script, Draw&) {
  Script coarse = script;
  for (Inputs& in : coarse) {
    in.velocity_step *= 7.0;
    in.position_step *= 3.0;
  }
  run(trial, coarse);
  return run(trial, script);
}

// A second half that starts from stored state, in an instance that saw nothing of the first.
std::vector<Results> restarted(const Trial& trial, const Script& script, Draw&) {
  std::vector<Results> found = run(trial, script);
  const std::size_t half = std::max<std::size_t>(1, script.size() / 2);
  const Trial second(trial.law, trial.setup, trial.values);
  Arrays arrays(second, script[0]);
  arrays.set_state(found[half - 1].state);
  for (std::size_t k = half; k < script.size(); ++k) found[k] = arrays.evaluate(script[k]);
  return found;
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

}  // namespace

std::vector<Rule> purity_rules() {
  return {
      {"purity-twice", "The same call gives the same bits again.", "ilaw.h, ilaw_law.evaluate",
       on_trials(twice)},
      {"purity-history", "An instance remembers nothing of what it evaluated.", "ilaw.h, ilaw_instance",
       on_repeats("after another motion of the same instance", 5, after_another)},
      {"purity-instances", "Two instances do not see each other.", "ilaw.h, ilaw_law.evaluate",
       on_repeats("in turn with another instance", 5, beside_another)},
      {"purity-threads", "Any number of threads may evaluate one instance at a time.", "abi.md, Threads",
       on_trials(threads)},
      {"purity-globals", "evaluate changes no global of the library.", "ilaw.h, ilaw_law.evaluate",
       needing(Needs::motion, globals)},
      {"purity-steps", "Both steps may change at every call; nothing of an instance depends on them.",
       "abi.md, Which velocity, which step", on_repeats("after steps of another size", 5, after_other_steps)},
      {"restart", "A motion goes on with the same bits from a stored state, in another instance.",
       "abi.md, State", on_repeats("restarted in the middle", 8, restarted)}};
}

}  // namespace ilaw::check
