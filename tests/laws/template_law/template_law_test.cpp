// template_law through the ABI: its equation, its motion in time, and its limits.
#include "laws/random_nodes.hpp"

namespace ilaw::testing {
namespace {

// r_N = h c A <-v_N - <v_N^->> with the velocities after and before the step, for any form of H.
TEST(template_law, KeepsItsEquation) {
  for (const std::uint32_t form : {ILAW_DELASSUS_SCALAR, ILAW_DELASSUS_DIAGONAL, ILAW_DELASSUS_FULL})
    for (const double damping : {0.0, 1e-3, 1.0, 1e3, 1e6}) {
      RandomNodes nodes(1000, 3, form, Inertia::any, 1);
      Runner run("template_law", {{{"damping", damping}}, {}}, nodes);
      nodes.draw();
      for (double& gap : nodes.gap) gap = nodes.uniform();
      ASSERT_EQ(run.evaluate(), ILAW_OK) << run.report.reason;
      for (std::size_t i = 0; i < nodes.count; ++i) {
        SCOPED_TRACE(::testing::Message() << "node " << i << ", form " << form << ", damping " << damping);
        const double c = nodes.gap[i] <= 0.0 ? RandomNodes::step * damping * nodes.area[i] : 0.0;
        ASSERT_EQ(run.r[i][1], 0.0);
        ASSERT_EQ(run.r[i][2], 0.0);
        // Cancellation leaves ulps of v_free in v_N.
        const double before = std::max(0.0, nodes.v_previous[i][0]),
                     size = 1.0 + std::abs(nodes.v_free[i][0]);
        ASSERT_NEAR(run.r[i][0], c * std::max(0.0, -run.v[i][0] - before),
                    4 * ulp * (1.0 + c) * (size + before));
        ASSERT_LE(run.r[i][0] * (run.v[i][0] + nodes.v_previous[i][0]), 0.0);
        ASSERT_EQ(run.status[i], run.r[i][0] > 0.0 ? ILAW_CLOSED : ILAW_FREE);
      }
    }
}

// A mass that meets the dashpot at speed V: each step divides its speed by 1 + h c A/m, and at time t it is
// V exp(-c A t/m) but for the order of the step.
TEST(template_law, SlowsAMassExponentially) {
  const double mass = 2.0, area = 0.5, damping = 3.0, speed = 4.0, end = 2.0, rate = damping * area / mass;
  double errors[3];
  const double steps[] = {0.05, 0.02, 0.008};
  for (int k = 0; k < 3; ++k) {
    const double h = steps[k];
    NodeRun node("template_law", {{{"damping", damping}}, {}}, h);
    node.h[0] = 1.0 / mass;
    node.area = area;
    node.gap = -1e-3;
    node.v = node.v_previous = {-speed, 0.0, 0.0};
    const auto count = static_cast<int>(std::lround(end / h));
    double energy = 0.0;
    for (int step = 0; step < count; ++step) {
      ASSERT_EQ(node.step(node.v), ILAW_OK) << "k " << k << ", step " << step;
      energy += node.energy[ILAW_ENERGY_IMPACT];
    }
    EXPECT_NEAR(-node.v[0], speed * std::pow(1.0 + h * rate, -count), 1e-13) << "h " << h;
    EXPECT_NEAR(energy, 0.5 * mass * (speed * speed - node.v[0] * node.v[0]), 1e-12) << "h " << h;
    errors[k] = std::abs(node.v[0] + speed * std::exp(-rate * end));
  }
  for (int k = 1; k < 3; ++k)
    EXPECT_NEAR(std::log(errors[k] / errors[k - 1]) / std::log(steps[k] / steps[k - 1]), 1.0, 0.05)
        << "k " << k;
}

TEST(template_law, NeverPullsAndNeedsAClosedGapAndAnArea) {
  NodeRun node("template_law", {{{"damping", 1e3}}, {}});
  const auto impulse = [&](double gap, double area, double velocity) {
    node.gap = gap;
    node.area = area;
    EXPECT_EQ(node.step({velocity, 1.0, -1.0}), ILAW_OK) << node.report.reason;
    return node.r[0];
  };
  EXPECT_GT(impulse(0.0, 1.0, -1.0), 0.0);
  EXPECT_EQ(impulse(1e-9, 1.0, -1.0), 0.0);
  EXPECT_EQ(impulse(0.0, 0.0, -1.0), 0.0);
  EXPECT_EQ(impulse(0.0, 1.0, 1.0), 0.0);
}

}  // namespace
}  // namespace ilaw::testing
