// Rate and state: its equation over twelve decades of speed, its state in closed form, its order, its limits.
#include "support/law_runner.hpp"

namespace ilaw::testing {
namespace {

struct Surface {
  double f = 0.6, a = 0.012, b = 0.009, v0 = 1e-6, d = 1e-4;
  const char* evolution = "aging";

  Parameters parameters() const {
    return {{{"reference_friction", f},
             {"direct_effect", a},
             {"evolution_effect", b},
             {"reference_speed", v0},
             {"critical_slip", d}},
            {{"evolution", evolution}, {"activation", "moreau"}}};
  }
  double at(double v, double theta) const {
    return a * std::asinh(v / (2.0 * v0) * std::exp((f + b * std::log(v0 * theta / d)) / a));
  }
  double aged(double theta, double v, double t) const {
    const double x = v * t / d;
    if (evolution[0] == 's') return d / v * std::exp(std::log(v * theta / d) * std::exp(-x));
    return theta * std::exp(-x) - d / v * std::expm1(-x);
  }
};

// Nodes that are driven so that they slip at a speed drawn over twelve decades: it comes out.
TEST(RateAndState, SolvesItsEquationAtAnySpeed) {
  Random random(1);
  for (const char* evolution : {"aging", "slip"}) {
    Surface law;
    law.evolution = evolution;
    const double h = 0.01, drag = 0.7;
    NodeRun node("rate_and_state", law.parameters(), h, ILAW_DELASSUS_TRANSVERSE);
    node.h = {1.0, drag};
    for (int k = 0; k < 5000; ++k) {
      const double v = std::pow(10.0, -11.0 + 12.0 * random(0.0, 1.0)), was = v * (0.5 + random(0.0, 1.0));
      const double theta = law.d / v * std::pow(10.0, 2.0 * random(0.0, 1.0) - 1.0);
      const double middle = law.aged(theta, was, 0.5 * h), friction = law.at(v, middle);
      node.state = {theta};
      node.v_previous = {0.0, was, 0.0};
      ASSERT_EQ(node.step({-1.0, v + drag * friction, 0.0}), ILAW_OK) << node.report.reason;
      ASSERT_NEAR(node.r[1], -friction, 1e-13);
      const double after = law.aged(middle, v, 0.5 * h);
      // The rounding of v + drag mu is a part of mu, and exp(mu/a) of v.
      ASSERT_NEAR(node.state[0], after, 1e-12 * after) << evolution << ", v " << v;
    }
  }
}

// A coupled H: on the cone of the coefficient at the speed after the step, which is opposite to the impulse.
TEST(RateAndState, SolvesItsEquationForACoupledInertia) {
  Random random(3);
  const Surface law{.v0 = 1e-3, .d = 0.01};
  NodeRun node("rate_and_state", law.parameters(), 0.01, ILAW_DELASSUS_FULL);
  node.h = {1.0, 1.4, 0.8, 0.3, -0.2, 0.1};
  int solved = 0;
  for (int k = 0; k < 2000; ++k) {
    const Vector free{-1.0, 3.0 * random(), 3.0 * random()};
    node.state = {law.d / law.v0};
    node.v_previous = {0.0, free[1], free[2]};
    const double middle = law.aged(node.state[0], std::hypot(free[1], free[2]), 0.005);
    ASSERT_EQ(node.step(free), ILAW_OK);
    const double speed = std::hypot(node.v[1], node.v[2]);
    const double work = node.r[1] * (free[1] + node.v[1]) + node.r[2] * (free[2] + node.v[2]);
    if (speed < 1e-4 || std::abs(work) < 1e-9) continue;  // turned round: its work is taken off
    ++solved;
    ASSERT_NEAR(std::hypot(node.r[1], node.r[2]), law.at(speed, middle) * node.r[0], 1e-11 * node.r[0]) << k;
    ASSERT_NEAR(node.r[1] * node.v[2] - node.r[2] * node.v[1], 0.0, 1e-13);
  }
  EXPECT_GT(solved, 1900);
}

// m v' = F - N mu(v, theta) from a jump of the force, by Runge and Kutta's fourth order.
TEST(RateAndState, ConvergesToItsEquationAtFirstOrder) {
  const Surface law{.v0 = 0.1, .d = 0.3};
  const double n = 10.0, force = 6.3, end = 2.0, start = 0.1;
  double v = start, theta = law.d / law.v0;
  constexpr int fine = 20000;
  const auto rate = [&](double speed, double age, double& dv, double& dtheta) {
    dv = force - n * law.at(speed, age);
    dtheta = 1.0 - speed * age / law.d;
  };
  for (int k = 0; k < fine; ++k) {
    const double h = end / fine;
    double p[4], q[4];
    rate(v, theta, p[0], q[0]);
    rate(v + 0.5 * h * p[0], theta + 0.5 * h * q[0], p[1], q[1]);
    rate(v + 0.5 * h * p[1], theta + 0.5 * h * q[1], p[2], q[2]);
    rate(v + h * p[2], theta + h * q[2], p[3], q[3]);
    v += h / 6.0 * (p[0] + 2.0 * p[1] + 2.0 * p[2] + p[3]);
    theta += h / 6.0 * (q[0] + 2.0 * q[1] + 2.0 * q[2] + q[3]);
  }
  double last = 0.0;
  for (const int steps : {500, 1130, 2570}) {
    const double h = end / steps;
    NodeRun node("rate_and_state", law.parameters(), h);
    node.v_previous = {0.0, start, 0.0};
    for (int k = 0; k < steps; ++k)
      ASSERT_EQ(node.step({-n * h, node.v_previous[1] + force * h, 0.0}), ILAW_OK);
    const double constant = std::abs(node.v[1] - v) * steps;
    if (last > 0.0) {
      EXPECT_NEAR(constant / last, 1.0, 0.05) << steps;
    }
    last = constant;
  }
  EXPECT_GT(last, 1e-3);
}

// The age stands still while the node is free. Without initial_state it is that of steady slip at v_0.
TEST(RateAndState, AgesUnderPressureAlone) {
  const Surface law{.v0 = 0.1, .d = 0.3};
  NodeRun node("rate_and_state", law.parameters(), 0.01);
  EXPECT_EQ(node.state[0], 0.3 / 0.1);
  ASSERT_EQ(node.step({1.0, 0.0, 0.0}), ILAW_OK);
  EXPECT_EQ(node.state[0], 0.3 / 0.1);
  node.v_previous = {};
  ASSERT_EQ(node.step({-1.0, 0.0, 0.0}), ILAW_OK);
  EXPECT_NEAR(node.state[0], 0.3 / 0.1 + 0.01, 1e-15);
}

// a, b to 0: Coulomb's law with f_0, where the node slips.
TEST(RateAndState, ComesToCoulombWithoutItsEffects) {
  for (const double a : {1e-3, 1e-5, 1e-7}) {
    NodeRun node("rate_and_state", Surface{.f = 0.5, .a = a, .b = 0.0, .v0 = 1.0}.parameters(), 0.01);
    ASSERT_EQ(node.step({-2.0, 3.0, 0.0}), ILAW_OK);
    EXPECT_NEAR(node.r[1], -1.0, 2.0 * a * std::log(2.0));
    ASSERT_EQ(node.step({-2.0, 0.3, 0.0}), ILAW_OK);
    EXPECT_NEAR(node.v[1], 0.0, 1e-12);
  }
}

}  // namespace
}  // namespace ilaw::testing
