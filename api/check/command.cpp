// SPDX-License-Identifier: BSD-3-Clause
#include "check/command.hpp"

#include "check/report.hpp"

#include <nlohmann/json.hpp>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <string>

namespace ilaw::check {
namespace {

struct CommandLine {
  std::string file, junit, parameters;
  Options check;
  bool as_json = false, rules = false;
};

// Whole or not at all. A file that is no regular one, such as a device, would be replaced by one.
void write_report(const Checked& checked, const std::string& file) {
  const std::filesystem::file_status status = std::filesystem::symlink_status(file);
  if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status))
    throw UsageError(file + ": not a regular file; expected a new or an existing file for the report");
  const std::string partial = file + ".partial";
  std::ofstream report(partial, std::ios::binary | std::ios::trunc);
  report << junit_of(checked);
  report.close();
  std::error_code failed;
  if (report) std::filesystem::rename(partial, file, failed);
  if (report && !failed) return;
  std::filesystem::remove(partial, failed);
  throw std::runtime_error(file + ": cannot be written");
}

Value value_of(const std::string& name, const nlohmann::json& given) {
  Value value{name};
  if (given.is_number()) {
    value.number = given;
  } else if (given == "inf") {
    value.number = infinity;
  } else if (given.is_string()) {
    value.kind = ILAW_KIND_VALUE_TEXT;
    value.text = given;
  } else {
    throw UsageError("parameter '" + name + "' is " + given.dump() +
                     ", expected a number, \"inf\" or a text");
  }
  return value;
}

// A JSON object, or a file with one.
Values read_parameters(const std::string& text_or_file) {
  std::string text = text_or_file;
  if (text.find('{') == std::string::npos) {
    std::ifstream file(text);
    if (!file) throw UsageError(text + ": cannot be read, expected a file or a JSON object of parameters");
    text.assign(std::istreambuf_iterator<char>(file), {});
  }
  const nlohmann::json given = nlohmann::json::parse(text, nullptr, false);
  if (!given.is_object())
    throw UsageError("--parameters: found no JSON object, expected one such as '{\"friction\": 0.3}'");
  Values values;
  for (const auto& [name, value] : given.items()) values.push_back(value_of(name, value));
  return values;
}

int check_library(const CommandLine& line) {
  if (line.rules) {
    std::fputs(table_of_rules().c_str(), stdout);
    return 0;
  }
  if (line.file.empty()) throw UsageError("found no library, expected one to check, or --rules");
  Options options = line.check;
  if (!line.parameters.empty()) options.parameters = read_parameters(line.parameters);
  const Checked checked{line.file, options.seeds, check(line.file, options), line.parameters};
  if (!line.junit.empty()) write_report(checked, line.junit);
  std::fputs((line.as_json ? json_of(checked) : text_of(checked)).c_str(), stdout);
  return checked.all_passed() ? 0 : 1;
}

}  // namespace

CLI::Validator within(double least, double most) {
  const std::string range = "from " + CLI::detail::to_string(least) + " to " + CLI::detail::to_string(most);
  const auto complaint = [=](const std::string& found) -> std::string {
    double number = NAN;
    const bool is_number = CLI::detail::lexical_cast(found, number);
    if (is_number && number >= least && number <= most) return "";
    return "found '" + found + "', expected a number " + range;
  };
  return {complaint, range};
}

std::function<int()> add_options(CLI::App& command) {
  const auto line = std::make_shared<CommandLine>();
  command.add_option("library", line->file, "Path of a library, or name of a law");
  command.add_option("--law", line->check.law, "Only this law of the library");
  command.add_option("--only", line->check.only, "Only this rule; may be repeated")
      ->take_all()
      ->allow_extra_args(false);
  command.add_option("--seed", line->check.seeds, "Seed of the random numbers; may be repeated")
      ->take_all()
      ->allow_extra_args(false)
      ->capture_default_str();
  command.add_option("--parameters", line->parameters,
                     "Parameters instead of drawn ones: a JSON object, or a file with one");
  command
      .add_option("--limit", line->check.limits.seconds,
                  "Seconds of the processor for each rule and law, and for a call")
      ->check(within(0.1, 3600.0))
      ->capture_default_str();
  command
      .add_option("--fuzz", line->check.fuzz_minutes,
                  "Minutes for each law with further seeds; a finding is reduced to few nodes and steps")
      ->check(within(0.01, 10000.0));
  command
      .add_option("--nodes", line->check.part.nodes,
                  "Only these nodes of random motions, as findings name them")
      ->delimiter(',')
      ->allow_extra_args(false);
  command.add_option("--steps", line->check.part.steps, "Only these steps of random motions")
      ->delimiter(',')
      ->allow_extra_args(false);
  command.add_flag("--json", line->as_json, "Print an array of objects, one for each rule and law");
  command.add_option("--junit", line->junit, "Also write a report in JUnit's XML");
  command.add_flag("--rules", line->rules, "Print the table of rules");
  line->check.progress = ProgressForm::line;
  add_progress(command, line->check.progress);
  return [line] { return check_library(*line); };
}

}  // namespace ilaw::check
