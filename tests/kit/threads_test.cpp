// Concurrent use: evaluate by one instance, open and close one library. A program of its own, so
// that the thread sanitizer need not build all others.
#include "kit_probe.hpp"
#include "mixed_nodes.hpp"

#include "support/law_cases.hpp"

#include <thread>

namespace ilaw::testing {
namespace {

template <class Task>
void run_in_threads(int count, const Task& task) {
  std::vector<std::thread> threads;
  for (int t = 0; t < count; ++t) threads.emplace_back([&task, t] { task(static_cast<std::size_t>(t)); });
  for (std::thread& thread : threads) thread.join();
}

class Threads : public ::testing::TestWithParam<LawCase> {};

TEST_P(Threads, ShareAnInstance) {
  const MixedNodes nodes(
      make_tested_law(GetParam().law,
                      SetupBuilder(GetParam().parameters, 3, ILAW_DELASSUS_SCALAR, ILAW_FRAME_LOCAL)),
      300);
  const MixedNodes reference = nodes.stepped();
  std::vector<MixedNodes> results(4, nodes);
  run_in_threads(4, [&](std::size_t t) { results[t] = nodes.stepped(); });
  for (const MixedNodes& mine : results) EXPECT_TRUE(mine == reference);
}

TEST_P(Threads, OpenAndCloseALibrary) {
  run_in_threads(4, [](std::size_t) {
    for (int k = 0; k < 20; ++k) {
      const ilaw::interface law = make_tested_law(
          GetParam().law, SetupBuilder(GetParam().parameters, 3, ILAW_DELASSUS_SCALAR, ILAW_FRAME_LOCAL));
      EXPECT_EQ(law.law().id, GetParam().law) << "k " << k;
    }
  });
}

INSTANTIATE_TEST_SUITE_P(Laws, Threads, ::testing::ValuesIn(law_cases("contract")), name_of_case);
INSTANTIATE_TEST_SUITE_P(Kit, Threads,
                         ::testing::Values(LawCase{"kit_probe", "kit_probe", probe_parameters, {}}),
                         name_of_case);

}  // namespace
}  // namespace ilaw::testing
