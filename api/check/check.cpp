// SPDX-License-Identifier: BSD-3-Clause
#include "check/check.hpp"

#include "check/rule.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstring>
#include <exception>
#include <functional>
#include <mutex>
#include <string_view>
#include <thread>

namespace ilaw::check {

// What a child process returns.
struct Left {
  Finding finding{};             // seen is empty where the rule holds
  std::string why{}, missing{};  // it is not judged; there is no such library
  std::string path{};            // of the library
  std::vector<std::string> laws{};
  Reach reach{};
};
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(NamedArray, name, values)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Finding, seen, allowed, setting, arrays)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Range, least, largest, changed)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Reach, steps, statuses, states)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Left, finding, why, missing, path, laws, reach)

namespace {

using nlohmann::json;

using Checksum = std::size_t;
Checksum checksum_of(const char* begin, std::size_t size) {
  return std::hash<std::string_view>{}({begin, size});
}

// CBOR keeps all bits of a number, and any text. A checksum stands before it, since a library may write over
// what its process leaves, and nlohmann's parser of CBOR calls itself for each level of depth.
std::string packed(const Left& left) {
  std::string bytes;
  json::to_cbor(left, bytes);
  const Checksum sum = checksum_of(bytes.data(), bytes.size());
  return std::string(reinterpret_cast<const char*>(&sum), sizeof sum) + bytes;
}

Left unpacked(const std::string& bytes) {
  Checksum sum = 0;
  if (bytes.size() > sizeof sum) {
    std::memcpy(&sum, bytes.data(), sizeof sum);
    if (sum == checksum_of(&bytes[sizeof sum], bytes.size() - sizeof sum))
      return json::from_cbor(bytes.begin() + sizeof sum, bytes.end()).get<Left>();
  }
  return {.finding = {"the library wrote over the result of the check", "that it writes to its own memory"}};
}

// In the child.
std::string judged(const std::string& file, const std::string& law, const Rule& rule, std::uint64_t seed,
                   const Options& options, const Part& part) {
  Left left;
  try {
    const ProcessState before_loading;
    calling("the loader");
    const ilaw::library library(file);
    keep_part(part);
    rule.judge.look({library, *library.law(law), seed, options.parameters, before_loading});
  } catch (const Finding& finding) {
    left.finding = finding;
  } catch (const NotJudged& reason) {
    left.why = reason.why;
  } catch (const ilaw::error& error) {
    left.finding = {error.what(), "a library that opens again"};
  }
  left.reach = reach_of_thread();
  return packed(left);
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

// Those that others need.
bool is_basic(const Rule& rule) {
  const std::string id = rule.id;
  return id == opens_id || id == creates_id || id == returns_id;
}

// A law's rules, the basic ones first.
struct LawCheck {
  void run() {
    const std::size_t first = outcomes.size();
    judge_all();
    if (returns) fuzz(first);
    for (std::size_t k = first; k < outcomes.size(); ++k) all.add(outcomes[k].reach);
    for (std::size_t k = first; k < outcomes.size(); ++k) {
      Outcome& outcome = outcomes[k];
      const bool moves = outcome.reach.steps > 0 && rule_of(outcome.rule).judge.needs == Needs::motion;
      if (outcome.verdict == Verdict::passed && moves) outcome.missing = missing_in(outcome.reach, all);
    }
  }

  void judge_all() {
    holds(creates_id, creates);
    if (creates) holds(returns_id, returns);
    std::vector<const Rule*> left;
    for (const Rule& rule : rules())
      if (wanted(rule, options) && !is_basic(rule)) left.push_back(&rule);
    const std::size_t first = outcomes.size();
    outcomes.resize(first + left.size());
    in_parallel(left.size(), [&](std::size_t k) {
      outcomes[first + k] = judge(*left[k]);
      progress.add(1.0);
    });
  }

  // Seed after seed for the rules that move nodes and are not broken, until the time is over.
  void fuzz(std::size_t first) {
    using Clock = std::chrono::steady_clock;
    const auto end = Clock::now() + std::chrono::duration<double>(60.0 * options.fuzz_minutes);
    std::uint64_t seed = *std::max_element(options.seeds.begin(), options.seeds.end());
    std::vector<Outcome*> left;
    for (std::size_t k = first; k < outcomes.size(); ++k)
      if (rule_of(outcomes[k].rule).judge.needs == Needs::motion) left.push_back(&outcomes[k]);
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
    const Outcome next = judge_with(seed, rule_of(outcome.rule), options.part);
    if (next.verdict == Verdict::broken)
      outcome = shrunken(next);
    else
      outcome.reach.add(next.reach);
  }

  // The same rule broken by fewer nodes in fewer steps.
  Outcome shrunken(Outcome found) const {
    constexpr std::size_t most_nodes = 512, most_steps = 16;
    Part part{numbers_below(most_nodes), numbers_below(most_steps)};
    const auto is_broken = [&] {
      const Outcome less = judge_with(found.seed, rule_of(found.rule), part);
      if (less.verdict == Verdict::broken) found = less;
      return less.verdict == Verdict::broken;
    };
    shrink(part.nodes, is_broken);
    shrink(part.steps, is_broken);
    shrink(part.nodes, is_broken);
    return found;
  }

  Outcome judge_with(std::uint64_t seed, const Rule& rule, const Part& part) const {
    const auto start = std::chrono::steady_clock::now();
    Outcome outcome =
        outcome_of(law, rule.id,
                   run_apart(options.limits, [&] { return judged(file, law, rule, seed, options, part); }));
    outcome.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    outcome.seed = seed;
    outcome.part = part;
    return outcome;
  }

  // The first finding, or what all seeds reached. A rule that one seed could judge is judged, unless another
  // one came to the limit of time.
  Outcome judge_apart(const Rule& rule) const {
    Outcome outcome = judge_with(options.seeds.at(0), rule, options.part);
    for (std::size_t k = 1; k < options.seeds.size() && rule.judge.needs == Needs::motion; ++k) {
      if (outcome.verdict == Verdict::broken || outcome.late) break;
      Outcome next = judge_with(options.seeds[k], rule, options.part);
      next.seconds += outcome.seconds;
      next.reach.add(outcome.reach);
      if (next.verdict == Verdict::not_judged && !next.late) next.verdict = outcome.verdict;
      outcome = std::move(next);
    }
    return outcome;
  }

  Outcome judge(const Rule& rule) const {
    const char* lacking = rule.judge.needs >= Needs::instance && !creates ? creates_id
                          : rule.judge.needs == Needs::motion && !returns ? returns_id
                                                                          : nullptr;
    if (lacking) return {law, rule.id, Verdict::not_judged, {}, std::string("needs ") + lacking};
    return judge_apart(rule);
  }

  // Kept in the outcomes where it was asked for, or is why others are not judged.
  void holds(const char* id, bool& found) {
    const Outcome outcome = judge_apart(rule_of(id));
    found = outcome.verdict != Verdict::broken;
    if (wanted(rule_of(id), options) || !found)
      outcomes.push_back(outcome);
    else
      all.add(outcome.reach);
  }

  const std::string &file, &law;
  const Options& options;
  std::vector<Outcome>& outcomes;
  Progress& progress;
  bool creates = false, returns = false;
  Reach all{};  // what the rules reached together
};

std::string describe(const std::string& name_or_path) {
  Left left;
  try {
    calling("the loader");
    const ilaw::library library(name_or_path);
    left.path = library.path();
    for (std::uint32_t k = 0; k < library.plugin().law_count; ++k)
      left.laws.emplace_back(library.plugin().laws[k]->id);
  } catch (const ilaw::error& error) {
    if (error.code() == ILAW_NOT_FOUND)
      left.missing = error.what();
    else
      left.finding = {error.what(), "a library that the loader opens"};
  }
  return packed(left);
}

// The library's path and its laws, as a child process found them.
Left open(const std::string& name_or_path, const Options& options, std::vector<Outcome>& outcomes) {
  const Ending ending = run_apart(options.limits, [&] { return describe(name_or_path); });
  Left left = ending.returned ? unpacked(ending.result) : Left{};
  if (!left.missing.empty()) throw UsageError(left.missing);
  const Outcome outcome = outcome_of("", opens_id, ending);
  if (outcome.verdict != Verdict::passed || wanted(rule_of(opens_id), options)) outcomes.push_back(outcome);
  return left;
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
    if (create(law, setup, values, refusal)) return "";
  return refusal.message.empty() ? "code " + std::to_string(refusal.code) : refusal.message;
}

void check_parameters(const Left& opened, const Options& options) {
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

void check_law(const Left& opened, const std::string& law) {
  if (law.empty() || opened.path.empty()) return;
  if (std::find(opened.laws.begin(), opened.laws.end(), law) != opened.laws.end()) return;
  std::string names;
  for (const std::string& name : opened.laws) names += (names.empty() ? "" : ", ") + name;
  throw UsageError("found law '" + law + "', expected one of " + opened.path + ": " + names);
}

}  // namespace

Outcome outcome_of(const std::string& law, const std::string& rule, const Ending& ending) {
  Outcome outcome{law, rule, Verdict::passed};
  outcome.late = ending.late;
  if (ending.late) {
    outcome.why = "took longer than the limit of time";
  } else if (!ending.returned) {
    const std::string call = ending.call.empty() ? "the library" : ending.call;
    outcome.finding = {call + " " + ending.how, "that it returns"};
  } else {
    const Left left = unpacked(ending.result);
    outcome.why = left.why;
    outcome.finding = left.finding;
    outcome.reach = left.reach;
  }
  if (!outcome.why.empty()) outcome.verdict = Verdict::not_judged;
  if (outcome.finding.seen.empty()) return outcome;
  outcome.verdict = Verdict::broken;
  if (outcome.finding.setting.empty()) outcome.finding.setting = ending.setting;
  if (!ending.printed.empty()) outcome.finding.seen += "; printed: " + ending.printed;
  return outcome;
}

std::vector<Outcome> check(const std::string& name_or_path, const Options& options) {
  check_usage(options);
  std::vector<Outcome> outcomes;
  const Left opened = open(name_or_path, options, outcomes);
  check_law(opened, options.law);
  check_parameters(opened, options);
  const auto is_chosen = [&](const std::string& law) { return options.law.empty() || options.law == law; };
  const auto laws = std::count_if(opened.laws.begin(), opened.laws.end(), is_chosen);
  const auto rules_of_law = std::count_if(rules().begin(), rules().end(), [&](const Rule& rule) {
    return wanted(rule, options) && !is_basic(rule);
  });
  Progress progress("check", "rules", static_cast<double>(laws * rules_of_law), options.progress);
  for (const std::string& law : opened.laws)
    if (is_chosen(law)) LawCheck{opened.path, law, options, outcomes, progress}.run();
  return outcomes;
}

}  // namespace ilaw::check
