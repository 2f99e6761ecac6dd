// The largest stable step that the report gives: infinity where a law needs none, else the limit of its
// spring.
#include "support/law_runner.hpp"
#include "support/small_batch.hpp"

namespace ilaw::testing {
namespace {

Parameters springs(double stiffness, double damping) {
  return {{{"stiffness", stiffness}, {"damping", damping}}, {{"integration", "explicit"}}};
}

// A mass that a constant force presses onto the spring, from a little beside its rest: how far it goes in
// many steps, over how far it started from there.
double growth(NodeRun& node, double stiffness, double dt) {
  const double force = 1.0, mass = 1.0 / node.h[0], rest = -force / stiffness;
  double position = rest * (1.0 + 1e-6), velocity = 0.0, largest = 0.0;
  for (int k = 0; k < 4000; ++k) {
    node.time += dt;
    node.gap = position;
    node.v_previous = {velocity, 0.0, 0.0};
    node.step({velocity - dt * force / mass, 0.0, 0.0});
    velocity = node.v[0];
    position += dt * velocity;
    largest = std::max(largest, std::abs(position - rest));
  }
  return largest / (1e-6 * std::abs(rest));
}

TEST(StableStep, OfAnExplicitSpringIsWhereItsMotionBeginsToGrow) {
  for (const double damping : {0.0, 3.0, 80.0})
    for (const double h : {0.4, 2.0}) {
      const double stiffness = 1000.0;
      NodeRun probe("penalty", springs(stiffness, damping));
      probe.h[0] = h;
      probe.gap = -1e-3;
      probe.step({0.0, 0.0, 0.0});
      const double limit = probe.report.stable_velocity_step;
      // 2 (sqrt(1 + z^2) - z)/omega, z = c H/(2 omega).
      const double omega = std::sqrt(stiffness * h), z = damping * h / (2.0 * omega);
      EXPECT_NEAR(limit, 2.0 * (std::sqrt(1.0 + z * z) - z) / omega, 1e-12 * limit) << "h " << h;
      for (const auto& [part, stable] : {std::pair{0.99, true}, {1.01, false}}) {
        NodeRun node("penalty", springs(stiffness, damping), part * limit);
        node.h[0] = h;
        EXPECT_EQ(growth(node, stiffness, part * limit) < 100.0, stable)
            << "damping " << damping << ", H " << h << ", " << part << " of the limit " << limit;
      }
    }
}

TEST(StableStep, IsTheSmallestOfTheBatchAndOfAllSprings) {
  for (const auto& [friction, stiffest] : {std::pair{0.3, 4000.0}, {0.0, 1000.0}}) {
    Parameters parameters = springs(1000.0, 0.0);
    parameters.numbers["friction"] = friction;
    parameters.numbers["tangential_stiffness"] = 4000.0;
    const ilaw::interface law = make_law("penalty", SetupBuilder(parameters));
    const double gap[] = {1.0, -1.0, 0.0};
    double h[] = {0.5, 2.0, 1.0};
    SmallBatch nodes(3, {}, law.info().state_size);
    nodes.b.delassus = ilaw::input(h, 1, 1);
    nodes.b.gap = ilaw::input(gap, 1, 1);
    const double& stable_step = nodes.report.stable_velocity_step;
    ASSERT_EQ(law.evaluate(nodes.b, &nodes.report), ILAW_OK);
    EXPECT_DOUBLE_EQ(stable_step, 2.0 / std::sqrt(stiffest * 2.0));
    h[1] = std::nan("");  // bad nodes do not count
    ASSERT_EQ(law.evaluate(nodes.b, &nodes.report), ILAW_BAD_NODES);
    EXPECT_DOUBLE_EQ(stable_step, 2.0 / std::sqrt(stiffest));
    h[0] = h[2] = -1.0;
    ASSERT_EQ(law.evaluate(nodes.b, &nodes.report), ILAW_BAD_NODES);
    EXPECT_EQ(stable_step, inf_value);
    nodes.b.velocity_step = -1.0;
    ASSERT_EQ(law.evaluate(nodes.b, &nodes.report), ILAW_INVALID_ARGUMENT);
    EXPECT_EQ(stable_step, inf_value);
  }
}

TEST(StableStep, IsInfiniteForLawsThatNeedNone) {
  for (const auto& [law, parameters] :
       {std::pair<const char*, Parameters>{"contact", {}},
        {"coulomb", {{{"friction", 0.3}}, {}}},
        {"tie", {}},
        {"penalty", {{{"stiffness", 1e6}}, {{"integration", "implicit"}}}},
        {"cohesive", {{{"strength", 1.0}, {"toughness", 1.0}, {"stiffness", 1e6}}, {}}}}) {
    NodeRun node(law, parameters);
    node.step({-1.0, 0.0, 0.0});
    EXPECT_EQ(node.report.stable_velocity_step, inf_value) << law;
  }
}

}  // namespace
}  // namespace ilaw::testing
