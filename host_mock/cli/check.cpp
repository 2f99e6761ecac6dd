// `ilaw check`: whether a library keeps the contract, rule by rule.
// SPDX-License-Identifier: BSD-3-Clause
#include "cli/commands.hpp"

#include "base/exit_code.hpp"
#include "check/check.hpp"
#include "check/command.hpp"
#include "cli/terminal.hpp"

namespace ilaw::host {

void add_check(CLI::App& app, Action& chosen) {
  CLI::App* command =
      app.add_subcommand("check", "Check a library of laws against the contract, rule by rule");
  const Action run = check::add_options(*command);
  command->footer(
      "Exit codes: 0 no rule is broken; 1 some are; 2 bad usage.\n"
      "Example: ilaw check ./build/lib/ilaw/my_law.so --junit check.xml");
  command->callback([run, &chosen] {
    chosen = [run] {
      try {
        return run();
      } catch (const check::UsageError& error) {
        complain(error.what());
        return static_cast<int>(exit_bad_input);
      }
    };
  });
}

}  // namespace ilaw::host
