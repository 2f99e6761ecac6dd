// Slip weakening: its equation, the slip that is taken, its fracture energy, its order against the ODE.
#include "support/law_runner.hpp"

namespace ilaw::testing {
namespace {

struct Weakening {
  double friction, dynamic, critical;

  Parameters parameters() const {
    return {{{"friction", friction}, {"dynamic_friction", dynamic}, {"critical_slip", critical}},
            {{"activation", "moreau"}}};
  }
  double at(double slip) const { return friction - (friction - dynamic) * std::fmin(slip / critical, 1.0); }
};

// Random nodes of any H: the node sticks where it can stick with the coefficient at no slip in the step, and
// else slips with that at the mean slip of the step.
TEST(SlipWeakening, SolvesItsEquationForAnyInertia) {
  Random random(1);
  int sticks = 0, weakens = 0, weakened = 0;
  for (const std::uint32_t form :
       {std::uint32_t{ILAW_DELASSUS_TRANSVERSE}, std::uint32_t{ILAW_DELASSUS_FULL}}) {
    const Weakening law{0.7, 0.2, 0.05};
    NodeRun node("slip_weakening", law.parameters(), 0.01, form);
    node.h = form == ILAW_DELASSUS_FULL ? std::array<double, 6>{1.0, 1.4, 0.8, 0.2, -0.1, 0.1}
                                        : std::array<double, 6>{1.0, 0.6};
    for (int k = 0; k < 5000; ++k) {
      const double before = 0.03 * (1.0 + random());
      const double push = std::pow(10.0, 1.5 * random());
      node.state = {before};
      node.v_previous = {0.0, random(), random()};
      const double was = std::hypot(node.v_previous[1], node.v_previous[2]);
      const Vector free_before = node.v_previous;
      const Vector free{-push, node.v_previous[1] + random(), node.v_previous[2] + random()};
      ASSERT_EQ(node.step(free), ILAW_OK) << node.report.reason;
      const Vector v = node.v;
      const double speed = std::hypot(v[1], v[2]), shear = std::hypot(node.r[1], node.r[2]);
      if (node.status == ILAW_STICK) {
        ASSERT_LE(shear, law.at(before + 0.25 * 0.01 * was) * node.r[0] * (1.0 + 1e-14));
        ASSERT_NEAR(node.state[0], before + 0.5 * 0.01 * was, 1e-15);
        ++sticks;
      } else if (-(node.r[1] * v[1] + node.r[2] * v[2]) > 0.0) {
        const double mean = before + 0.25 * 0.01 * (was + speed);
        const double work = node.r[1] * (v[1] + free_before[1]) + node.r[2] * (v[2] + free_before[2]);
        if (std::abs(work) < 1e-9) continue;  // turned round: its work is taken off
        ASSERT_NEAR(shear, law.at(mean) * node.r[0], 1e-12 * node.r[0]) << k;
        ASSERT_NEAR(node.state[0], before + 0.5 * 0.01 * (was + speed), 1e-13);
        ++(mean < law.critical ? weakens : weakened);
      }
    }
  }
  EXPECT_GT(sticks, 500);
  EXPECT_GT(weakens, 500);
  EXPECT_GT(weakened, 500);
}

// Steeper than the node, where both are possible: it sticks, as it does up to the load that breaks it away;
// beyond, it slips with what the weakened surface bears.
TEST(SlipWeakening, SticksUntilTheLoadBreaksItAway) {
  const Weakening law{0.6, 0.1, 1e-6};
  NodeRun node("slip_weakening", law.parameters(), 0.01);
  for (int k = 0; k < 590; ++k) {
    node.v_previous = {};
    ASSERT_EQ(node.step({-1.0, 0.001 * k, 0.0}), ILAW_OK);
    ASSERT_EQ(node.status, ILAW_STICK) << k;  // 0.001 k - 0.1 > 0: slip is a solution, too
    ASSERT_EQ(node.state[0], 0.0);
  }
  node.v_previous = {};
  ASSERT_EQ(node.step({-1.0, 0.601, 0.0}), ILAW_OK);
  EXPECT_EQ(node.status, ILAW_SLIP);
  EXPECT_NEAR(node.v[1], 0.501, 1e-15);
}

// A weak coupling changes little, also where the motion turns round within the step.
TEST(SlipWeakening, IsContinuousInTheCoupling) {
  Random random(3);
  const Weakening law{0.7, 0.2, 0.05};
  NodeRun node("slip_weakening", law.parameters(), 0.01, ILAW_DELASSUS_FULL),
      plain("slip_weakening", law.parameters(), 0.01, ILAW_DELASSUS_TRANSVERSE);
  node.h = {1.0, 1.3, 1.3, 1e-9, 0.0, 0.0};
  plain.h = {1.0, 1.3};
  for (int k = 0; k < 1000; ++k) {
    const Vector before{0.0, random(), random()};
    const Vector free{-1.0, 2.0 * random(), 2.0 * random()};
    node.v_previous = plain.v_previous = before;
    node.state = plain.state = {0.02};
    ASSERT_EQ(node.step(free), ILAW_OK);
    ASSERT_EQ(plain.step(free), ILAW_OK);
    ASSERT_THAT(node.r, VectorNear(plain.r, 1e-7)) << k;
    ASSERT_NEAR(node.state[0], plain.state[0], 1e-9) << k;
  }
}

// Only what slips under pressure weakens, and a coefficient does not rise with the slip.
TEST(SlipWeakening, DoesNotSlipInTheAirOrRise) {
  NodeRun node("slip_weakening", Weakening{0.3, 0.7, 0.01}.parameters(), 0.01);
  node.v_previous = {0.0, 2.0, 0.0};
  ASSERT_EQ(node.step({1.0, 2.0, 0.0}), ILAW_OK);
  EXPECT_EQ(node.state[0], 0.0);
  node.v_previous = {0.0, 2.0, 0.0};
  ASSERT_EQ(node.step({-1.0, 2.0, 0.0}), ILAW_OK);
  EXPECT_NEAR(node.r[1], -0.3, 1e-15);
  EXPECT_GT(node.state[0], 0.01);
}

// The whole work of friction of a block that stops is mu_d N s and the fracture energy, for any step that
// does not pass the critical slip within it.
TEST(SlipWeakening, DissipatesItsFractureEnergy) {
  const Weakening law{0.6, 0.2, 1e3};
  for (const double h : {0.01, 0.037, 0.11}) {
    NodeRun node("slip_weakening", law.parameters(), h);
    node.h[0] = 0.5;
    node.v_previous = {0.0, 5.0, 0.0};
    double work = 0.0, slip = 0.0;
    for (int k = 0; k < 5; ++k) {
      const double was = node.v_previous[1];
      ASSERT_EQ(node.step({-10.0 * h, was, 0.0}), ILAW_OK);
      const double moved = 0.5 * h * (was + node.v[1]);
      ASSERT_NEAR(node.energy[ILAW_ENERGY_FRICTION],
                  20.0 * moved * 0.5 * (law.at(slip) + law.at(slip + moved)), 1e-13 * 60.0 * h)
          << k;
      work += node.energy[ILAW_ENERGY_FRICTION];
      slip += moved;
    }
    EXPECT_NEAR(node.state[0], slip, 1e-14);
    EXPECT_NEAR(work, 20.0 * (0.6 * slip - 0.5 * 0.4 / 1e3 * slip * slip), 1e-13 * work);
  }
}

// m s'' = F - mu(s) N: s = s' 0 grows as sinh and cosh of w t, w^2 = (mu_s - mu_d) N/(m D_c).
TEST(SlipWeakening, ConvergesToItsEquationAtSecondOrder) {
  const Weakening law{0.6, 0.2, 10.0};
  const double n = 50.0, force = 32.0, start = 0.3, first = 0.1;
  const double w = std::sqrt(0.4 * n / 10.0), push = (force - 0.6 * n) / (w * w);
  const auto speed = [&](double t) { return start * std::cosh(w * t) + push * w * std::sinh(w * t); };
  double last = 0.0;
  for (const int steps : {20, 47, 113}) {
    const double h = 1.0 / steps, at = first - 0.5 * h;
    NodeRun node("slip_weakening", law.parameters(), h);
    node.state = {start / w * std::sinh(w * at) + push * (std::cosh(w * at) - 1.0)};
    node.v_previous = {0.0, speed(at), 0.0};
    for (int k = 0; k < steps; ++k)
      ASSERT_EQ(node.step({-n * h, node.v_previous[1] + force * h, 0.0}), ILAW_OK);
    const double constant = std::abs(node.v[1] - speed(at + 1.0)) * steps * steps;
    if (last > 0.0) {
      EXPECT_NEAR(constant / last, 1.0, 0.05) << steps;
    }
    last = constant;
  }
  EXPECT_GT(last, 1e-3);
}

}  // namespace
}  // namespace ilaw::testing
