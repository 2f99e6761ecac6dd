// rule.hpp - what a law must do: an id, one sentence, where the contract says so, and the function that
// looks.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "check/process.hpp"
#include "check/run.hpp"

#include <ilaw/loader.hpp>

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace ilaw::check {

// A law that is judged, by random numbers of this seed. given: parameters that replace the drawn ones.
struct Subject {
  const ilaw::library& library;
  const ilaw_law& law;
  std::uint64_t seed;
  const std::optional<Values>& given;
  const ProcessState& before_loading;
};

// Prerequisites for judging a rule.
enum class Needs { nothing, library, instance, motion };

// look throws Finding or NotJudged.
struct Judge {
  Needs needs;
  std::function<void(const Subject& subject)> look;
};

inline Judge needing(Needs needs, const std::function<void(const Subject& subject)>& look) {
  return {needs, look};
}

struct Rule {
  const char* id;
  const char* required;
  const char* source;
  Judge judge;
};

// The three that others need: Needs::library, instance and motion.
inline constexpr const char* opens_id = "library-opens";
inline constexpr const char* creates_id = "setups-served";
inline constexpr const char* returns_id = "functions-return";

const std::vector<Rule>& rules();
const Rule& rule_of(const std::string& id);  // of the rules

std::vector<Rule> description_rules();
std::vector<Rule> parameter_rules();
std::vector<Rule> setup_rules();
std::vector<Rule> call_rules();
std::vector<Rule> purity_rules();
std::vector<Rule> independence_rules();
std::vector<Rule> memory_rules();
std::vector<Rule> quiet_rules();
std::vector<Rule> float_rules();
std::vector<Rule> bad_input_rules();
std::vector<Rule> state_rules();
std::vector<Rule> result_rules();
std::vector<Rule> energy_rules();
std::vector<Rule> symmetry_rules();

// Whether a trial could be judged; if none could, the rule is not judged.
using Look = std::function<bool(const Trial& trial, Draw& draw)>;

// Calls look for trials in every setup, with parameters that the law accepts: the same ones for every rule.
void for_trials(const Subject& subject, const Look& look,
                const char* otherwise = "the law accepted no parameters");
Judge on_trials(const Look& look, const char* otherwise = "the law accepted no parameters");
// The same for a rule that needs no motion.
Judge on_instances(const Look& look, const char* otherwise = "the law accepted no parameters");

// As on_trials, and each trial again with what may be given per node given so.
Judge on_trials_per_node_too(const Look& look, const char* otherwise = "the law accepted no parameters");

// The given parameters where the law accepts them in this setup, or drawn ones.
std::optional<Values> values_of(const Subject& subject, const Setup& setup, Draw& draw);

// Some parameters that the law accepts, in the first setup that it serves.
Trial any_trial(const Subject& subject);

// Throws the finding where create does not refuse these values with the code. what, spoil: a mistake in their
// setup, as a finding names it.
void expect_refused(const Trial& trial, const Values& values, ilaw_result code,
                    const std::string& what = "them",
                    const std::function<void(SetupStruct& given)>& spoil = {});

}  // namespace ilaw::check
