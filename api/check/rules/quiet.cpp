// Rules: what a library may not do to its process, and evaluate beside computing.
// SPDX-License-Identifier: BSD-3-Clause
#include "check/rule.hpp"
#include "check/sandbox.hpp"
#include "check/watch.hpp"

#include <sys/stat.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <memory>
#include <optional>

namespace ilaw::check {
namespace {

// A forbidden call ends the process, and is the finding of the rule.
Judge without_calls(Forbidden kind) {
  return {Needs::motion, [kind](const Subject& subject) {
            for_trials(subject, [&](const Trial& trial, Draw& draw) {
              Script script = draw_script(trial, draw);
              script.back().v_free[0] = std::nan("");  // bad input too
              Started arrays(trial, script[0]);
              for (const Inputs& in : script) {
                const CallWatch armed(subject.library.path(), kind);
                arrays.evaluate(in);
              }
              return true;
            });
          }};
}

void system_calls(const Subject& subject) {
  struct Prepared {
    Prepared(const Trial& given, Draw& draw)
        : trial(given.law, given.setup, given.values),
          in(draw_script(given, draw, {5, 1})[0]),
          arrays(trial, in) {
      arrays.load(in);
    }
    Trial trial;
    std::string setting = trial.text();
    Inputs in;
    Started arrays;
  };
  std::vector<std::unique_ptr<Prepared>> all;
  for_trials(subject, [&](const Trial& trial, Draw& draw) {
    all.push_back(std::make_unique<Prepared>(trial, draw));
    return true;
  });
  // The filter is for good, so it is set in a process of its own.
  const Ending ending = run_apart(Limits{}, [&all] {
    if (!forbid_system_calls()) return std::string("no filter");
    for (const auto& one : all) {
      ilaw_report report{};
      report.struct_size = sizeof report;
      set_setting(one->setting);
      one->trial.instance.evaluate(one->arrays.batch(), &report);
    }
    return std::string();
  });
  if (!ending.returned) throw Finding{joined("evaluate ", ending.how), "none", ending.setting, {}};
  if (!ending.result.empty()) throw NotJudged{"this system filters no system calls"};
}

// Also where create refuses, and where input is bad.
void prints(const Subject& subject) {
  for_trials(subject, [](const Trial& trial, Draw& draw) {
    Script script = draw_script(trial, draw);
    script.back().v_free[0] = std::nan("");
    run(trial, script);
    create(trial.law, trial.setup, with(trial.values, {"nobody_has_this", ILAW_KIND_VALUE_NUMBER, 1.0}));
    return true;
  });
  std::fflush(nullptr);
  struct stat written {};
  if (fstat(STDOUT_FILENO, &written) == 0 && written.st_size > 0)
    throw Finding{joined(written.st_size, " bytes were written to stdout and stderr"), "nothing"};
}

[[noreturn]] void fail_changed(const std::string& call, const std::string& changes, const Trial* trial) {
  throw Finding{joined(call, " changed ", changes), "nothing of the process", trial ? trial->text() : "", {}};
}

void loading(const Subject& subject) {
  const ProcessState after;
  if (const std::string changes = subject.before_loading.changes_to(after); !changes.empty())
    fail_changed("loading and describing the library", changes, nullptr);
}

// After each call, also where create refuses and where input is bad.
void calls(const Subject& subject) {
  const ProcessState before;
  for_trials(subject, [&before](const Trial& trial, Draw& draw) {
    const auto expect_kept = [&](const char* call) {
      const ProcessState after;
      if (const std::string changes = before.changes_to(after); !changes.empty())
        fail_changed(call, changes, &trial);
    };
    create(trial.law, trial.setup, with(trial.values, {"nobody_has_this", ILAW_KIND_VALUE_NUMBER, 1.0}));
    expect_kept("create or destroy");
    std::optional<Trial> own(std::in_place, trial.law, trial.setup, trial.values);
    expect_kept("info");
    Script script = draw_script(*own, draw, {5, 2});
    script[1].v_free[0] = std::nan("");
    {
      Started arrays(*own, script[0]);
      expect_kept("initialise");
      for (const Inputs& in : script) {
        arrays.evaluate(in);
        expect_kept("evaluate");
      }
    }
    own.reset();
    expect_kept("destroy");
    return true;
  });
}

}  // namespace

std::vector<Rule> quiet_rules() {
  constexpr const char* source = "ilaw.h, ilaw_law.evaluate";
  return {{"evaluate-allocates", "evaluate does not allocate.", source, without_calls(Forbidden::allocation)},
          {"evaluate-locks", "evaluate takes no lock and starts no thread.", source,
           without_calls(Forbidden::lock)},
          {"evaluate-io", "evaluate does no input or output, and reads no environment.", source,
           without_calls(Forbidden::input_output)},
          {"evaluate-clock", "evaluate reads no clock and no random numbers.", source,
           without_calls(Forbidden::clock)},
          {"evaluate-ends", "evaluate neither ends the process nor handles signals.", "ilaw.h, Conventions",
           without_calls(Forbidden::ending)},
          {"evaluate-system", "evaluate makes no system call.", source, needing(Needs::motion, system_calls)},
          {"prints-nothing", "No function prints.", "ilaw.h, Conventions", needing(Needs::motion, prints)},
          {"loading-process",
           "Loading and describing a library changes nothing of the process: no file, signal, locale, "
           "variable, limit or mode of numbers.",
           "ilaw.h, Conventions", needing(Needs::library, loading)},
          {"calls-process",
           "create, info, initialise, evaluate and destroy change nothing of the process, and leave the x87 "
           "registers empty.",
           "ilaw.h, Conventions", needing(Needs::motion, calls)}};
}

}  // namespace ilaw::check
