// Laws with a solver for any H: it solves nodes side by side, and leaves none to be solved one by one.
#include "support/law_cases.hpp"
#include "support/profile.hpp"

namespace ilaw::testing {
namespace {

std::vector<LawCase> cases_of_full_inertia() {
  std::vector<LawCase> cases;
  for (const std::string& law : laws_of_tree())
    for (const json& entry : section_of(law, "benchmarks")) {
      const json parameters = entry.value("parameters", json::object());
      const bool are_numbers = std::all_of(parameters.begin(), parameters.end(),
                                           [](const json& value) { return value.is_number(); });
      if (are_numbers && entry.value("delassus", "") == "full") cases.push_back(law_case(law, entry));
    }
  return cases;
}

// Nodes as ilaw bench draws them.
TEST(FullInertia, IsSolvedSideBySide) {
  Random random(7);
  constexpr std::size_t count = 600;
  const std::vector<LawCase> cases = cases_of_full_inertia();
  EXPECT_GE(cases.size(), 6U);
  for (const LawCase& given : cases) {
    SCOPED_TRACE(given.law);
    LawBatch nodes(make_law(given.law, SetupBuilder(given.parameters, 3, ILAW_DELASSUS_FULL)), count);
    for (std::size_t i = 0; i < count; ++i) {
      for (std::size_t c = 0; c < 6; ++c) nodes.h[i][c] = c < 3 ? random(1.0, 3.0) : random(-0.3, 0.3);
      nodes.v_free[i] = {random(), random(), random()};
      if (i % 7 == 3) nodes.v_free[i][1] = nodes.v_free[i][2] = 0.0;
      nodes.v_previous[i] = {0.0, nodes.v_free[i][1], nodes.v_free[i][2]};
      nodes.gap[i] = -1e-4 * random(0.0, 1.0);
    }
    ASSERT_EQ(nodes.initialise(), ILAW_OK);
    for (int step = 0; step < 3; ++step) {
      EXPECT_EQ(one_by_one(nodes), 0) << "step " << step;
      ASSERT_EQ(nodes.report.bad_count, 0);
    }
  }
}

}  // namespace
}  // namespace ilaw::testing
