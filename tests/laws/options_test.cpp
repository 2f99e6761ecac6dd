// Values per node that each may have, but not together. `ilaw check` has the other promises of tables and
// values per node.
#include "laws/random_nodes.hpp"

namespace ilaw::testing {
namespace {

// Parameters that do not go together are refused by create, or at their nodes where one of them is given per
// node.
TEST(Options, ValuesThatDoNotGoTogetherAreRefusedAtTheirNodes) {
  RandomNodes nodes(4, 3, ILAW_DELASSUS_SCALAR, Inertia::any, 14);
  Parameters parameters{{{"strength", 10.0}, {"toughness", 1.0}, {"delay_time", 1.0}}, {}};
  parameters.per_node = {"stiffness"};
  Runner run("cohesive", parameters, nodes);
  const double stiffness[] = {1e3, std::numeric_limits<double>::infinity(), 1e3, 1.0};
  run.per_node = {ilaw::input(stiffness, 1, 1)};
  nodes.draw();
  EXPECT_EQ(run.evaluate(), ILAW_BAD_NODES);
  EXPECT_EQ(run.report.bad_count, 2);
  EXPECT_EQ(run.report.first_bad_node, 1);
  EXPECT_EQ(std::string(run.report.reason).rfind("parameter 'delay_time' > 0 needs a finite 'stiffness'", 0),
            0U)
      << run.report.reason;
  EXPECT_EQ(run.status[3], ILAW_BAD_INPUT);  // toughness below strength^2/(2 stiffness) = 50
  EXPECT_NE(run.status[0], ILAW_BAD_INPUT);
}

}  // namespace
}  // namespace ilaw::testing
