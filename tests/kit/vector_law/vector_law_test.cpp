// docs/vector_law.md: the law of the page in both its forms, against its closed forms.
#include "support/law_runner.hpp"
#include "support/small_batch.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace ilaw::testing {
namespace {

constexpr double mu_0 = 0.6, a = 0.012, b = 0.018, v_0 = 1e-6, slip_distance = 1e-5;
const double steps[] = {1e-3, 0.7e-3, 1.3e-4};  // without a common factor

Parameters parameters(double direct = a, double evolution = b) {
  return {{{"reference_friction", mu_0},
           {"direct_effect", direct},
           {"evolution_effect", evolution},
           {"reference_speed", v_0},
           {"slip_distance", slip_distance}},
          {}};
}

ilaw::interface made(const char* file, const Parameters& given = parameters()) {
  const SetupBuilder builder(given);
  return {ilaw::library(file), "rate_and_state", builder.setup};
}

// The regularised coefficient (Lapusta, Rice, Ben-Zion, Zheng 2000).
double coefficient(double speed, double age) {
  return a * std::asinh(speed / (2.0 * v_0) * std::exp((mu_0 + b * std::log(v_0 * age / slip_distance)) / a));
}

// A node that is pressed by 1 and driven along the first tangent.
struct Driven {
  explicit Driven(double speed, double step, double age) : nodes(1, {-2.0, speed, 0.0}, 1) {
    nodes.h[0] = 2.0;
    nodes.v[0] = -2.0;
    nodes.b.velocity_step = nodes.b.position_step = step;
    nodes.b.v_previous = {rest, 0, 1};
    nodes.state[0] = age;
  }
  void evaluate(const ilaw::interface& law) {
    EXPECT_EQ(law.evaluate(nodes.b), ILAW_OK);
    nodes.b.time += nodes.b.position_step;
  }
  double speed() const { return nodes.v[1] + 2.0 * nodes.r[0][1]; }
  double age() const { return nodes.state[0]; }

  double rest[3] = {};
  SmallBatch nodes;
};

class VectorLaw : public ::testing::TestWithParam<const char*> {};

TEST_P(VectorLaw, SolvesItsEquationAndAgesExactly) {
  const ilaw::interface law = made(GetParam());
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> exponent(-9.0, 1.0), ages(-6.0, 6.0);
  for (int k = 0; k < 600; ++k) {
    const double free = std::pow(10.0, exponent(random)), age = std::pow(10.0, ages(random));
    const double step = steps[k % 3];
    Driven node(free, step, age);
    node.evaluate(law);
    const double r = -node.nodes.r[0][1];
    ASSERT_NEAR(node.nodes.r[0][0], 1.0, 1e-15) << "k " << k;
    // |v_free| less 2 mu(V) is V itself. Where the node all but sticks, V is what rounding leaves.
    const double inverse =
        2.0 * v_0 * std::sinh(r / a) * std::exp(-(mu_0 + b * std::log(v_0 * age / slip_distance)) / a);
    ASSERT_NEAR(inverse, node.speed(), 1e-11 * free) << "seed 11, free speed " << free << ", age " << age;
    const double way = inverse * step / slip_distance;
    const double expected = slip_distance / inverse * -std::expm1(-way) + age * std::exp(-way);
    ASSERT_NEAR(node.age(), expected, 1e-9 * expected) << "seed 11, free speed " << free << ", age " << age;
    ASSERT_EQ(node.nodes.status[0], inverse > v_0 ? ILAW_SLIP : ILAW_STICK) << "k " << k;
  }
}

// theta = L/V, mu = mu_0 + (a - b) ln(V/V_0) (A. Ruina 1983), far above the speed of regularisation.
TEST_P(VectorLaw, SlidesSteadilyAtTheCoefficientOfDieterichAndRuina) {
  const ilaw::interface law = made(GetParam());
  for (const double step : steps) {
    Driven node(2.0, step, 1.0);
    for (int k = 0; k < 200; ++k) node.evaluate(law);
    const double speed = node.speed();
    EXPECT_NEAR(node.age() * speed / slip_distance, 1.0, 1e-9) << step;
    EXPECT_NEAR(-node.nodes.r[0][1], mu_0 + (a - b) * std::log(speed / v_0), 1e-9) << step;
    EXPECT_NEAR(-node.nodes.r[0][1], coefficient(speed, node.age()), 1e-9) << step;
  }
}

// At rest the age grows as time does, whatever the step; the strength after it by b ln of that.
TEST_P(VectorLaw, AgesAtRestByTheTime) {
  const ilaw::interface law = made(GetParam());
  for (const double step : steps) {
    Driven node(0.0, step, 1e-3);
    const int count = static_cast<int>(std::round(0.273 / step));
    for (int k = 0; k < count; ++k) node.evaluate(law);
    EXPECT_NEAR(node.age(), 1e-3 + count * step, 1e-12) << step;
    EXPECT_EQ(node.nodes.r[0][1], 0.0) << "step " << step;
    EXPECT_EQ(node.nodes.status[0], ILAW_STICK) << "step " << step;
  }
}

// Without effect of the age and hardly one of the speed it is Coulomb's friction.
TEST_P(VectorLaw, BecomesCoulombsWhereNothingEvolves) {
  const ilaw::interface law = made(GetParam(), parameters(1e-9, 0.0));
  Driven sliding(5.0, 1e-3, 1.0), sticking(0.5, 1e-3, 1.0);
  sliding.evaluate(law);
  sticking.evaluate(law);
  EXPECT_NEAR(-sliding.nodes.r[0][1], mu_0, 1e-7);
  EXPECT_NEAR(-sticking.nodes.r[0][1], 0.25, 1e-12);
}

// A node that came from the other side is not braked below the speed at which it came: that would add energy.
TEST_P(VectorLaw, LeavesANodeThatTurnedRoundTheSpeedAtWhichItCame) {
  const ilaw::interface law = made(GetParam());
  for (const double came : {0.0, 0.3, 0.9, 2.0}) {
    Driven node(0.5, 1e-3, 1.0);
    node.rest[1] = -came;
    node.evaluate(law);
    const double speed = std::min(came, 0.5);
    EXPECT_NEAR(node.speed(), speed, 1e-15) << came;
    const double way = speed * 1e-3 / slip_distance;
    const double aged = way > 0.0 ? std::exp(-way) - 1e-3 * std::expm1(-way) / way : 1.001;
    EXPECT_NEAR(node.age(), aged, 1e-9) << came;
  }
}

// An open contact keeps its age, to the last bit.
TEST_P(VectorLaw, LeavesOpenContactsAlone) {
  const ilaw::interface law = made(GetParam());
  Driven node(1.0, 1e-3, 0.123);
  node.nodes.gap = 0.1;
  node.evaluate(law);
  EXPECT_EQ(node.age(), 0.123);
  EXPECT_EQ(node.nodes.r[0][1], 0.0);
  EXPECT_EQ(node.nodes.status[0], ILAW_FREE);
}

INSTANTIATE_TEST_SUITE_P(Forms, VectorLaw, ::testing::Values(ILAW_NODE_BY_NODE, ILAW_RATE_AND_STATE),
                         [](const auto& form) { return form.index == 0 ? "NodeByNode" : "InPacks"; });

// Both forms give the same bits, also where lanes of one pack take different numbers of turns.
TEST(VectorLawForms, GiveTheSameBits) {
  const ilaw::interface alone = made(ILAW_NODE_BY_NODE), packs = made(ILAW_RATE_AND_STATE);
  constexpr std::size_t count = 1001;
  std::mt19937_64 random(12);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  std::vector<double> v(3 * count), before(3 * count), gap(count), h(count), age(count);
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t c = 0; c < 3; ++c) v[3 * i + c] = uniform(random);
    for (std::size_t c = 0; c < 3; ++c) before[3 * i + c] = uniform(random);
    gap[i] = uniform(random);
    h[i] = 2.0 + uniform(random);
    age[i] = std::exp(20.0 * uniform(random));
  }
  SmallBatch one(count, {}, 1), other(count, {}, 1);
  for (SmallBatch* nodes : {&one, &other}) {
    nodes->b.v_free = {v.data(), 3, 1};
    nodes->b.v_previous = {before.data(), 3, 1};
    nodes->b.gap = {gap.data(), 1, 1};
    nodes->b.delassus = {h.data(), 1, 1};
    nodes->state = age;
    nodes->b.state_in = {nodes->state.data(), 1, 1};
    nodes->b.state_out = {nodes->state.data(), 1, 1};
  }
  for (int k = 0; k < 3; ++k) {
    ASSERT_EQ(alone.evaluate(one.b), ILAW_OK) << "k " << k;
    ASSERT_EQ(packs.evaluate(other.b), ILAW_OK) << "k " << k;
    for (std::size_t i = 0; i < count; ++i) {
      ASSERT_EQ(one.r[i], other.r[i]) << "seed 12, step " << k << ", node " << i;
      ASSERT_EQ(one.state[i], other.state[i]) << "seed 12, step " << k << ", node " << i;
      ASSERT_EQ(one.status[i], other.status[i]) << "seed 12, step " << k << ", node " << i;
    }
  }
}

}  // namespace
}  // namespace ilaw::testing
