// Contact with friction through the ABI: closed forms, cone, complementarity, dissipation, limits.
#include "support/law_runner.hpp"
#include "support/small_batch.hpp"

namespace ilaw::testing {
namespace {

// Oblique impact of a point, no force (v_free = v^-): sticks or slides throughout, leaves with e v_z and
// v_x - mu (1+e) v_z where that is positive. Energy never grows at any angle.
TEST(Coulomb, ObliqueImpactFollowsItsClosedForm) {
  for (const double restitution : {0.0, 0.3, 1.0})
    for (const double friction : {0.0, 0.1, 0.5, 2.0}) {
      NodeRun node("coulomb", {{{"friction", friction}, {"restitution", restitution}}, {}});
      for (double angle = 0.0; angle < 90.0; angle += 0.1) {
        const double vz = std::cos(angle * M_PI / 180.0), vx = std::sin(angle * M_PI / 180.0);
        node.h[0] = 0.4;
        node.v_previous = {-vz, 0.6 * vx, 0.8 * vx};
        ASSERT_EQ(node.step(node.v_previous), ILAW_OK) << "friction " << friction << ", angle " << angle;
        const double left = std::max(0.0, vx - friction * (1.0 + restitution) * vz);
        ASSERT_NEAR(node.v[0], restitution * vz, 4 * ulp) << "friction " << friction << ", angle " << angle;
        ASSERT_NEAR(node.v[1], 0.6 * left, 8 * ulp * (1.0 + friction))
            << "friction " << friction << ", angle " << angle;
        ASSERT_NEAR(node.v[2], 0.8 * left, 8 * ulp * (1.0 + friction))
            << "friction " << friction << ", angle " << angle;
        const double energy = node.v[0] * node.v[0] + node.v[1] * node.v[1] + node.v[2] * node.v[2];
        ASSERT_LE(energy, 1.0 + 8 * ulp) << "mu " << friction << ", angle " << angle;
      }
    }
}

TEST(Coulomb, KeepsComplementarityConeAndDirectionAtAnyScale) {
  Random draw(1);
  int sticks = 0, slips = 0;
  for (const double friction : {0.0, 1e-6, 0.3, 1.0, 1e6}) {
    NodeRun node("coulomb", {{{"friction", friction}}, {{"activation", "moreau"}}});
    for (int k = 0; k < 100000; ++k) {
      const Vector q = draw.vector(draw.decades(-300.0, 150.0));
      node.h[0] = std::pow(10.0, draw(-6.0, 6.0));
      node.gap = draw(-1.0, 0.3);
      node.v_previous = {};
      ASSERT_EQ(node.step(q), ILAW_OK) << "friction " << friction << ", k " << k;
      const double scale = std::max({std::abs(q[0]), std::abs(q[1]), std::abs(q[2])});
      if (node.gap > 0.0 || q[0] >= 0.0) {
        for (const double r : node.r) ASSERT_EQ(r, 0.0);
        ASSERT_EQ(node.status, ILAW_FREE) << "friction " << friction << ", k " << k;
        continue;
      }
      ASSERT_GT(node.r[0], 0.0) << "friction " << friction << ", k " << k;
      ASSERT_NEAR(node.v[0], 0.0, 2 * ulp * scale) << "friction " << friction << ", k " << k;
      ASSERT_LE(tangential_length(node.r), friction * node.r[0] * (1.0 + 8 * ulp) + 1e-323)
          << "friction " << friction << ", k " << k;
      if (node.status == ILAW_STICK) {
        ++sticks;
        ASSERT_NEAR(tangential_length(node.v), 0.0, 4 * ulp * scale)
            << "friction " << friction << ", k " << k;
      } else {
        ++slips;
        ASSERT_EQ(node.status, ILAW_SLIP) << "friction " << friction << ", k " << k;
        // On the cone, and opposite to the slip: r_T x v_T = 0, r_T . v_T <= 0.
        ASSERT_NEAR(tangential_length(node.r), friction * node.r[0], 8 * ulp * friction * node.r[0] + 1e-322)
            << "friction " << friction << ", k " << k;
        const double limit = 16 * ulp * tangential_length(node.r) * scale + 1e-300;
        ASSERT_NEAR(node.r[1] * node.v[2], node.r[2] * node.v[1], limit)
            << "friction " << friction << ", k " << k;
        ASSERT_LE(node.r[1] * node.v[1] + node.r[2] * node.v[2], limit)
            << "friction " << friction << ", k " << k;
      }
      for (const double energy : node.energy) ASSERT_GE(energy, 0.0);
    }
  }
  EXPECT_GT(sticks, 10000);
  EXPECT_GT(slips, 10000);
}

// A speed at rounding level of what was stopped is none: a contact that stuck has its static coefficient.
TEST(Coulomb, RoundingOfAContactThatStuckIsNoSlip) {
  for (const auto& [speed, status] : {std::pair{0.0, ILAW_STICK}, {1e-12, ILAW_STICK}, {1e-6, ILAW_SLIP}}) {
    NodeRun node("coulomb", {{{"friction", 0.5}, {"kinetic_friction", 0.3}}, {}}, 1e-3);
    node.v_previous = {0.0, speed, 0.0};
    ASSERT_EQ(node.step({-1.0, 0.4, 0.0}), ILAW_OK);
    EXPECT_EQ(node.status, status) << speed;
    EXPECT_NEAR(node.r[1], status == ILAW_STICK ? -0.4 : -0.3, 1e-15) << speed;
  }
}

// Friction never rises with the speed, also beside a node in the same pack where it falls.
TEST(Coulomb, KineticCoefficientIsNeverTheLarger) {
  const Parameters varying{{{"friction", 0.4}, {"decay", 1e6}}, {}, {}, {"kinetic_friction"}};
  const ilaw::interface law = make_law("coulomb", SetupBuilder(varying));
  SmallBatch nodes(2, {-1.0, 3.0, 0.0});
  const double kinetic[] = {0.2, 0.6};
  const ilaw_input per_node = ilaw::input(kinetic, 1, 1);
  nodes.b.per_node_parameters = &per_node;
  ASSERT_EQ(law.evaluate(nodes.b, &nodes.report), ILAW_OK);
  EXPECT_NEAR(nodes.r[0][1], -0.2, 1e-15);
  EXPECT_NEAR(nodes.r[1][1], -0.4, 1e-15);
}

}  // namespace
}  // namespace ilaw::testing
