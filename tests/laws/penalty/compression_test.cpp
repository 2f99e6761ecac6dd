// The normal equation of the implicit penalty, through the ABI, against its defining equation in long double.
#include "support/law_runner.hpp"

#include <limits>
#include <random>

namespace ilaw::testing {
namespace {

constexpr double inf_value = std::numeric_limits<double>::infinity();

// h <k <-g'>^p - c v> - r at a trial r, which falls as r grows: positive below the solution, negative above.
struct Equation {
  long double gap, velocity, delassus, step, stiffness, damping, exponent;

  long double excess(long double r) const {
    const long double v = velocity + delassus * r, next = gap + step * v;
    if (next >= 0.0L) return -r;  // open, also where the damper alone would still act
    const long double force = stiffness * std::pow(-next, exponent) - damping * v;
    return step * std::max(force, 0.0L) - r;
  }
};

// The law's impulse brackets the solution within a relative tolerance of itself, and of what rounding of the
// velocity at which the gap closes, v_free + g/l, and of the damper's part make of it: dr is at most p
// r/reach or 1/H of the former.
void expect_solution(const Equation& e, double given, double tolerance) {
  const long double r = given, cancelled = std::abs(e.velocity) + std::abs(e.gap) / e.step;
  const long double viscous = e.step * e.damping * std::abs(e.velocity), reach = e.velocity + e.gap / e.step;
  const long double amplified = e.exponent * (r + viscous) / std::abs(reach) * cancelled;
  const long double slack = tolerance * (r + std::min(amplified, cancelled / e.delassus));
  EXPECT_LE(e.excess(r + slack), 0.0L) << "r = " << given;
  if (given > 0.0) {
    EXPECT_GE(e.excess(r - slack), 0.0L) << "r = " << given;
  }
}

// Stiffness, mass and speed over 300 decades. The gap is drawn beside what the step moves it by.
TEST(Compression, LinearSolvesItsEquation) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0), decades(-150.0, 150.0), few(-3.0, 3.0);
  int closed = 0;
  for (int instance = 0; instance < 1000 && !::testing::Test::HasFailure(); ++instance) {
    const double h = 1e-3, delassus = std::pow(10.0, decades(random));
    // Around the element's own stiffness m/h^2, and anywhere else.
    const double stiffness =
        instance % 2 ? std::pow(10.0, few(random)) / (h * h * delassus) : std::pow(10.0, decades(random));
    const double damping = instance % 3 ? 0.0 : std::pow(10.0, few(random)) / (h * delassus);
    NodeRun node("penalty", {{{"stiffness", stiffness}, {"damping", damping}}, {{"integration", "implicit"}}},
                 h);
    node.h[0] = delassus;
    for (int k = 0; k < 1000; ++k) {
      const double scale = std::pow(10.0, 0.5 * decades(random)), v = scale * uniform(random);
      node.gap = h * scale * std::pow(10.0, few(random)) * uniform(random);
      ASSERT_EQ(node.step({v, 0.3 * scale, 0.0}), ILAW_OK) << node.report.reason;
      expect_solution({node.gap, v, delassus, h, stiffness, damping, 1.0L}, node.r[0], 1e-15);
      closed += node.r[0] > 0.0;
    }
  }
  EXPECT_GT(closed, 400000);
}

// Other exponents, soft to stiff; the power itself is good to 1 + |p ln| ulp.
TEST(Compression, PowerLawSolvesItsEquation) {
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0), decades(-12.0, 12.0), exponents(1.0, 8.0);
  int closed = 0;
  for (int instance = 0; instance < 500 && !::testing::Test::HasFailure(); ++instance) {
    const double h = 1e-3, delassus = std::pow(10.0, decades(random)),
                 exponent = instance % 2 ? 1.5 : exponents(random);
    const double stiffness = std::pow(10.0, decades(random)) / (h * h * delassus);
    const double damping = instance % 3 ? 0.0 : std::pow(10.0, 0.25 * decades(random)) / (h * delassus);
    NodeRun node("penalty",
                 {{{"stiffness", stiffness}, {"damping", damping}, {"exponent", exponent}},
                  {{"integration", "implicit"}}},
                 h);
    node.h[0] = delassus;
    for (int k = 0; k < 1000; ++k) {
      const double scale = std::pow(10.0, 0.25 * decades(random)), v = scale * uniform(random);
      node.gap = 3.0 * h * scale * uniform(random);
      ASSERT_EQ(node.step({v, 0.0, 0.0}), ILAW_OK) << node.report.reason;
      expect_solution({node.gap, v, delassus, h, stiffness, damping, exponent}, node.r[0], 5e-15 * exponent);
      closed += node.r[0] > 0.0;
    }
  }
  EXPECT_GT(closed, 200000);
}

// Exponent 1 by the general route would be the same: continuity in the exponent.
TEST(Compression, PowerLawTendsToLinear) {
  const double h = 1e-2;
  for (const double stiffness : {1e-3, 1e2, 1e4, 1e6, 1e12}) {
    NodeRun linear("penalty", {{{"stiffness", stiffness}, {"damping", 3.0}}, {{"integration", "implicit"}}},
                   h);
    NodeRun nearly("penalty",
                   {{{"stiffness", stiffness}, {"damping", 3.0}, {"exponent", 1.0 + 1e-13}},
                    {{"integration", "implicit"}}},
                   h);
    linear.gap = nearly.gap = -0.02;
    ASSERT_EQ(linear.step({-1.0, 0, 0}), ILAW_OK);
    ASSERT_EQ(nearly.step({-1.0, 0, 0}), ILAW_OK);
    EXPECT_NEAR(nearly.r[0], linear.r[0], 1e-12 * linear.r[0]);
  }
}

// A damper that would stop the node before it arrives stops it on arrival: v = -g/h, the vertical segment of
// the law's graph. It never pulls, also when the node leaves fast.
TEST(Compression, DamperActsWhereTheNextGapIsClosed) {
  NodeRun node("penalty", {{{"stiffness", 1.0}, {"damping", 1e9}}, {{"integration", "implicit"}}}, 1e-2);
  node.gap = 5e-3;
  ASSERT_EQ(node.step({-1.0, 0, 0}), ILAW_OK);
  EXPECT_NEAR(node.v[0], -0.5, 1e-15);
  node.gap = -5e-3;
  ASSERT_EQ(node.step({0.3, 0, 0}), ILAW_OK);
  EXPECT_EQ(node.r[0], 0.0);
}

// k -> inf from an open or just closed gap: the gap stays closed to zero, law contact with the predictive
// activation, at the rate r_contact - r = r_contact/(1 + h l k H).
TEST(Compression, TendsToPredictiveContact) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0), exponent(-100.0, 100.0);
  const Parameters predictive{{}, {{"activation", "predictive"}}};
  for (const double stiffness : {1e9, 1e12, 1e15, 1e18, inf_value}) {
    NodeRun node("penalty", {{{"stiffness", stiffness}}, {{"integration", "implicit"}}}),
        contact("contact", predictive);
    NodeRun hertz("penalty", {{{"stiffness", stiffness}, {"exponent", 1.5}, {"damping", 2.0}},
                              {{"integration", "implicit"}}});
    for (int k = 0; k < 50000; ++k) {
      const double scale = stiffness < inf_value ? 1.0 : std::pow(10.0, exponent(random));
      const Vector v{scale * uniform(random), scale * uniform(random), scale * uniform(random)};
      node.gap = contact.gap = 1e-3 * scale * uniform(random);
      if (stiffness < inf_value) node.gap = contact.gap = std::abs(node.gap);
      node.h[0] = contact.h[0] = hertz.h[0] = 1.0 + 0.9 * uniform(random);
      hertz.gap = node.gap;
      ASSERT_EQ(node.step(v), ILAW_OK);
      ASSERT_EQ(contact.step(v), ILAW_OK);
      ASSERT_EQ(hertz.step(v), ILAW_OK);
      if (stiffness == inf_value) {
        ASSERT_EQ(node.r, contact.r);
        ASSERT_EQ(hertz.r, contact.r);
        ASSERT_EQ(node.status, contact.status);
      } else {
        const double gain = 1e-6 * stiffness * node.h[0];
        ASSERT_NEAR(contact.r[0] - node.r[0], contact.r[0] / (1.0 + gain), 4e-16 * contact.r[0]);
      }
    }
  }
}

}  // namespace
}  // namespace ilaw::testing
