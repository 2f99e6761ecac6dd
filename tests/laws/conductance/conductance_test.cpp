// Heat through contact: the two conductances, the exchange of two capacities, none without contact.
#include "support/law_runner.hpp"

namespace ilaw::testing {
namespace {

// h_c A (T_c - T) h with h_c = h_0 + h_p p and p = r_N/(h A), of both signs.
TEST(Conductance, ConductsByAreaAndPressure) {
  Random random(1);
  for (int k = 0; k < 200; ++k) {
    const double constant = 300.0 * random(0.0, 1.0), slope = 0.2 * random(0.0, 1.0), h = 0.01;
    const double cold = 250.0 + 100.0 * random(0.0, 1.0), warm = 250.0 + 100.0 * random(0.0, 1.0);
    NodeRun node("conductance",
                 {{{"conductance", constant},
                   {"conductance_per_pressure", slope},
                   {"temperature", cold},
                   {"counterpart_temperature", warm}},
                  {{"activation", "moreau"}}},
                 h);
    node.area = 0.2 + random(0.0, 1.0);
    const double normal = 5.0 * random(0.0, 1.0), pressure = normal / (h * node.area);
    ASSERT_EQ(node.step({-normal, 1.0, 0.0}), ILAW_OK);
    ASSERT_EQ(node.r, (Vector{normal, 0.0, 0.0}));
    const double heat = (constant + slope * pressure) * node.area * (warm - cold) * h;
    ASSERT_NEAR(node.amount("conducted_heat"), heat, 1e-14 * std::abs(heat));
  }
}

// Two capacities come to their equilibrium by e^(-G t (1/C + 1/C_c)), for any step, as the sum of both keeps.
TEST(Conductance, BringsTwoBodiesToTheirEquilibrium) {
  const double g = 20.0, c = 2.0, other = 6.0, end = 0.5;
  for (const double h : {0.5, 0.05, 0.007}) {
    double warm = 400.0, cold = 300.0;
    const double middle = (c * cold + other * warm) / (c + other);
    for (double t = h; t <= end * 1.0001; t += h) {
      NodeRun node("conductance",
                   {{{"conductance", g},
                     {"temperature", cold},
                     {"counterpart_temperature", warm},
                     {"heat_capacity", c},
                     {"counterpart_heat_capacity", other}},
                    {{"activation", "moreau"}}},
                   h);
      ASSERT_EQ(node.step({-1.0, 0.0, 0.0}), ILAW_OK);
      cold += node.amount("conducted_heat") / c;
      warm -= node.amount("conducted_heat") / other;
      const double left = std::exp(-g * t * (1.0 / c + 1.0 / other));
      ASSERT_NEAR(warm - cold, 100.0 * left, 1e-10) << h << ", " << t;
      ASSERT_NEAR((c * cold + other * warm) / (c + other), middle, 1e-10);
    }
  }
}

// As long a step as a double holds: the flow is infinite, and no heat flows without a difference.
TEST(Conductance, IsNoNaNInAnyStep) {
  for (const double capacity : {2.0, HUGE_VAL}) {
    NodeRun node("conductance", {{{"conductance", 100.0}, {"heat_capacity", capacity}}, {}}, 1e308);
    ASSERT_EQ(node.step({-1.0, 0.0, 0.0}), ILAW_OK);
    EXPECT_EQ(node.amount("conducted_heat"), 0.0);
    EXPECT_EQ(node.amount("heat_per_kelvin"), HUGE_VAL);
  }
}

TEST(Conductance, ConductsNothingThroughAGap) {
  NodeRun node("conductance", {{{"conductance", 100.0}, {"temperature", 400.0}}, {}}, 0.01);
  node.gap = 0.1;
  ASSERT_EQ(node.step({-1.0, 0.0, 0.0}), ILAW_OK);
  EXPECT_EQ(node.amount("conducted_heat"), 0.0);
  EXPECT_EQ(node.status, ILAW_FREE);
}

TEST(Conductance, ReadsTheAreaForItsConstantAlone) {
  const auto inputs_of = [](const char* name) {
    return NodeRun("conductance", {{{name, 1.0}}, {}}).interface.info().inputs;
  };
  EXPECT_TRUE(inputs_of("conductance") & ILAW_INPUT_AREA);
  EXPECT_FALSE(inputs_of("conductance_per_pressure") & ILAW_INPUT_AREA);
}

}  // namespace
}  // namespace ilaw::testing
