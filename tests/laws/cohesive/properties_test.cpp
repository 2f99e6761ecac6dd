// Cohesive zones through the ABI: friction as they break, and rounding.
#include "bond.hpp"

#include "support/sizes.hpp"

namespace ilaw::testing {
namespace {

// Pressed and sheared, the tangential impulse is that of the bond, -h A k w with w the mean slip of the two
// half steps, and Coulomb friction of the broken part: at most mu d r_N, and against the slip where it slips.
TEST(CohesiveProperties, FrictionGrowsAsTheBondBreaks) {
  Draw draw(12);
  int slips = 0, sticks = 0;
  const double strength = 2.0, toughness = 3.0, friction = 0.7, step = 0.02;
  Bond node({{{"strength", strength}, {"toughness", toughness}, {"friction", friction}}, {}}, step, 1.0, 1.0);
  for (int k = 0; k < 20000; ++k) {
    const double damage = draw.between(0.01, 0.99);
    // The secant of the rigid, linear bond of mode I, k = sigma^2 (1 - d)/(2 G d), and half its range.
    const double secant = strength * strength * (1.0 - damage) / (2.0 * toughness * damage);
    const double reach = 0.5 * damage * 2.0 * toughness / strength;
    const double angle = draw.between(0.0, 6.28), slip1 = reach * std::cos(angle),
                 slip2 = reach * std::sin(angle);
    node.state = {damage, 0.0, slip1, slip2, 0.0, slip1, slip2};
    node.v_previous = {};
    const Vector v = draw.vector(1.0);
    ASSERT_EQ(node.step({-std::abs(v[0]), 0.3 * v[1], 0.3 * v[2]}), ILAW_OK);
    ASSERT_EQ(node.named("damage"), damage);
    ASSERT_NEAR(node.r[0], std::abs(v[0]), 4 * ulp);
    const double f1 = node.r[1] + step * secant * 0.5 * (slip1 + node.named("mean_slip_1"));
    const double f2 = node.r[2] + step * secant * 0.5 * (slip2 + node.named("mean_slip_2"));
    const double limit = friction * damage * node.r[0], speed = std::hypot(node.v[1], node.v[2]);
    ASSERT_LE(std::hypot(f1, f2), limit + 1e-13 * (1.0 + step * secant));
    if (speed > 1e-12) {
      ++slips;
      ASSERT_NEAR(std::hypot(f1, f2), limit, 1e-12);
      ASSERT_NEAR(f1 * node.v[2], f2 * node.v[1], 1e-12) << "along the slip";
      ASSERT_LT(f1 * node.v[1] + f2 * node.v[2], 1e-12) << "against it";
    } else {
      ++sticks;
    }
  }
  EXPECT_GT(slips, 3000);
  EXPECT_GT(sticks, 3000);
}

// A bond that holds leaves a velocity of 0, short of rounding. The work of its impulse on that is no work to
// be taken off; on a motion it is.
TEST(CohesiveProperties, WhatRoundsTakesNothingOffABond) {
  Draw draw(16);
  for (const double coupling : {0.0, 1e-13})
    for (int k = 0; k < part_of(2000); ++k) {
      NodeRun node("cohesive", {{{"strength", 1e9}, {"toughness", 1e9}}, {}}, 1.0, ILAW_DELASSUS_FULL);
      node.h = {1.0, 1.0, 1.0, 0.0, 0.0, coupling};
      const Vector free = draw.vector(1.0);
      const auto held = [&](double moved) {
        for (std::size_t c = 0; c < 3; ++c) node.v_previous[c] = -moved * free[c];
        EXPECT_EQ(node.step(free), ILAW_OK);
        EXPECT_EQ(node.status, ILAW_BONDED);
        return node.r;
      };
      const Vector resting = held(0.0);
      ASSERT_EQ(held(0x1p-51 * draw.between(0.0, 4.0)), resting) << "draw " << k;
      const Vector turning = held(0.1);
      ASSERT_LT(std::hypot(turning[0], turning[1], turning[2]),
                0.95 * std::hypot(resting[0], resting[1], resting[2]))
          << "draw " << k;
    }
}

}  // namespace
}  // namespace ilaw::testing
