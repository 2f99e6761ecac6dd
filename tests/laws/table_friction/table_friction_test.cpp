// Friction from a table: its values, the slip that is taken where there are several, its order, its refusals.
#include "support/law_batch.hpp"

#include <functional>

namespace ilaw::testing {
namespace {

using Axis = ilaw::parameters::axis;

Parameters table_of(const std::vector<Axis>& axes, const std::vector<double>& values) {
  Parameters given{.numbers = {}, .texts = {{"activation", "moreau"}}};
  given.grids["friction"] = {axes, values};
  return given;
}

// Linear between points, constant beyond.
double between(const std::vector<double>& x, const std::vector<double>& y, double at) {
  if (at <= x.front()) return y.front();
  for (std::size_t k = 1; k < x.size(); ++k)
    if (at < x[k]) return y[k - 1] + (y[k] - y[k - 1]) * (at - x[k - 1]) / (x[k] - x[k - 1]);
  return y.back();
}

// Falls so fast at 1 m/s that three slips are possible for drags above 0.25.
const std::vector<double> speeds{0.0, 1.0, 1.1, 2.0, 2.05}, coefficients{0.6, 0.6, 0.2, 0.5, 0.1};
double falling(double v) { return between(speeds, coefficients, v); }

// The first solution of v + drag mu(v) = most from the speed before on, by small steps and bisection.
double reached(double most, double drag, double before) {
  const auto excess = [&](double v) { return v + drag * falling(v) - most; };
  double v = std::min(before, most);
  const double step = excess(v) < 0.0 ? 1e-4 : -1e-4;
  double next = v;
  while (next >= 0.0 && (excess(next) < 0.0) == (step > 0.0)) {
    v = next;
    next += step;
  }
  next = std::max(next, 0.0);
  if ((excess(next) < 0.0) == (step > 0.0)) return 0.0;  // it stops
  for (int k = 0; k < 100; ++k) {
    const double middle = 0.5 * (v + next);
    ((excess(middle) < 0.0) == (step > 0.0) ? v : next) = middle;
  }
  return v;
}

TEST(TableFriction, TakesTheSlipReachedFromTheOneBefore) {
  Random random(1);
  NodeRun node("table_friction", table_of({{"slip_speed", speeds}}, coefficients), 0.01,
               ILAW_DELASSUS_TRANSVERSE);
  int sticks = 0, slips = 0;
  for (int k = 0; k < 3000; ++k) {
    const double drag = 2.0 * random(0.0, 1.0), most = 4.0 * random(0.0, 1.0),
                 before = 3.0 * random(0.0, 1.0);
    const double angle = 6.28 * random(0.0, 1.0), c = std::cos(angle), s = std::sin(angle);
    node.h = {1.0, drag};
    node.v_previous = {0.0, before * c, before * s};
    ASSERT_EQ(node.step({-1.0, most * c, most * s}), ILAW_OK);
    const double speed = reached(most, drag, before);
    ASSERT_NEAR(std::hypot(node.v[1], node.v[2]), speed, 1e-13) << k;
    ASSERT_LE(std::hypot(node.r[1], node.r[2]), falling(speed) * (1.0 + 1e-14));
    ++(node.status == ILAW_STICK ? sticks : slips);
  }
  EXPECT_GT(sticks, 300);
  EXPECT_GT(slips, 1000);
}

// A load that grows and falls: the fall at 1 m/s is jumped at 1.6 going up, at 1.3 coming down.
TEST(TableFriction, HasALoopWhereItFallsSteeply) {
  NodeRun node("table_friction", table_of({{"slip_speed", {0.0, 1.0, 1.1}}}, {0.6, 0.6, 0.2}), 0.01,
               ILAW_DELASSUS_TRANSVERSE);
  node.h = {1.0, 1.0};
  const auto speed_at = [&](double load) {
    EXPECT_EQ(node.step({-1.0, load, 0.0}), ILAW_OK);
    return node.v[1];
  };
  EXPECT_EQ(speed_at(0.599), 0.0);
  for (const double load : {0.7, 1.0, 1.35, 1.599}) EXPECT_NEAR(speed_at(load), load - 0.6, 1e-15);
  for (const double load : {1.601, 3.0, 1.5, 1.301}) EXPECT_NEAR(speed_at(load), load - 0.2, 1e-15);
  for (const double load : {1.299, 0.7}) EXPECT_NEAR(speed_at(load), load - 0.6, 1e-15);
  EXPECT_EQ(speed_at(0.599), 0.0);
}

// mu = (0.2 + 0.1 v) (1 - 0.1 p) (2 - T/300): exact between points, constant beyond.
TEST(TableFriction, IsLinearInSpeedPressureAndTemperature) {
  const std::vector<double> v{0.0, 1.0, 4.0}, p{0.0, 2.0, 5.0}, t{200.0, 300.0};
  std::vector<double> values;
  for (const double x : t)  // in any order of the axes
    for (const double y : v)
      for (const double z : p) values.push_back((0.2 + 0.1 * y) * (1.0 - 0.1 * z) * (2.0 - x / 300.0));
  Parameters given = table_of({{"temperature", t}, {"slip_speed", v}, {"pressure", p}}, values);
  Random random(2);
  for (int k = 0; k < 300; ++k) {
    const double temperature = 150.0 + 200.0 * random(0.0, 1.0), h = 0.01, area = 0.5 + random(0.0, 1.0);
    given.numbers["temperature"] = temperature;
    NodeRun node("table_friction", given, h, ILAW_DELASSUS_TRANSVERSE);
    const double normal = 0.08 * random(0.0, 1.0), slip = 6.0 * random(0.0, 1.0);
    const double factor = (1.0 - 0.1 * std::min(normal / (h * area), 5.0)) *
                          (2.0 - std::clamp(temperature, 200.0, 300.0) / 300.0);
    const double mu = (0.2 + 0.1 * std::min(slip, 4.0)) * factor;
    node.area = area;
    node.h = {1.0, 1.5};
    node.v_previous = {0.0, slip, 0.0};
    ASSERT_EQ(node.step({-normal, slip + 1.5 * mu * normal, 0.0}), ILAW_OK);
    ASSERT_NEAR(node.r[1], -mu * normal, 1e-15);
    ASSERT_NEAR(node.v[1], slip, 1e-14);
  }
}

// m v' = -N (0.2 + 0.1 v): v = (v_0 + 2) e^(-0.1 N t/m) - 2.
TEST(TableFriction, ConvergesToItsEquationAtFirstOrder) {
  const double n = 10.0, exact = 6.0 * std::exp(-0.5) - 2.0;
  double last = 0.0;
  for (const int steps : {20, 47, 113}) {
    const double h = 0.5 / steps;
    NodeRun node("table_friction", table_of({{"slip_speed", {0.0, 1.0, 5.0}}}, {0.2, 0.3, 0.7}), h);
    node.v_previous = {0.0, 4.0, 0.0};
    for (int k = 0; k < steps; ++k) ASSERT_EQ(node.step({-n * h, node.v_previous[1], 0.0}), ILAW_OK);
    const double constant = std::abs(node.v[1] - exact) * steps;
    if (last > 0.0) {
      EXPECT_NEAR(constant / last, 1.0, 0.02) << steps;
    }
    last = constant;
  }
  EXPECT_GT(last, 1e-2);
}

// Any H: the impulse is on the cone of the coefficient at the speed after the step, and against the slip. An
// uncoupled one gives the motion of the closed form, with the same choice of slip.
TEST(TableFriction, SolvesItsTableForAnyInertia) {
  Random random(3);
  const Parameters given = table_of({{"slip_speed", speeds}}, coefficients);
  NodeRun node("table_friction", given, 0.01, ILAW_DELASSUS_FULL),
      same("table_friction", given, 0.01, ILAW_DELASSUS_FULL),
      plain("table_friction", given, 0.01, ILAW_DELASSUS_TRANSVERSE);
  same.h = {1.0, 1.3, 1.3, 0.0, 0.0, 0.0};
  plain.h = {1.0, 1.3};
  node.h = {1.0, 1.4, 0.8, 0.3, -0.2, 0.1};
  int slips = 0;
  for (int k = 0; k < 3000; ++k) {
    const Vector before{0.0, 2.0 * random(), 2.0 * random()};
    const Vector free{-1.0, before[1] + random(), before[2] + random()};
    same.v_previous = plain.v_previous = node.v_previous = before;
    ASSERT_EQ(plain.step(free), ILAW_OK);
    ASSERT_EQ(same.step(free), ILAW_OK);
    ASSERT_THAT(same.r, VectorNear(plain.r, 1e-13));
    ASSERT_EQ(node.step(free), ILAW_OK);
    const double speed = std::hypot(node.v[1], node.v[2]);
    const double work = node.r[1] * (before[1] + node.v[1]) + node.r[2] * (before[2] + node.v[2]);
    if (node.status != ILAW_SLIP || std::abs(work) < 1e-9) continue;  // turned round: its work is taken off
    ASSERT_NEAR(std::hypot(node.r[1], node.r[2]), falling(speed) * node.r[0], 1e-11) << k;
    ASSERT_NEAR(node.r[1] * node.v[2] - node.r[2] * node.v[1], 0.0, 1e-13);
    ++slips;
  }
  EXPECT_GT(slips, 1000);
}

TEST(TableFriction, ReadsTheAreaForPressureAlone) {
  const auto inputs_of = [](const char* axis) {
    return NodeRun("table_friction", table_of({{axis, {0.0, 1.0}}}, {0.3, 0.2})).interface.info().inputs;
  };
  EXPECT_FALSE(inputs_of("slip_speed") & ILAW_INPUT_AREA);
  EXPECT_TRUE(inputs_of("pressure") & ILAW_INPUT_AREA);
}

// A table over time, and over a field that comes per node, as the node's.
TEST(TableFriction, ReadsTimeAndFieldsOfNodes) {
  Parameters given = table_of({{"time", {0.0, 1.0}}, {"temperature", {200.0, 400.0}}}, {0.1, 0.3, 0.5, 0.7});
  EXPECT_THAT(refusal_of("table_friction", given), HasSubstr("is a table over 'temperature'"));
  given.per_node = {"temperature"};
  const double fields[] = {200.0, 250.0, 400.0, 500.0, 100.0}, expected[] = {0.2, 0.25, 0.4, 0.4, 0.2};
  LawBatch nodes(make_law("table_friction", SetupBuilder(given)), 5);
  nodes.time = 0.25;
  nodes.per_node = {ilaw::input(fields, 1, 1)};
  for (std::size_t k = 0; k < 5; ++k) nodes.v_free[k] = nodes.v_previous[k] = {-1.0, 4.0, 0.0};
  ASSERT_EQ(nodes.evaluate(), ILAW_OK) << nodes.report.reason;
  for (std::size_t k = 0; k < 5; ++k) EXPECT_NEAR(nodes.r[k][1], -expected[k], 1e-15) << k;
}

}  // namespace
}  // namespace ilaw::testing
