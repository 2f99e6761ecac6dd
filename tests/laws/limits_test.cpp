// Limits in which one law is another, for each form of H. A case of the section "limits" names the other law,
// "limit", and its parameters, "limit_parameters"; "broken": a state variable that is 1; "inertia": see
// random_nodes.hpp.
#include "laws/random_nodes.hpp"
#include "support/sizes.hpp"

#include <tuple>

namespace ilaw::testing {
namespace {

constexpr std::size_t node_count = 1000;
constexpr int most_steps = 375;  // in 2D and 3D together: 750,000

class Limits : public ::testing::TestWithParam<Combination> {};

TEST_P(Limits, GiveTheSameBits) {
  const auto& [law, form, dimension] = GetParam();
  RandomNodes nodes(node_count, dimension, form, inertia_of(law), 12);
  Runner run(law.law, law.parameters, nodes),
      other(law.more.at("limit"), parameters_of(law.more.value("limit_parameters", json::object())), nodes);
  run.initialise();
  other.initialise();
  if (law.more.contains("broken"))
    for (std::size_t i = 0; i < node_count; ++i)
      run.set(law.more["broken"].get<std::string>().c_str(), i, 1.0);
  const int steps = part_of(most_steps);
  int acting = 0;
  for (int k = 0; k < steps && !HasFailure(); ++k) {
    nodes.draw();
    nodes.v_previous = nodes.v_free;
    for (double& gap : nodes.gap) gap = 0.5 * nodes.uniform() * RandomNodes::step;
    run.time = other.time += RandomNodes::step;
    ASSERT_EQ(run.evaluate(), ILAW_OK) << run.report.reason;
    ASSERT_EQ(other.evaluate(), ILAW_OK) << other.report.reason;
    for (std::size_t i = 0; i < nodes.count; ++i) {
      acting += run.r[i][0] != 0.0;
      ASSERT_EQ(run.r[i], other.r[i]) << "k " << k << ", i " << i;
      ASSERT_EQ(run.v[i], other.v[i]) << "k " << k << ", i " << i;
    }
  }
  EXPECT_GT(acting, 200 * steps);
}

INSTANTIATE_TEST_SUITE_P(Laws, Limits, ::testing::ValuesIn(combinations_of(law_cases("limits"))),
                         name_of_combination);

}  // namespace
}  // namespace ilaw::testing
