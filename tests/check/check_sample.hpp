// The sample law, told to break a rule, and what the checker finds.
#pragma once

#include "check/report.hpp"

#include <cstdlib>
#include <set>
#include <string>
#include <vector>

namespace ilaw::check {

using Names = std::set<std::string>;

// Symbols are of the file: no variable hides them.
inline const char* file_that(const std::string& breaks) {
  return breaks == "exports-entry" ? ILAW_SAMPLE_SHARES : ILAW_SAMPLE;
}

inline Checked check_sample(const std::string& breaks, const Options& options) {
  setenv("ILAW_CHECK_BREAK", breaks.c_str(), 1);
  const std::string file = file_that(breaks);
  Checked checked{file, options.seeds, check(file, options)};
  unsetenv("ILAW_CHECK_BREAK");
  return checked;
}

inline Options only(const std::vector<std::string>& ids) {
  Options options;
  options.only = ids;
  options.limits.seconds = 30.0;  // a busy machine breaks no rule
  return options;
}

inline Names broken(const Checked& checked) {
  Names found;
  for (const Outcome& outcome : checked.outcomes)
    if (outcome.verdict == Verdict::broken) found.insert(outcome.rule);
  return found;
}

}  // namespace ilaw::check
