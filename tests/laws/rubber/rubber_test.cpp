// Friction of rubber: its curve over speed, temperature and pressure, the slip that is taken, its order.
#include "support/law_runner.hpp"

namespace ilaw::testing {
namespace {

struct Tread {
  double least = 0.4, most = 1.2, speed = 0.5, width = 2.0, temperature = 293.0, exponent = 0.0;

  Parameters parameters() const {
    return {{{"static_friction", least},
             {"peak_friction", most},
             {"peak_speed", speed},
             {"width", width},
             {"temperature", temperature},
             {"pressure_exponent", exponent}},
            {{"activation", "moreau"}}};
  }
  // Savkoor's curve at the speed a_T v, with a_T of Williams, Landel and Ferry as Grosch has it.
  double at(double v) const {
    const double above = std::max(temperature - 293.0, -50.0);
    const double decades = std::log10(v / speed) - 8.86 * above / (101.5 + above);
    return least + (most - least) * std::exp(-std::pow(width * decades, 2));
  }
};

TEST(Rubber, FollowsItsCurveOverTemperature) {
  Random random(1);
  for (int k = 0; k < 500; ++k) {
    Tread tread{.speed = 0.1, .width = 0.3 + random(0.0, 1.0)};
    tread.temperature = 223.0 + 150.0 * random(0.0, 1.0);
    const double v = std::pow(10.0, 8.0 * random(0.0, 1.0) - 6.0), push = 1e-6 * v;  // one slip alone
    NodeRun node("rubber", tread.parameters(), 0.01);
    node.v_previous = {0.0, v, 0.0};
    ASSERT_EQ(node.step({-push, v + push * tread.at(v), 0.0}), ILAW_OK) << node.report.reason;
    ASSERT_NEAR(node.r[1] / push, -tread.at(v), 1e-9) << v << " m/s, " << tread.temperature << " K";
  }
}

// Friction at the shifted speed and T_s is that at the speed and T: the isotherms collapse on one curve.
TEST(Rubber, CollapsesOnItsMasterCurve) {
  const auto friction = [](double temperature, double v) {
    NodeRun node("rubber", Tread{.width = 0.6, .temperature = temperature}.parameters(), 0.01);
    const double push = 1e-6 * v;  // one slip alone
    node.v_previous = {0.0, v, 0.0};
    EXPECT_EQ(node.step({-push, (1.0 + 1e-6) * v, 0.0}), ILAW_OK);
    return -node.r[1] / node.r[0];
  };
  double least = 1.0, most = 0.0;
  for (const double temperature : {263.0, 278.0, 293.0, 313.0, 353.0})
    for (const double v : {1e-3, 1e-2, 0.1, 1.0}) {
      const double above = temperature - 293.0, shift = std::pow(10.0, -8.86 * above / (101.5 + above));
      const double mu = friction(temperature, v);
      EXPECT_NEAR(mu, friction(293.0, shift * v), 1e-6) << v << " m/s, " << temperature << " K";
      least = std::min(least, mu);
      most = std::max(most, mu);
    }
  EXPECT_LT(least, 0.45);  // from end to end of the curve
  EXPECT_GT(most, 1.15);
}

// A bell of any width, down to speeds that the load cannot resolve.
TEST(Rubber, SolvesCreepAtAnySpeed) {
  for (const double width : {1e-3, 0.01, 0.1, 1.0, 30.0}) {
    const Tread tread{.speed = 0.5, .width = width};
    NodeRun node("rubber", tread.parameters(), 0.01, ILAW_DELASSUS_TRANSVERSE);
    node.h = {1.0, 0.7};
    for (double v = 0.49; v > 1e-200; v *= 0.61) {
      const double mu = tread.at(v);
      ASSERT_EQ(node.step({-1.0, v + 0.7 * mu, 0.0}), ILAW_OK) << node.report.reason;
      ASSERT_NEAR(node.r[1], -mu, 1e-13) << width << ", " << v << " m/s";
    }
  }
}

TEST(Rubber, FallsWithAPowerOfThePressure) {
  NodeRun node("rubber", Tread{.most = 0.4, .exponent = 0.25}.parameters(), 0.01);
  node.area = 2.0;
  for (const double pressure : {1e3, 1e5, 1.6e6}) {
    const double normal = pressure * 2.0 * 0.01;
    node.v_previous = {};
    ASSERT_EQ(node.step({-normal, 3.0 * normal, 0.0}), ILAW_OK);
    EXPECT_NEAR(node.r[1] / normal, -0.4 * std::pow(pressure / 1e5, -0.25), 1e-13);
  }
}

// The first solution of v + drag mu(v) = most from the speed before on, by small steps and bisection.
double reached(const Tread& tread, double most, double drag, double before) {
  const auto excess = [&](double v) { return v + drag * tread.at(v) - most; };
  double v = std::min(before, most);
  const bool up = excess(v) < 0.0;
  double next = v;
  while (next > 0.0 && (excess(next) < 0.0) == up) {
    v = next;
    next += up ? 2e-4 : -2e-4;
  }
  if (next <= 0.0 && (excess(0.0) < 0.0) == up) return 0.0;  // it stops
  next = std::max(next, 0.0);
  for (int k = 0; k < 100; ++k) {
    const double middle = 0.5 * (v + next);
    ((excess(middle) < 0.0) == up ? v : next) = middle;
  }
  return v;
}

TEST(Rubber, TakesTheSlipReachedFromTheOneBefore) {
  const Tread tread;
  Random random(2);
  NodeRun node("rubber", tread.parameters(), 0.01, ILAW_DELASSUS_TRANSVERSE);
  int sticks = 0, slow = 0, fast = 0;
  for (int k = 0; k < 3000; ++k) {
    const double drag = 4.0 * random(0.0, 1.0), most = 5.0 * random(0.0, 1.0),
                 before = 3.0 * random(0.0, 1.0);
    node.h = {1.0, drag};
    node.v_previous = {0.0, before, 0.0};
    ASSERT_EQ(node.step({-1.0, most, 0.0}), ILAW_OK);
    const double speed = reached(tread, most, drag, before + 1e-300);
    ASSERT_NEAR(node.v[1], speed, 1e-12) << k << ": " << most << ", " << drag << ", " << before;
    ++(node.status == ILAW_STICK ? sticks : speed < tread.speed ? slow : fast);
  }
  EXPECT_GT(sticks, 300);
  EXPECT_GT(slow, 300);
  EXPECT_GT(fast, 300);
}

// Any H: on the cone of the coefficient at the speed after the step, and against the slip.
TEST(Rubber, SolvesItsCurveForAnyInertia) {
  const Tread tread;
  Random random(3);
  NodeRun node("rubber", tread.parameters(), 0.01, ILAW_DELASSUS_FULL);
  node.h = {1.0, 1.4, 0.8, 0.3, -0.2, 0.1};
  int slips = 0;
  for (int k = 0; k < 3000; ++k) {
    const Vector before{0.0, 2.0 * random(), 2.0 * random()};
    const Vector free{-1.0, before[1] + random(), before[2] + random()};
    node.v_previous = before;
    ASSERT_EQ(node.step(free), ILAW_OK);
    const double speed = std::hypot(node.v[1], node.v[2]);
    const double work = node.r[1] * (before[1] + node.v[1]) + node.r[2] * (before[2] + node.v[2]);
    if (node.status != ILAW_SLIP || std::abs(work) < 1e-9) continue;  // turned round: its work is taken off
    ASSERT_NEAR(std::hypot(node.r[1], node.r[2]), tread.at(speed) * node.r[0], 1e-11) << k;
    ASSERT_NEAR(node.r[1] * node.v[2] - node.r[2] * node.v[1], 0.0, 1e-13);
    ++slips;
  }
  EXPECT_GT(slips, 1000);
}

}  // namespace
}  // namespace ilaw::testing
