// SPDX-License-Identifier: BSD-3-Clause
#include "check/check.hpp"

#include "check/rule.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <exception>
#include <mutex>
#include <thread>

namespace ilaw::check {

// As a child process returns them.
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(NamedArray, name, values)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Finding, seen, allowed, setting, arrays)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Range, least, largest, changed)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Reach, steps, statuses, states)

namespace {

using nlohmann::json;

// Keeps all bits of a number, and any text.
std::string packed(const json& values) {
  std::string bytes;
  json::to_cbor(values, bytes);
  return bytes;
}

// In the child. Empty where the rule holds.
json verdict_of(const std::string& file, const std::string& law, const Rule& rule, std::uint64_t seed,
                const Options& options) {
  try {
    const ProcessState before_loading;
    calling("the loader");
    const ilaw::library library(file);
    keep_part(options.part);
    rule.judge({library, *library.law(law), seed, options.parameters, before_loading});
    return json::object();
  } catch (const Finding& finding) {
    return finding;
  } catch (const NotJudged& reason) {
    return {{"why", reason.why}};
  } catch (const ilaw::error& error) {
    return Finding{error.what(), "a library that opens again", {}, {}};
  }
}

std::string judged(const std::string& file, const std::string& law, const Rule& rule, std::uint64_t seed,
                   const Options& options) {
  json text = verdict_of(file, law, rule, seed, options);
  text["reach"] = reach_of_thread();
  return packed(text);
}

Outcome outcome_of(const std::string& law, const Rule& rule, const Ending& ending) {
  Outcome outcome{law, rule.id, Verdict::passed, {}, {}};
  if (ending.late) {
    outcome.verdict = Verdict::not_judged;
    outcome.why = "took longer than the limit of time";
    outcome.late = true;
  } else if (!ending.returned) {
    outcome.verdict = Verdict::broken;
    const std::string call = ending.call.empty() ? "the library" : ending.call;
    outcome.finding = {call + " " + ending.how, "that it returns", ending.setting, {}};
  } else {
    const json text = json::from_cbor(ending.result);
    outcome.verdict = text.contains("why")    ? Verdict::not_judged
                      : text.contains("seen") ? Verdict::broken
                                              : Verdict::passed;
    if (text.contains("why")) outcome.why = text.at("why");
    if (text.contains("seen")) outcome.finding = text;
    if (text.contains("reach")) outcome.reach = text.at("reach");
    if (outcome.verdict == Verdict::broken && outcome.finding.setting.empty())
      outcome.finding.setting = ending.setting;
  }
  if (outcome.verdict == Verdict::broken && !ending.printed.empty())
    outcome.finding.seen += "; printed: " + ending.printed;
  return outcome;
}

Outcome judge_with(std::uint64_t seed, const std::string& file, const std::string& law, const Rule& rule,
                   const Options& options) {
  const auto start = std::chrono::steady_clock::now();
  const Ending ending = run_apart(options.limits, [&] { return judged(file, law, rule, seed, options); });
  Outcome outcome = outcome_of(law, rule, ending);
  outcome.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  outcome.seed = seed;
  outcome.part = options.part;
  return outcome;
}

// Leaves out halves, quarters and so on of a list from its end, as long as "is_enough" says so of the rest.
template <class Enough>
void shrink(std::vector<std::size_t>& list, Enough is_enough) {
  for (std::size_t size = list.size() / 2; size > 0; size /= 2)
    for (std::size_t end = list.size(); end > 0 && list.size() > size;) {
      const std::vector<std::size_t> before = list;
      const std::size_t begin = end - std::min(size, end);
      const auto at = [&](std::size_t k) { return list.begin() + static_cast<std::ptrdiff_t>(k); };
      list.erase(at(begin), at(end));
      if (!is_enough()) list = before;
      end = begin;
    }
}

// The same rule broken by fewer nodes in fewer steps.
Outcome shrunken(Outcome found, const std::string& file, const std::string& law, const Rule& rule,
                 Options options) {
  constexpr std::size_t most_nodes = 512, most_steps = 16;
  Part& part = options.part;
  part = {numbers_below(most_nodes), numbers_below(most_steps)};
  const auto is_broken = [&] {
    const Outcome less = judge_with(found.seed, file, law, rule, options);
    if (less.verdict == Verdict::broken) found = less;
    return less.verdict == Verdict::broken;
  };
  shrink(part.nodes, is_broken);
  shrink(part.steps, is_broken);
  shrink(part.nodes, is_broken);
  return found;
}

// The first finding, or what all seeds reached. A rule that one seed could judge is judged, unless another
// one came to the limit of time.
Outcome judge_apart(const std::string& file, const std::string& law, const Rule& rule,
                    const Options& options) {
  Outcome outcome = judge_with(options.seeds.at(0), file, law, rule, options);
  for (std::size_t k = 1; k < options.seeds.size() && rule.needs == Needs::motion; ++k) {
    if (outcome.verdict == Verdict::broken || outcome.late) break;
    Outcome next = judge_with(options.seeds[k], file, law, rule, options);
    next.seconds += outcome.seconds;
    next.reach.add(outcome.reach);
    if (next.verdict == Verdict::not_judged && !next.late) next.verdict = outcome.verdict;
    outcome = std::move(next);
  }
  return outcome;
}

// Calls work(0) to work(count - 1), as many at a time as there are processors. Each waits for a process of
// its own.
template <class Work>
void in_parallel(std::size_t count, Work work) {
  std::atomic<std::size_t> next{0};
  std::mutex failing;
  std::exception_ptr failure;
  const auto take = [&] {
    for (std::size_t k = next++; k < count; k = next++) try {
        work(k);
      } catch (...) {
        const std::lock_guard lock(failing);
        failure = std::current_exception();
      }
  };
  std::vector<std::thread> threads;
  for (unsigned k = 1; k < std::max(1U, std::thread::hardware_concurrency()); ++k) threads.emplace_back(take);
  take();
  for (std::thread& thread : threads) thread.join();
  if (failure) std::rethrow_exception(failure);
}

bool wanted(const Rule& rule, const Options& options) {
  return options.only.empty() ||
         std::find(options.only.begin(), options.only.end(), rule.id) != options.only.end();
}

// A law's rules, those first that others need.
class LawCheck {
 public:
  LawCheck(std::string file, std::string law, const Options& options, std::vector<Outcome>& outcomes,
           Progress& progress)
      : file_(std::move(file)),
        law_(std::move(law)),
        options_(options),
        outcomes_(outcomes),
        progress_(progress) {}

  void run() {
    const std::size_t first = outcomes_.size();
    judge_all();
    if (returns_) fuzz(first);
    for (std::size_t k = first; k < outcomes_.size(); ++k) all_.add(outcomes_[k].reach);
    for (std::size_t k = first; k < outcomes_.size(); ++k) {
      Outcome& outcome = outcomes_[k];
      const bool moves = outcome.reach.steps > 0 && rule_of(outcome.rule).needs == Needs::motion;
      if (outcome.verdict == Verdict::passed && moves) outcome.missing = missing_in(outcome.reach, all_);
    }
  }

  static bool is_basic(const Rule& rule) {
    return rule.id == std::string(opens_id) || rule.id == std::string(creates_id) ||
           rule.id == std::string(returns_id);
  }

 private:
  void judge_all() {
    holds(creates_id, creates_);
    if (creates_) holds(returns_id, returns_);
    std::vector<const Rule*> left;
    for (const Rule& rule : rules())
      if (wanted(rule, options_) && !is_basic(rule)) left.push_back(&rule);
    const std::size_t first = outcomes_.size();
    outcomes_.resize(first + left.size());
    in_parallel(left.size(), [&](std::size_t k) {
      outcomes_[first + k] = judge(*left[k]);
      progress_.add(1.0);
    });
  }

  // Seed after seed for the rules that move nodes and are not broken, until the time is over.
  void fuzz(std::size_t first) {
    using Clock = std::chrono::steady_clock;
    const auto end = Clock::now() + std::chrono::duration<double>(60.0 * options_.fuzz_minutes);
    std::uint64_t seed = *std::max_element(options_.seeds.begin(), options_.seeds.end());
    std::vector<Outcome*> left;
    for (std::size_t k = first; k < outcomes_.size(); ++k)
      if (rule_of(outcomes_[k].rule).needs == Needs::motion) left.push_back(&outcomes_[k]);
    for (;;) {
      std::erase_if(left, [](const Outcome* one) { return one->verdict == Verdict::broken; });
      if (left.empty() || Clock::now() >= end) return;
      ++seed;
      in_parallel(left.size(), [&](std::size_t k) {
        if (Clock::now() < end) judge_once_more(*left[k], seed);
      });
    }
  }

  void judge_once_more(Outcome& outcome, std::uint64_t seed) const {
    const Rule& rule = rule_of(outcome.rule);
    const Outcome next = judge_with(seed, file_, law_, rule, options_);
    if (next.verdict == Verdict::broken)
      outcome = shrunken(next, file_, law_, rule, options_);
    else
      outcome.reach.add(next.reach);
  }

  Outcome judge(const Rule& rule) const {
    const char* lacking = rule.needs >= Needs::instance && !creates_ ? creates_id
                          : rule.needs == Needs::motion && !returns_ ? returns_id
                                                                     : nullptr;
    if (lacking) return {law_, rule.id, Verdict::not_judged, {}, std::string("needs ") + lacking};
    return judge_apart(file_, law_, rule, options_);
  }

  // Kept in the outcomes where it was asked for, or is why others are not judged.
  void holds(const char* id, bool& found) {
    const Outcome outcome = judge_apart(file_, law_, rule_of(id), options_);
    found = outcome.verdict != Verdict::broken;
    if (wanted(rule_of(id), options_) || !found)
      outcomes_.push_back(outcome);
    else
      all_.add(outcome.reach);
  }

  std::string file_, law_;
  const Options& options_;
  std::vector<Outcome>& outcomes_;
  Progress& progress_;
  bool creates_ = false, returns_ = false;
  Reach all_;  // what the rules reached together
};

// The library's path and its laws, as a child process found them.
struct Opened {
  std::string path;
  std::vector<std::string> laws;
};

std::string describe(const std::string& name_or_path) {
  try {
    calling("the loader");
    const ilaw::library library(name_or_path);
    json laws = json::array();
    for (std::uint32_t k = 0; k < library.plugin().law_count; ++k)
      laws.push_back(library.plugin().laws[k]->id);
    return packed({{"path", library.path()}, {"laws", laws}});
  } catch (const ilaw::error& error) {
    if (error.code() == ILAW_NOT_FOUND) return packed({{"missing", error.what()}});
    return packed(Finding{error.what(), "a library that the loader opens", {}, {}});
  }
}

Opened open(const std::string& name_or_path, const Options& options, std::vector<Outcome>& outcomes) {
  const Rule& rule = rule_of(opens_id);
  const Ending ending = run_apart(options.limits, [&] { return describe(name_or_path); });
  const json text = ending.returned ? json::from_cbor(ending.result) : json::object();
  if (text.contains("missing")) throw UsageError(text.at("missing").get<std::string>());
  if (!text.contains("laws")) {
    outcomes.push_back(outcome_of("", rule, ending));
    return {};
  }
  if (wanted(rule, options)) outcomes.push_back({"", rule.id, Verdict::passed, {}, {}});
  return {text.at("path"), text.at("laws")};
}

void check_usage(const Options& options) {
  for (const std::string& id : options.only)
    if (std::none_of(rules().begin(), rules().end(), [&](const Rule& rule) { return id == rule.id; }))
      throw UsageError("found rule '" + id + "', expected one that `ilaw check --rules` lists");
}

// In the child: why no setup of the law takes the parameters; empty where one does.
std::string refusal_of(const std::string& file, const std::string& name, const Values& values) {
  const ilaw::library library(file);
  const ilaw_law& law = *library.law(name);
  Refusal refusal{};
  for (const Setup& setup : setups_of(law))
    if (create(law, SetupStruct(setup, values).given, refusal)) return "";
  return refusal.message.empty() ? "code " + std::to_string(refusal.code) : refusal.message;
}

void check_parameters(const Opened& opened, const Options& options) {
  if (!options.parameters || opened.path.empty()) return;
  const std::string law = options.law.empty() && opened.laws.size() == 1 ? opened.laws[0] : options.law;
  if (law.empty())
    throw UsageError("found parameters for a library of " + std::to_string(opened.laws.size()) +
                     " laws, expected --law with them");
  const Ending ending =
      run_apart(options.limits, [&] { return refusal_of(opened.path, law, *options.parameters); });
  if (ending.returned && !ending.result.empty())
    throw UsageError("law '" + law + "' refuses the parameters: " + ending.result);
}

void check_law(const Opened& opened, const std::string& law) {
  if (law.empty() || opened.path.empty()) return;
  if (std::find(opened.laws.begin(), opened.laws.end(), law) != opened.laws.end()) return;
  std::string names;
  for (const std::string& name : opened.laws) names += (names.empty() ? "" : ", ") + name;
  throw UsageError("found law '" + law + "', expected one of " + opened.path + ": " + names);
}

}  // namespace

std::vector<Outcome> check(const std::string& name_or_path, const Options& options) {
  check_usage(options);
  std::vector<Outcome> outcomes;
  const Opened opened = open(name_or_path, options, outcomes);
  check_law(opened, options.law);
  check_parameters(opened, options);
  const auto is_chosen = [&](const std::string& law) { return options.law.empty() || options.law == law; };
  const auto laws = std::count_if(opened.laws.begin(), opened.laws.end(), is_chosen);
  const auto rules_of_law = std::count_if(rules().begin(), rules().end(), [&](const Rule& rule) {
    return wanted(rule, options) && !LawCheck::is_basic(rule);
  });
  Progress progress("check", "rules", static_cast<double>(laws * rules_of_law), options.progress);
  for (const std::string& law : opened.laws)
    if (is_chosen(law)) LawCheck(opened.path, law, options, outcomes, progress).run();
  return outcomes;
}

}  // namespace ilaw::check
