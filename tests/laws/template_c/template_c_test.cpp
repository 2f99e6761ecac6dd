// template_c through the ABI: its slip against a bisection, its energies, its heat, its motion.
// SPDX-License-Identifier: BSD-3-Clause
#include "brake_reference.hpp"

#include <ilaw/loader.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

namespace ilaw::testing {
namespace {

constexpr FrictionTable brake{{0.0, 1.0, 4.0}, {273.15, 673.15}, {{{0.6, 0.4}, {0.4, 0.25}, {0.3, 0.2}}}};

// A setup with a table of friction; numbers of other parameters.
struct Brake {
  Brake() {
    axes[0] = {sizeof(ilaw_axis), 0, "slip_speed", brake.speeds.data(), 3};
    axes[1] = {sizeof(ilaw_axis), 0, "temperature", brake.temperatures.data(), 2};
    ilaw_argument& friction = add("friction", ILAW_KIND_VALUE_TABLE);
    friction.values = brake.mu[0].data();
    friction.axes = pointers;
    friction.axis_count = 2;
  }
  ilaw_argument& add(const char* name, ilaw_kind kind, double number = 0.0) {
    ilaw_argument& made = arguments.emplace_back();
    made.struct_size = sizeof made;
    made.kind = kind;
    made.name = name;
    made.number = number;
    return made;
  }
  ilaw::interface law() {
    std::vector<const ilaw_argument*> all;
    for (const ilaw_argument& argument : arguments) all.push_back(&argument);
    ilaw_setup setup{};
    setup.struct_size = sizeof setup;
    setup.dimension = 3;
    setup.delassus_form = ILAW_DELASSUS_TRANSVERSE;
    setup.frame = ILAW_FRAME_GLOBAL;
    setup.numbers = ILAW_NUMBERS_DOUBLE;
    setup.arguments = all.data();
    setup.argument_count = static_cast<std::uint32_t>(all.size());
    return {ilaw::library(ILAW_PLUGIN_FOLDER "/template_c.so"), "template_c", setup};
  }
  ilaw_axis axes[2]{};
  const ilaw_axis* pointers[2] = {&axes[0], &axes[1]};
  std::vector<ilaw_argument> arguments;
};

// A node pressed on a plane, with its arrays.
struct Node {
  double v_free[3]{}, v_previous[3]{}, h[2] = {1.0, 1.0}, gap = 0.0, n[3] = {0.0, 0.0, 1.0},
                                       temperature = 293.15;
  double r[3]{}, v[3]{}, energy[ILAW_ENERGY_COUNT]{}, heat = -1.0, counterpart_heat = -1.0;
  ilaw_status status = 99;

  void step(const ilaw::interface& law) {
    const ilaw_input field{&temperature, nullptr, 1, 1};
    const ilaw_output amounts[] = {{&heat, nullptr, 1, 1}, {&counterpart_heat, nullptr, 1, 1}};
    ilaw_batch b{};
    b.struct_size = sizeof b;
    b.node_count = 1;
    b.velocity_step = b.position_step = 1e-3;
    b.v_free = {v_free, nullptr, 3, 1};
    b.v_previous = {v_previous, nullptr, 3, 1};
    b.delassus = {h, nullptr, 2, 1};
    b.gap = {&gap, nullptr, 1, 1};
    b.normal = {n, nullptr, 3, 1};
    b.per_node_parameters = &field;
    b.impulse = {r, nullptr, 3, 1};
    b.velocity = {v, nullptr, 3, 1};
    b.energy = {energy, nullptr, 4, 1};
    b.status = &status;
    b.status_stride = 1;
    b.amounts = amounts;
    ASSERT_EQ(law.evaluate(b), ILAW_OK);
  }
};

TEST(template_c, SolvesTheSlipWithinTheStep) {
  Brake given;
  given.add("temperature", ILAW_KIND_VALUE_PER_NODE);
  const ilaw::interface law = given.law();
  Random random(1);
  int sticks = 0;
  for (int k = 0; k < 20000; ++k) {
    Node node;
    for (int c = 0; c < 2; ++c) node.v_previous[c] = node.v_free[c] = 8.0 * random(0.0, 1.0) - 4.0;
    node.v_free[2] = -8.0 * random(0.0, 1.0);
    node.h[0] = 0.5 + random(0.0, 1.0);
    node.h[1] = 0.5 + random(0.0, 1.0);
    node.temperature = 250.0 + 500.0 * random(0.0, 1.0);
    node.step(law);
    const double v_free = std::hypot(node.v_free[0], node.v_free[1]), r_N = -node.v_free[2] / node.h[0];
    const double v = slip_after(brake, node.temperature, node.h[1], r_N, v_free);
    ASSERT_NEAR(std::hypot(node.v[0], node.v[1]), v, 1e-13 * v_free) << "node " << k;
    ASSERT_NEAR(node.v[2], 0.0, 1e-15);
    ASSERT_EQ(node.status, v > 0.0 ? ILAW_SLIP : ILAW_STICK);
    sticks += v > 0.0 ? 0 : 1;
  }
  EXPECT_GT(sticks, 1000);
  EXPECT_LT(sticks, 19000);
}

// The parts are the work of the impulse, -r.(v^- + v)/2, and neither is negative, also where the force turns
// the motion round within the step.
TEST(template_c, DividesItsWork) {
  Brake given;
  given.add("temperature", ILAW_KIND_VALUE_NUMBER, 400.0);
  given.add("partition", ILAW_KIND_VALUE_NUMBER, 0.7);
  const ilaw::interface law = given.law();
  Random random(2);
  int turned = 0;
  for (int k = 0; k < 20000; ++k) {
    Node node;
    for (int c = 0; c < 3; ++c) {
      node.v_previous[c] = random(-2.0, 2.0);
      node.v_free[c] = random(-2.0, 2.0);
    }
    node.step(law);
    double work = 0.0, along = 0.0;
    for (int c = 0; c < 3; ++c) work += 0.5 * node.r[c] * (node.v_previous[c] + node.v[c]);
    for (int c = 0; c < 2; ++c) along += node.v_previous[c] * node.v_free[c];
    turned += node.r[2] > 0.0 && along < 0.0 && node.v_previous[2] > 0.0 ? 1 : 0;
    const double friction = node.energy[ILAW_ENERGY_FRICTION], impact = node.energy[ILAW_ENERGY_IMPACT];
    ASSERT_NEAR(friction + impact, -work, 1e-13) << "node " << k;
    ASSERT_GE(friction, 0.0);
    ASSERT_GE(impact, 0.0);
    ASSERT_NEAR(node.heat, 0.7 * friction, 1e-15 + 1e-15 * friction);
    ASSERT_NEAR(node.heat + node.counterpart_heat, friction, 1e-15 + 1e-15 * friction);
  }
  EXPECT_GT(turned, 500);
}

// A unit mass under its weight with one coefficient: v falls by mu g h in each step, and all of its kinetic
// energy becomes heat.
TEST(template_c, StopsABlockAsCoulombSays) {
  Brake given;
  given.arguments.clear();
  given.add("friction", ILAW_KIND_VALUE_NUMBER, 0.25);
  const ilaw::interface law = given.law();
  constexpr double h = 1e-3, g = 10.0, mu = 0.25, start = 2.0;
  double v = start, heat = 0.0;
  for (int k = 1; k <= 900; ++k) {
    Node node;
    node.v_previous[0] = node.v_free[0] = v;
    node.v_free[2] = -g * h;
    node.step(law);
    v = node.v[0];
    heat += node.heat + node.counterpart_heat;
    ASSERT_NEAR(v, std::max(0.0, start - k * mu * g * h), 1e-12) << "step " << k;
  }
  EXPECT_NEAR(heat, 0.5 * start * start, 1e-12);
}

TEST(template_c, RefusesATableOverAFieldThatIsNotGiven) {
  try {
    Brake().law();
    FAIL() << "accepted";
  } catch (const ilaw::error& error) {
    EXPECT_THAT(
        std::string(error.what()),
        HasSubstr("parameter 'friction' is a table over 'temperature': expected a value, a value per node"))
        << error.what();
  }
}

}  // namespace
}  // namespace ilaw::testing
