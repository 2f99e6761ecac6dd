// Contact through the ABI: Moreau's and the predictive condition.
#include "support/law_runner.hpp"

namespace ilaw::testing {
namespace {

// A node that was leaving is not stopped: that would put energy in. It turns round at most at its speed.
TEST(Contact, KeepsMoreausComplementarity) {
  Random random(1);
  for (const double restitution : {0.0, 0.5, 1.0}) {
    NodeRun node("contact", {{{"restitution", restitution}}, {{"activation", "moreau"}}});
    for (int k = 0; k < 100000; ++k) {
      const double scale = random.decades(-300.0, 150.0);
      const double v = scale * random(), before = scale * random();
      node.gap = k % 10 == 0 ? 0.0 : random();  // zero is closed
      node.h[0] = 1.0 + 0.9 * random();
      node.v_previous = {before, 0.3 * scale, 0.0};
      ASSERT_EQ(node.step({v, 0.7 * scale, -0.2 * scale}), ILAW_OK)
          << "restitution " << restitution << ", k " << k;
      ASSERT_GE(node.r[0], 0.0) << "restitution " << restitution << ", k " << k;
      ASSERT_EQ(node.r[1], 0.0) << "restitution " << restitution << ", k " << k;
      ASSERT_EQ(node.r[2], 0.0) << "restitution " << restitution << ", k " << k;
      const double left = node.v[0] + (before < 0.0 ? restitution : 1.0) * before;
      if (node.gap > 0.0) {
        ASSERT_EQ(node.r[0], 0.0) << "restitution " << restitution << ", k " << k;
      } else {
        ASSERT_GE(left, -4 * ulp * scale) << "restitution " << restitution << ", k " << k;
        ASSERT_LE(std::min(node.r[0] * node.h[0], left), 4 * ulp * scale)
            << "restitution " << restitution << ", k " << k;
      }
      ASSERT_EQ(node.status, node.r[0] > 0.0 ? ILAW_CLOSED : ILAW_FREE)
          << "restitution " << restitution << ", k " << k;
      ASSERT_GE(node.energy[ILAW_ENERGY_IMPACT], 0.0) << "restitution " << restitution << ", k " << k;
    }
  }
}

// An impact under no force loses (1 - e^2) of the energy of the normal motion.
TEST(Contact, LosesTheEnergyOfItsRestitution) {
  for (const double restitution : {0.0, 0.25, 0.8, 1.0}) {
    GIVEN(restitution);
    NodeRun node("contact", {{{"restitution", restitution}}, {}});
    node.h[0] = 0.5;  // mass 2
    node.gap = -1e-9;
    node.v_previous = {-3.0, 1.0, 0.0};
    ASSERT_EQ(node.step({-3.0, 1.0, 0.0}), ILAW_OK);
    EXPECT_NEAR(node.v[0], 3.0 * restitution, 1e-15);
    EXPECT_NEAR(node.energy[ILAW_ENERGY_IMPACT], 9.0 * (1.0 - restitution * restitution), 1e-14);
  }
}

// Falling freely onto the plane: the gap after every step stays above rounding, also with restitution.
TEST(Contact, PredictiveNeverPenetrates) {
  for (const double restitution : {0.0, 0.4, 1.0})
    for (const double h : {1e-2, 3e-3, 1e-3}) {
      NodeRun node("contact", {{{"restitution", restitution}}, {{"activation", "predictive"}}}, h);
      double position = 1.0;
      node.v = {-0.1, 0.0, 0.0};
      for (int k = 0; k < 3000; ++k) {
        position += h * node.v[0];
        ASSERT_GE(position, -1e-15) << "e " << restitution << ", h " << h << ", step " << k;
        node.gap = position;
        ASSERT_EQ(node.step({node.v[0] - 10.0 * h, 0.0, 0.0}), ILAW_OK) << "h " << h << ", k " << k;
      }
    }
}

// A penetration that is there already is kept, not pushed out at speed.
TEST(Contact, PredictiveCreatesNoEnergyFromPenetration) {
  NodeRun node("contact", {{}, {{"activation", "predictive"}}}, 1e-3);
  node.gap = -0.01;
  ASSERT_EQ(node.step({-0.5, 0.0, 0.0}), ILAW_OK);
  EXPECT_NEAR(node.v[0], 0.0, 1e-16);
  ASSERT_EQ(node.step({0.5, 0.0, 0.0}), ILAW_OK);
  EXPECT_EQ(node.r[0], 0.0);
}

// The next gap is g + l v_N for the position step l, whatever the velocity step: it is closed and no more.
TEST(Contact, PredictsWithThePositionStep) {
  for (const double l : {3e-4, 1e-3, 7e-3}) {
    NodeRun node("contact", {{}, {{"activation", "predictive"}}}, 1e-3);
    node.position_dt = l;
    node.gap = 0.4 * l;
    node.v_previous = {-1.0, 0.0, 0.0};
    ASSERT_EQ(node.step({-1.0, 0.2, 0.0}), ILAW_OK) << "l " << l;
    EXPECT_NEAR(node.gap + l * node.v[0], 0.0, 1e-18) << "position step " << l;
  }
}

}  // namespace
}  // namespace ilaw::testing
