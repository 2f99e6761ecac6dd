// Cohesive zones through the ABI: what holds for any motion, invariances, limits, refusals.
#include "bond.hpp"

namespace ilaw::testing {
namespace {

// A mass pushed at random, for any bond and step. In each step damage grows within [0, 1], the parts
// dissipated are not negative, the opening is not negative, and the work is what was stored and dissipated.
TEST(CohesiveProperties, HoldForAnyMotion) {
  Draw draw(11);
  int broken = 0, slipping = 0, partly = 0, several = 0;
  for (int bond = 0; bond < 1000; ++bond) {
    Hung node(draw.bond(), draw.decades(-3.0, 0.0));
    node.area = draw.between(0.1, 2.0);
    const double force = draw.decades(-0.5, 1.0);
    Vector bias = draw.vector(force);
    for (int k = 0; k < 250; ++k) {
      if (k % 50 == 0) bias = draw.vector(force);
      const double damage = node.named("damage"), opening = node.named("opening"),
                   stored = node.energy[ILAW_ENERGY_STORED];
      const Vector v = node.v;
      const Vector random = draw.vector(force);
      node.push({bias[0] + random[0], bias[1] + random[1], bias[2] + random[2]});
      several += node.several;
      if (node.several) break;
      ASSERT_GE(node.named("damage"), damage);
      ASSERT_LE(node.named("damage"), 1.0);
      for (const double part : node.energy) ASSERT_GE(part, 0.0);
      if (damage == 1.0) break;
      // Not below zero, nor below where it is; a node that was leaving turns round at most at its speed.
      const double reach = std::abs(opening) + node.dt * (std::abs(v[0]) + std::abs(node.v_free[0]));
      ASSERT_GE(node.named("opening"),
                std::min(opening, 0.0) - node.dt * std::max(v[0], 0.0) - 0x1p-43 * reach)
          << "bond " << bond << ", step " << k;
      double balance = stored - node.energy[ILAW_ENERGY_STORED];
      double scale = 1e-13 * (node.energy[ILAW_ENERGY_STORED] + stored);
      for (std::size_t c = 0; c < 3; ++c) {
        balance -= node.energy[c] + 0.5 * node.r[c] * (v[c] + node.v[c]);
        const double pushed = std::abs(node.r[c]);  // v rounds as its terms v_free and H r do
        scale += 1e-13 * pushed * (std::abs(v[c]) + std::abs(node.v[c]) + node.h[0] * pushed);
      }
      ASSERT_LE(std::abs(balance), scale) << "bond " << bond << ", step " << k;
      broken += node.status == ILAW_BROKEN;
      slipping += node.energy[ILAW_ENERGY_FRICTION] > 0.0;
      partly += damage > 0.0 && damage < 1.0;
    }
  }
  EXPECT_LT(several, 250);
  EXPECT_GT(broken, 250);
  EXPECT_GT(slipping, 2500);
  EXPECT_GT(partly, 25000);
}

// A bond that is made on a moving node takes energy from it, or none: also where a stiff spring turns the
// node round within the step. The energy that the law reports is the work then.
TEST(CohesiveProperties, ABondMadeOnAMovingNodeAddsNoEnergy) {
  Draw draw(13);
  int turned = 0;
  for (int k = 0; k < 2000; ++k) {
    Bond node(draw.bond(), draw.decades(-3.0, 1.0), draw.between(0.1, 2.0), draw.decades(-2.0, 2.0));
    const Vector before = draw.vector(1.0), free = draw.vector(3.0);
    node.v_previous = before;
    if (node.step(free) != ILAW_OK) continue;  // several solutions
    double work = node.energy[ILAW_ENERGY_STORED], size = work, along = 0.0;
    for (std::size_t c = 0; c < 3; ++c) {
      work += 0.5 * node.r[c] * (before[c] + node.v[c]) + node.energy[c];
      size += std::abs(node.r[c]) * (2.0 + node.h[0] * std::abs(node.r[c]));
      along += before[c] * free[c];
    }
    ASSERT_LE(work, 1e-13 * size) << "draw " << k;
    turned += along < 0.0;
  }
  EXPECT_GT(turned, 500);
}

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
    for (int k = 0; k < 2000; ++k) {
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

// Strength inf: the node stops in one step, whatever else is given. No toughness, no strength, or broken:
// coulomb with predictive activation, bit for bit.
TEST(CohesiveProperties, LimitsAreTieAndCoulomb) {
  Draw draw(13);
  NodeRun tie("cohesive", {{{"strength", inf_value}, {"toughness", 1.0}, {"friction", 0.3}}, {}});
  NodeRun tough("cohesive", {{{"strength", 1.0}, {"toughness", 0.0}, {"friction", 0.3}}, {}});
  NodeRun weak("cohesive", {{{"strength", 0.0}, {"toughness", 1.0}, {"friction", 0.3}}, {}});
  NodeRun broken("cohesive", {{{"strength", 1.0}, {"toughness", 1.0}, {"friction", 0.3}}, {}});
  NodeRun contact("coulomb", {{{"friction", 0.3}}, {{"activation", "predictive"}}});
  broken.state[0] = 1.0;
  EXPECT_EQ(tough.named("damage"), 1.0);
  for (int k = 0; k < 50000; ++k) {
    const Vector v = draw.vector(draw.decades(-100.0, 100.0));
    const double delassus = draw.decades(-3.0, 3.0), gap = draw.between(-1e-3, 1e-3);
    for (NodeRun* each : {&tie, &tough, &weak, &broken, &contact}) {
      each->h[0] = delassus;
      each->gap = gap;
      each->v_previous = {};
      ASSERT_EQ(each->step(v), ILAW_OK);
    }
    for (std::size_t c = 0; c < 3; ++c) {
      ASSERT_NEAR(tie.v[c], 0.0, 2 * ulp * std::abs(v[c]));
      ASSERT_EQ(tie.state[c + 1], 0.0);
    }
    for (NodeRun* each : {&tough, &weak, &broken}) {
      ASSERT_EQ(each->r, contact.r);
      ASSERT_EQ(each->status, contact.status);
      ASSERT_EQ(each->energy, contact.energy);
    }
  }
}

// H = diag(h_N, h_T, h_T) with another h_T: the node moves by v_free + H r and the traction is on the bond's
// curve.
TEST(CohesiveProperties, OtherTangentialInertiaIsSolved) {
  const double step = 0.1;
  NodeRun node("cohesive", {{{"strength", 1.0}, {"toughness", 2.0}, {"stiffness", 40.0}}, {}}, step,
               ILAW_DELASSUS_DIAGONAL);
  node.h = {1.0, 3.5, 3.5};
  ASSERT_EQ(node.step({0.08, 0.06, -0.03}), ILAW_OK);
  EXPECT_EQ(node.named("damage"), 0.0);
  for (std::size_t c = 0; c < 3; ++c) {
    const double mean = 0.5 * step * node.v[c];  // of the openings 0 and h v
    EXPECT_NEAR(node.r[c], -step * 40.0 * 0.5 * mean, 1e-15);
  }
  ASSERT_EQ(node.step({3.0, 9.0, -4.0}), ILAW_OK);
  EXPECT_GT(node.named("damage"), 0.1);
  EXPECT_LT(node.named("damage"), 0.9);
}

// The first impulse divides by the velocity step, over which the mean opening grows, too; the position goes
// on from there by half a position step.
TEST(CohesiveProperties, TwoTimeSteps) {
  NodeRun node("cohesive", {{{"strength", 1e9}, {"toughness", 1e20}, {"stiffness", 40.0}}, {}});
  ilaw_batch b = node.batch();
  b.velocity_step = 0.1;
  b.position_step = 0.3;
  const Vector free{2.0, 0, 0};
  b.v_free = ilaw::input(free.data(), 0, 1);
  b.state_in = ilaw::input(node.state.data(), 0, 1);
  b.state_out = ilaw::output(node.state.data(), 0, 1);
  b.impulse = ilaw::output(node.r.data(), 0, 1);
  b.velocity = ilaw::output(node.v.data(), 0, 1);
  ASSERT_EQ(node.interface.evaluate(b), ILAW_OK);
  EXPECT_NEAR(node.named("mean_opening"), 0.5 * 0.1 * node.v[0], 1e-15);
  EXPECT_NEAR(node.named("opening"), 0.5 * (0.1 + 0.3) * node.v[0], 1e-15);
  EXPECT_NEAR(node.r[0], -0.1 * 40.0 * 0.25 * 0.1 * node.v[0], 1e-15);
}

std::string refusal(const Parameters& parameters) {
  try {
    make_law("cohesive", SetupBuilder(parameters));
  } catch (const std::exception& error) {
    return error.what();
  }
  return "";
}

TEST(CohesiveProperties, BadParametersAreRefusedByName) {
  const auto bond = [](std::map<std::string, double> more, const std::string& shape = "bilinear") {
    more.insert({{"strength", 2.0}, {"toughness", 3.0}});
    return refusal({more, {{"shape", shape}}});
  };
  EXPECT_EQ(bond({}), "");
  EXPECT_EQ(bond({{"stiffness", 2.0 / 3.0}}), "") << "strength^2/(2 stiffness) is the toughness";
  EXPECT_EQ(refusal({{{"toughness", 1.0}}, {}}),
            "law 'cohesive': parameter 'strength' is missing: expected a number in [0, inf]");
  EXPECT_EQ(bond({{"strength", -1.0}}),
            "law 'cohesive': parameter 'strength' = -1 is not allowed: expected a number in [0, inf]");
  EXPECT_EQ(
      bond({{"stiffness", 0.66}}),
      "law 'cohesive': parameter 'toughness' is below 'strength'^2/(2 'stiffness'), the energy that the bond "
      "stores when its strength is reached; found strength = 2, toughness = 3, stiffness = 0.66");
  EXPECT_EQ(
      bond({{"stiffness", 10.0}, {"toughness_2", 0.19}}),
      "law 'cohesive': parameter 'toughness_2' is below 'strength_2'^2/(2 'stiffness'), the energy that the "
      "bond stores in shear when its strength is reached (0: the same as 'toughness' and 'strength'); found "
      "strength = 2, toughness = 3, strength_2 = 0, toughness_2 = 0.19, stiffness = 10");
  EXPECT_EQ(
      bond({{"stiffness", 10.0}}, "camacho_ortiz"),
      "law 'cohesive': shape \"camacho_ortiz\" is rigid: parameter 'stiffness' must be inf; found stiffness = "
      "10");
  EXPECT_EQ(bond({{"strength", inf_value}}, "camacho_ortiz"),
            "law 'cohesive': shape \"camacho_ortiz\" weighs shear by the ratio of its strengths: parameter "
            "'strength' must be finite (a bond that never breaks: \"bilinear\" with 'strength' inf); found "
            "strength = inf");
  EXPECT_EQ(
      bond({{"toughness_2", 4.0}}, "camacho_ortiz"),
      "law 'cohesive': shape \"camacho_ortiz\" has one toughness: parameter 'toughness_2' must be the same as "
      "'toughness'; found toughness = 3, toughness_2 = 4");
  EXPECT_EQ(
      bond({{"strength_2", inf_value}}),
      "law 'cohesive': parameters 'strength' and 'strength_2' must both be infinite, or both finite; found "
      "strength = 2, strength_2 = inf");
  EXPECT_EQ(
      bond({{"delay_time", 1.0}}),
      "law 'cohesive': parameter 'delay_time' > 0 needs a finite 'stiffness': the opening of a rigid bond says "
      "nothing of its load; found stiffness = inf, delay_time = 1");
  EXPECT_EQ(
      bond({{"strength_2", 1e-160}}),
      "law 'cohesive': parameter 'strength_2' is too small: 'toughness_2'/'strength_2'^2, which damage is "
      "measured by, overflows; found strength_2 = 1e-160, toughness_2 = 0");
  EXPECT_NE(bond({{"delay_time", inf_value}}), "");
  EXPECT_NE(bond({{"mixing_exponent", 0.0}}), "");
  EXPECT_NE(bond({}, "trilinear"), "");
}

}  // namespace
}  // namespace ilaw::testing
