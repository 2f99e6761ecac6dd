// `ilaw check`: whether a library keeps the contract, rule by rule.
// SPDX-License-Identifier: BSD-3-Clause
#include "cli/commands.hpp"

#include "check/command.hpp"

namespace ilaw::host {

void add_check(CLI::App& app, int& code) {
  CLI::App* command =
      app.add_subcommand("check", "Check a library of laws against the contract, rule by rule");
  const auto run = check::add_options(*command);
  command->footer(
      "Exit codes: 0 no rule is broken; 1 some are; 2 bad usage.\n"
      "Example: ilaw check ./build/lib/ilaw/my_law.so --junit check.xml");
  command->callback([run, &code] { code = run(); });
}

}  // namespace ilaw::host
