// SPDX-License-Identifier: BSD-3-Clause
#include "check/report.hpp"

#include "check/rule.hpp"

#include <tinyxml2.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace ilaw::check {
namespace {

using nlohmann::ordered_json;

// An option with a list of numbers; empty without any.
std::string text_of_list(const char* option, const std::vector<std::size_t>& list) {
  std::string text;
  for (const std::size_t one : list) text += (text.empty() ? option : ",") + std::to_string(one);
  return text;
}

std::string repeat(const Checked& checked, const Outcome& outcome) {
  return "ilaw check " + checked.file + (outcome.law.empty() ? "" : " --law " + outcome.law) + " --only " +
         outcome.rule + " --seed " + std::to_string(outcome.seed) +
         text_of_list(" --nodes ", outcome.part.nodes) + text_of_list(" --steps ", outcome.part.steps) +
         (checked.parameters.empty() ? "" : " --parameters '" + checked.parameters + "'");
}

std::string text_of_seeds(const Checked& checked) {
  std::string text = checked.seeds.size() > 1 ? "seeds" : "seed";
  for (std::size_t k = 0; k < checked.seeds.size(); ++k)
    text += (k ? ", " : " ") + std::to_string(checked.seeds[k]);
  return text;
}

std::string text_of_values(const std::vector<double>& values) {
  std::string text;
  for (const double value : values) text += (text.empty() ? "" : ", ") + text_of(value);
  return text;
}

std::string text_of_finding(const Checked& checked, const Outcome& outcome, const std::string& indent) {
  const Finding& finding = outcome.finding;
  std::string text =
      indent + "seen:    " + finding.seen + "\n" + indent + "allowed: " + finding.allowed + "\n";
  if (!finding.setting.empty()) text += indent + "with:    " + finding.setting + "\n";
  for (const NamedArray& array : finding.arrays)
    text += indent + "         " + array.name + " = " + text_of_values(array.values) + "\n";
  return text + indent + "repeat:  " + repeat(checked, outcome) + "\n";
}

std::size_t count(const Checked& checked, Verdict verdict) {
  return static_cast<std::size_t>(
      std::count_if(checked.outcomes.begin(), checked.outcomes.end(),
                    [verdict](const Outcome& outcome) { return outcome.verdict == verdict; }));
}

// Rules by law and by what they have in common, a line for each, with the first few of them.
using Grouped = std::map<std::pair<std::string, std::string>, std::vector<std::string>>;
std::string lines_of(const Grouped& rules, const char* what, std::size_t most_named) {
  std::string text;
  for (const auto& [of, listed] : rules) {
    text += joined("  ", what, ", ", of.first, of.first.empty() ? "" : ": ", of.second, ": ");
    for (std::size_t k = 0; k < std::min(most_named, listed.size()); ++k) text += (k ? ", " : "") + listed[k];
    if (listed.size() > most_named) text += joined(" and ", listed.size() - most_named, " more");
    text += "\n";
  }
  return text;
}

// The rules that were not judged, by reason; statuses and states that rules did not reach. The JSON has all
// of them by rule.
std::string text_of_not_judged(const Checked& checked) {
  constexpr std::size_t most_named = 4;
  Grouped unjudged, missing;
  for (const Outcome& outcome : checked.outcomes) {
    if (outcome.verdict == Verdict::not_judged) unjudged[{outcome.law, outcome.why}].push_back(outcome.rule);
    for (const std::string& one : outcome.missing) missing[{outcome.law, one}].push_back(outcome.rule);
  }
  return lines_of(unjudged, "not judged", rules().size()) + lines_of(missing, "not judged there", most_named);
}

ordered_json number_or_text(double value) {
  if (std::isfinite(value)) return value;
  return std::isnan(value) ? "nan" : value > 0.0 ? "inf" : "-inf";
}

ordered_json json_of(const Outcome& outcome) {
  ordered_json statuses = ordered_json::object(), states = ordered_json::object();
  for (std::size_t k = 0; k < outcome.reach.statuses.size(); ++k)
    if (outcome.reach.statuses[k] > 0) statuses[name_of_status(k)] = outcome.reach.statuses[k];
  for (const auto& [name, range] : outcome.reach.states)
    states[name] = {{"least", number_or_text(range.least)},
                    {"largest", number_or_text(range.largest)},
                    {"changed", range.changed}};
  return {{"node_steps", outcome.reach.steps},
          {"statuses", statuses},
          {"states", states},
          {"not_judged_there", outcome.missing}};
}

}  // namespace

bool Checked::all_passed() const { return count(*this, Verdict::broken) == 0; }

std::string text_of(const Checked& checked) {
  std::string text;
  for (const Outcome& outcome : checked.outcomes) {
    if (outcome.verdict != Verdict::broken) continue;
    const Rule& rule = rule_of(outcome.rule);
    text += (outcome.law.empty() ? "" : outcome.law + ": ") + rule.id + ": " + rule.required + " (" +
            rule.source + ")\n" + text_of_finding(checked, outcome, "  ");
  }
  text += checked.file + ": " + std::to_string(count(checked, Verdict::passed)) + " passed, " +
          std::to_string(count(checked, Verdict::broken)) + " broken, " +
          std::to_string(count(checked, Verdict::not_judged)) + " not judged (" + text_of_seeds(checked) +
          ")\n";
  return text + text_of_not_judged(checked);
}

std::string json_of(const Checked& checked) {
  ordered_json all = ordered_json::array();
  for (const Outcome& outcome : checked.outcomes) {
    const Rule& rule = rule_of(outcome.rule);
    ordered_json one = {{"rule", rule.id}, {"law", outcome.law}};
    one["result"] = outcome.verdict == Verdict::passed   ? "passed"
                    : outcome.verdict == Verdict::broken ? "broken"
                                                         : "not judged";
    if (outcome.verdict == Verdict::not_judged) one["why"] = outcome.why;
    if (outcome.reach.steps > 0) one["reached"] = json_of(outcome);
    if (outcome.verdict == Verdict::broken) {
      ordered_json arrays = ordered_json::object();
      for (const NamedArray& array : outcome.finding.arrays) {
        arrays[array.name] = ordered_json::array();
        for (const double value : array.values) arrays[array.name].push_back(number_or_text(value));
      }
      one.update({{"required", rule.required},
                  {"source", rule.source},
                  {"seen", outcome.finding.seen},
                  {"allowed", outcome.finding.allowed},
                  {"setting", outcome.finding.setting},
                  {"arrays", arrays},
                  {"seed", outcome.seed},
                  {"repeat", repeat(checked, outcome)}});
    }
    all.push_back(one);
  }
  return all.dump(2, ' ', false, ordered_json::error_handler_t::replace) + "\n";
}

std::string junit_of(const Checked& checked) {
  tinyxml2::XMLDocument document;
  document.InsertFirstChild(document.NewDeclaration());
  tinyxml2::XMLElement* suite = document.NewElement("testsuite");
  document.InsertEndChild(suite);
  suite->SetAttribute("name", checked.file.c_str());
  suite->SetAttribute("tests", static_cast<unsigned>(checked.outcomes.size()));
  suite->SetAttribute("failures", static_cast<unsigned>(count(checked, Verdict::broken)));
  suite->SetAttribute("skipped", static_cast<unsigned>(count(checked, Verdict::not_judged)));
  for (const Outcome& outcome : checked.outcomes) {
    tinyxml2::XMLElement* one = suite->InsertNewChildElement("testcase");
    one->SetAttribute("classname", outcome.law.c_str());
    one->SetAttribute("name", outcome.rule.c_str());
    one->SetAttribute("time", outcome.seconds);
    if (outcome.verdict == Verdict::not_judged)
      one->InsertNewChildElement("skipped")->SetAttribute("message", outcome.why.c_str());
    if (outcome.verdict != Verdict::broken) continue;
    tinyxml2::XMLElement* failure = one->InsertNewChildElement("failure");
    failure->SetAttribute("message", outcome.finding.seen.c_str());
    failure->SetText(
        (std::string(rule_of(outcome.rule).required) + "\n" + text_of_finding(checked, outcome, "")).c_str());
  }
  tinyxml2::XMLPrinter printer;
  document.Print(&printer);
  return printer.CStr();
}

std::string table_of_rules() {
  std::string table = "| rule | what is required | where the contract says so |\n| --- | --- | --- |\n";
  for (const Rule& rule : rules())
    table += std::string("| `") + rule.id + "` | " + rule.required + " | " + rule.source + " |\n";
  return table;
}

}  // namespace ilaw::check
