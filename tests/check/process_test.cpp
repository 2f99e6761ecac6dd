// The checker on what a library shows to others, and what it changes of its process: each change is named,
// from what to what.
#include "check_sample.hpp"

#include <gtest/gtest.h>
#include <sched.h>
#include <sys/stat.h>

#include <utility>

namespace ilaw::check {
namespace {

// "breaks" is the rule, and after a colon what it is broken with.
void expect_change_named(const std::string& breaks, const std::string& words) {
  const Checked checked = check_sample(breaks, only({"loading-process", "calls-process"}));
  EXPECT_EQ(broken(checked), Names{breaks.substr(0, breaks.find(':'))}) << breaks << ": " << text_of(checked);
  EXPECT_NE(text_of(checked).find(words), std::string::npos) << breaks << ": " << text_of(checked);
}

TEST(Process, ChangesAreNamed) {
  const std::pair<const char*, const char*> ways[] = {
      {"loading-process", "umask from 0022 to 0077"},
      {"loading-process: entry", "umask from 0022 to 0077"},
      {"loading-process: locale", "locale from C to C.UTF-8"},
      {"loading-process: locale of thread", "locale of the thread from that of the process to 0x"},
      {"loading-process: variable", "environment variable HOME from "},
      {"loading-process: new variable", "environment variable ILAW_SAMPLE_WAS_HERE from none to '1'"},
      {"loading-process: descriptor", " from none to /dev/null"},
      {"loading-process: directory", "current directory from "},
      {"loading-process: ignored signal", "handler of SIGINT from default to ignored"},
      {"loading-process: handled signal", "handler of SIGWINCH from default to the function 0x"},
      {"loading-process: blocked signal", "blocked signals from none to SIGINT"},
      {"loading-process: stack of handlers", "stack of signal handlers from 0x"},
      {"loading-process: timer", "timer of SIGALRM from not set to set"},
      {"loading-process: limit", "limit of descriptors from "},
      {"loading-process: personality", "personality from 0x"},
      {"loading-process: thread", "number of threads from 1 to 2"},
      {"calls-process: refusal: descriptor", "create or destroy changed descriptor "},
      {"calls-process: info: timer", "create or destroy changed timer"},
      {"calls-process: destroy: handled signal", "create or destroy changed handler of SIGWINCH"},
      {"calls-process: evaluate: variable", "evaluate changed environment variable HOME"},
      {"calls-process: evaluate: rounding", "rounding mode from to nearest to upward"}};
  const mode_t mask = umask(0022);
  for (const auto& [breaks, words] : ways) expect_change_named(breaks, words);
  umask(mask);
}

TEST(Process, ProcessorsAreNamed) {
  cpu_set_t processors;
  CPU_ZERO(&processors);
  ASSERT_EQ(sched_getaffinity(0, sizeof processors, &processors), 0);
  if (CPU_COUNT(&processors) < 2) GTEST_SKIP() << "a machine of one processor";
  expect_change_named("loading-process: processors", "number of processors to run on from ");
}

#if defined(__x86_64__)
TEST(Process, ModesOfNumbersAreNamed) {
  expect_change_named("loading-process: x87 registers", "number of x87 registers in use from 0 to ");
  expect_change_named("calls-process: evaluate: x87 registers",
                      "evaluate changed number of x87 registers in use from 0 to 8");
  expect_change_named("calls-process: evaluate: x87 control",
                      "evaluate changed x87 control word from 0x37f to 0x27f");
  expect_change_named("calls-process: initialise: flushing",
                      "initialise changed MXCSR without flags from 0x1f80 to 0x9fc0");
}

// The loader refuses such a library itself.
TEST(Process, ModesOfNumbersAreKeptByLoading) {
  for (const char* breaks :
       {"loading-process: rounding", "loading-process: flushing", "loading-process: x87 control"}) {
    const Checked checked = check_sample(breaks, only({"loading-process"}));
    EXPECT_EQ(broken(checked), Names{"library-opens"}) << breaks;
    EXPECT_NE(text_of(checked).find("changed how the processor rounds"), std::string::npos) << breaks;
  }
}
#endif

TEST(Exports, AreNamed) {
  const Checked checked = check_sample("exports-entry", only({"exports-entry"}));
  ASSERT_EQ(broken(checked), Names{"exports-entry"});
  const std::string& seen = checked.outcomes.at(0).finding.seen;
  EXPECT_NE(seen.find("exports 3 symbols: "), std::string::npos) << seen;
  EXPECT_NE(seen.find("calls() (weak)"), std::string::npos) << seen;
  EXPECT_NE(seen.find("count_call"), std::string::npos) << seen;
#if defined(__GNUC__) && !defined(__clang__)
  EXPECT_NE(seen.find("calls()::count (unique in the process)"), std::string::npos) << seen;
#endif
}

}  // namespace
}  // namespace ilaw::check
