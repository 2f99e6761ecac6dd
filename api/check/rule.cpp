// SPDX-License-Identifier: BSD-3-Clause
#include "check/rule.hpp"

#include "check/sandbox.hpp"

#include <algorithm>

namespace ilaw::check {
namespace {

constexpr std::size_t trials_wanted = 24;

Draw draw_of(const Subject& subject, std::size_t trial) { return Draw(subject.seed * 1000003U + trial); }

}  // namespace

const std::vector<Rule>& rules() {
  static const std::vector<Rule> all = [] {
    std::vector<Rule> made;
    for (const auto part : {description_rules, parameter_rules, setup_rules, call_rules, purity_rules,
                            independence_rules, memory_rules, quiet_rules, float_rules, bad_input_rules,
                            state_rules, result_rules, energy_rules, symmetry_rules}) {
      const std::vector<Rule> rules_of_part = part();
      made.insert(made.end(), rules_of_part.begin(), rules_of_part.end());
    }
    return made;
  }();
  return all;
}

const Rule& rule_of(const std::string& id) {
  return *std::find_if(rules().begin(), rules().end(), [&](const Rule& rule) { return id == rule.id; });
}

void for_trials(const Subject& subject, const Look& look, const char* otherwise) {
  const std::vector<Setup> setups = setups_of(subject.law);
  const std::size_t count = std::max(setups.size(), trials_wanted);
  bool judged = false;
  for (std::size_t k = 0; k < count; ++k) {
    const Setup& setup = setups[k % setups.size()];
    Draw draw = draw_of(subject, k);
    const std::optional<Values> values = values_of(subject, setup, draw);
    if (!values) continue;
    const Trial trial(subject.law, setup, *values);
    forget_states();
    set_setting(trial.text());
    judged = look(trial, draw) || judged;
  }
  if (!judged) throw NotJudged{otherwise};
}

Judge on_trials(const Look& look, const char* otherwise) {
  return {Needs::motion, [=](const Subject& subject) { for_trials(subject, look, otherwise); }};
}

Judge on_instances(const Look& look, const char* otherwise) {
  return {Needs::instance, on_trials(look, otherwise).look};
}

Judge on_trials_per_node_too(const Look& look, const char* otherwise) {
  return on_trials(
      [look](const Trial& trial, Draw& draw) {
        const bool judged = look(trial, draw);
        const std::optional<Values> values = given_per_node(trial);
        if (!values) return judged;
        const Trial varied(trial.law, trial.setup, *values);
        set_setting(varied.text());
        return look(varied, draw) || judged;
      },
      otherwise);
}

std::optional<Values> values_of(const Subject& subject, const Setup& setup, Draw& draw) {
  if (!subject.given) return draw_values(subject.law, setup, draw);
  Values values = *subject.given;
  for (Value& value : values) {  // so that it may be given per node, too
    const ilaw_parameter* p = parameter_of(subject.law, value.name);
    if (p && in_range(*p, setup.rounded(value.number))) value.number = setup.rounded(value.number);
  }
  return create(subject.law, setup, values) ? std::optional(values) : std::nullopt;
}

Trial any_trial(const Subject& subject) {
  const std::vector<Setup> setups = setups_of(subject.law);
  for (std::size_t k = 0; k < setups.size(); ++k) {
    Draw draw = draw_of(subject, k);
    if (const std::optional<Values> values = values_of(subject, setups[k], draw))
      return Trial(subject.law, setups[k], *values);
  }
  throw NotJudged{"the law accepted no parameters"};
}

void expect_refused(const Trial& trial, const Values& values, ilaw_result code, const std::string& what,
                    const std::function<void(SetupStruct& given)>& spoil) {
  SetupStruct given(trial.setup, values);
  if (spoil) spoil(given);
  const std::string setting = joined(text_of(trial.setup), "; ", text_of(values)),
                    allowed = joined(code == ILAW_INVALID_PARAMETER  ? "ILAW_INVALID_PARAMETER ("
                                     : code == ILAW_INVALID_ARGUMENT ? "ILAW_INVALID_ARGUMENT ("
                                                                     : "ILAW_UNSUPPORTED (",
                                     code, ")");
  set_setting(setting);
  Refusal refusal{};
  if (create(trial.law, given.given, refusal))
    throw Finding{joined("create accepted ", what), allowed, setting};
  if (refusal.code != code)
    throw Finding{joined("create refused ", what, " with code ", refusal.code, ": ", refusal.message),
                  allowed, setting};
}

}  // namespace ilaw::check
