// check.hpp - all rules over all laws of a library, each in a process of its own.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "check/finding.hpp"
#include "check/progress.hpp"
#include "check/reach.hpp"
#include "check/sandbox.hpp"
#include "check/script.hpp"

#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

namespace ilaw::check {

struct Options {
  std::string law;                // empty: all of the library
  std::vector<std::string> only;  // ids of rules; empty: all
  // Rules that move nodes are judged with all seeds, others with the first.
  std::vector<std::uint64_t> seeds{1, 2, 3};
  std::optional<Values> parameters;  // of every instance of the law, instead of drawn ones
  Limits limits;                     // of a rule, a law and a seed
  Part part;                         // of random motions that rules judge by any part
  double fuzz_minutes = 0.0;         // of each law: seeds after those above, for all rules that move nodes
  ProgressForm progress = ProgressForm::none;
};

enum class Verdict { passed, broken, not_judged };

struct Outcome {
  std::string law, rule;  // law empty: of the library
  Verdict verdict;
  Finding finding{};       // where it is broken
  std::string why{};       // where it is not judged
  bool late = false;       // not judged, because of the limit of time
  std::uint64_t seed = 0;  // of the finding
  Part part{};             // that has the finding, too
  double seconds = 0.0;
  Reach reach{};
  // Statuses and state variables of the law that this rule did not reach, where it needs motion.
  std::vector<std::string> missing{};
};

// What the end of a child process says of a rule.
Outcome outcome_of(const std::string& law, const std::string& rule, const Ending& ending);

// The library is not there, or has no such law; there is no such rule.
class UsageError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

std::vector<Outcome> check(const std::string& name_or_path, const Options& options);

}  // namespace ilaw::check
