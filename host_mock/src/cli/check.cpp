// `ilaw check`: whether a library keeps the contract, rule by rule.
// SPDX-License-Identifier: BSD-3-Clause
#include "cli/commands.hpp"

#include "base/exit_code.hpp"
#include "base/files.hpp"
#include "check/report.hpp"
#include "cli/terminal.hpp"

#include <cstdio>
#include <filesystem>
#include <string>

namespace ilaw::host {
namespace {

struct CheckOptions {
  std::string file, junit;
  check::Options check;
  bool as_json = false, rules = false;
};

// Whole or not at all. What is no file, such as a device, would be replaced by one.
int write_report(const check::Checked& checked, const std::string& file) {
  const std::filesystem::file_status status = std::filesystem::symlink_status(file);
  if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status)) {
    complain(file + ": not a regular file; expected a new or an existing file for the report");
    return exit_bad_input;
  }
  try {
    AtomicFile report(file);
    report.stream() << check::junit_of(checked);
    report.commit();
  } catch (const WriteError& error) {
    complain(error.what());
    return exit_failed;
  }
  return exit_done;
}

int check_library(const CheckOptions& options) {
  if (options.rules) {
    std::fputs(check::table_of_rules().c_str(), stdout);
    return exit_done;
  }
  if (options.file.empty()) {
    complain("found no library, expected one to check, or --rules");
    return exit_bad_input;
  }
  check::Checked checked{options.file, options.check.seed, {}};
  try {
    checked.outcomes = check::check(options.file, options.check);
  } catch (const check::UsageError& error) {
    complain(error.what());
    return exit_bad_input;
  }
  if (!options.junit.empty())
    if (const int code = write_report(checked, options.junit); code != exit_done) return code;
  std::fputs((options.as_json ? check::json_of(checked) : check::text_of(checked)).c_str(), stdout);
  return checked.all_passed() ? exit_done : exit_failed;
}

}  // namespace

void add_check(CLI::App& app, Action& chosen) {
  const auto options = std::make_shared<CheckOptions>();
  CLI::App* command =
      app.add_subcommand("check", "Check a library of laws against the contract, rule by rule");
  command->add_option("library", options->file, "Path of a library, or name of a law");
  command->add_option("--law", options->check.law, "Only this law of the library");
  command->add_option("--only", options->check.only, "Only this rule; may be repeated")
      ->take_all()
      ->allow_extra_args(false);
  command
      ->add_option("--seed", options->check.seed,
                   "Seed of the random numbers: the same seed, the same findings")
      ->capture_default_str();
  command->add_option("--limit", options->check.limits.seconds, "Seconds for each rule and law")
      ->check(number_from(0.1, 3600.0))
      ->capture_default_str();
  command->add_flag("--json", options->as_json, "Print an array of objects, one for each rule and law");
  command->add_option("--junit", options->junit, "Also write a report in JUnit's XML");
  command->add_flag("--rules", options->rules, "Print the table of rules");
  command->footer(
      "Exit codes: 0 no rule is broken; 1 some are; 2 bad usage.\n"
      "Example: ilaw check ./build/lib/ilaw/my_law.so --junit check.xml");
  command->callback([options, &chosen] { chosen = [options] { return check_library(*options); }; });
}

}  // namespace ilaw::host
