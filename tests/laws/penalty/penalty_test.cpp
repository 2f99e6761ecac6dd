// Regularised friction, limits, and bad parameters of the penalty law.
#include "support/law_batch.hpp"
#include "support/sizes.hpp"

namespace ilaw::testing {
namespace {

Parameters with(const std::string& integration, std::map<std::string, double> numbers) {
  return {std::move(numbers), {{"integration", integration}}};
}

// Pressed to r_N = h k 0.01 and dragged at speed (0.6, -0.8) V: the spring gives k_T V t until mu N, then
// slides. Explicit, the spring lags by the step it is found at; implicit, it is the mean of the step.
TEST(PenaltyFriction, SticksUpToTheConeThenSlides) {
  constexpr double h = 1e-3, stiffness = 1e4, tangential = 2e3, friction = 0.4, speed = 0.5;
  for (const char* integration : {"explicit", "implicit"}) {
    NodeRun node(
        "penalty",
        with(integration,
             {{"stiffness", stiffness}, {"tangential_stiffness", tangential}, {"friction", friction}}),
        h);
    node.gap = -0.01;   // a normal force of 100
    node.h[0] = 1e-12;  // a driven node
    node.v_previous = {0.0, 0.6 * speed, -0.8 * speed};
    const bool is_explicit = integration == std::string("explicit");
    if (!is_explicit) node.state[0] = 0.01;
    double dissipated = 0.0;
    for (int k = 1; k <= 100; ++k) {
      ASSERT_EQ(node.step({0.0, 0.6 * speed, -0.8 * speed}), ILAW_OK);
      const double lag = is_explicit ? 1.0 : 0.5;
      const double force = std::min(tangential * speed * h * (k - lag), friction * 100.0);
      EXPECT_NEAR(node.r[1], -0.6 * h * force, 1e-12) << integration << " " << k;
      EXPECT_NEAR(node.r[2], 0.8 * h * force, 1e-12);
      EXPECT_NEAR(node.r[0], h * 100.0, 1e-12);
      if (k > 1 && k != 40 && k != 41) {  // on the cone itself rounding decides
        EXPECT_EQ(node.status, force < friction * 100.0 ? ILAW_STICK : ILAW_SLIP) << k;
      }
      dissipated += node.energy[ILAW_ENERGY_FRICTION];
    }
    // Sliding from 0.04 s on, with the force 40; the spring holds 40^2/(2 k_T) = 0.4.
    EXPECT_NEAR(dissipated, 40.0 * speed * (0.1 - 0.04), 40.0 * speed * 2.0 * h) << integration;
    EXPECT_NEAR(node.energy[ILAW_ENERGY_STORED], 0.5 * stiffness * 1e-4 + 0.4, 40.0 * speed * 2.0 * h);
  }
}

// Opening forgets the spring.
TEST(PenaltyFriction, LiftedContactForgets) {
  for (const char* integration : {"explicit", "implicit"}) {
    NodeRun node("penalty",
                 with(integration, {{"stiffness", 1e4}, {"tangential_stiffness", 1e3}, {"friction", 1.0}}));
    node.gap = -0.01;
    ASSERT_EQ(node.step({-1.0, 1.0, 0.0}), ILAW_OK);
    EXPECT_NE(node.state[1], 0.0);
    ASSERT_EQ(node.step({100.0, 1.0, 0.0}), ILAW_OK);  // opens within this step
    EXPECT_GT(node.r[0], 0.0);
    node.gap = 1.0;
    ASSERT_EQ(node.step({100.0, 1.0, 0.0}), ILAW_OK);
    for (const double entry : node.state) EXPECT_EQ(entry, 0.0);
    EXPECT_EQ(node.status, ILAW_FREE);
  }
}

// Both stiffnesses infinite: Newton's impact with Coulomb friction, also for mu = inf, of a node that arrives
// without slip before; half a step decides about the gap.
TEST(PenaltyFriction, RigidSpringsAreCoulomb) {
  Random random(1);
  for (const std::uint32_t form : {ILAW_DELASSUS_SCALAR, ILAW_DELASSUS_FULL})
    for (const double friction : {0.0, 0.4, inf_value})
      for (const double e : {0.0, 0.6, 1.0}) {
        NodeRun node("penalty",
                     with("implicit", {{"stiffness", inf_value}, {"friction", friction}, {"restitution", e}}),
                     1e-3, form);
        NodeRun coulomb("coulomb", {{{"friction", friction}, {"restitution", e}}, {{"activation", "moreau"}}},
                        1e-3, form);
        const double coupling = friction < inf_value ? 0.3 : 0.0;
        int closed = 0;
        for (int k = 0; k < 20000; ++k) {
          const double scale = random.decades(-100.0, 100.0);
          const Vector v = random.vector(scale);
          node.v_previous = coulomb.v_previous = {-scale * std::abs(random()), 0.0, 0.0};
          node.gap = 1e-3 * scale * random();
          const bool in_reach = node.gap <= 0.0 || node.gap + node.dt * v[0] <= 0.0;
          coulomb.gap = in_reach ? node.gap + 0.5 * node.dt * node.v_previous[0] : node.gap;
          const double size = 1.0 + 0.9 * random(), couples = size * coupling * random();
          node.h = coulomb.h = {size, size, 0.7 * size, couples, -0.5 * couples, 0.3 * couples};
          ASSERT_EQ(node.step(v), ILAW_OK);
          ASSERT_EQ(coulomb.step(v), ILAW_OK);
          const double rounding = 32 * ulp * scale / size;
          ASSERT_THAT(node.r, VectorNear(coulomb.r, rounding))
              << "mu " << friction << ", e " << e << ", k " << k;
          for (const double entry : node.state) ASSERT_EQ(entry, 0.0);
          closed += node.r[0] > 0.0;
        }
        EXPECT_GT(closed, 4000);
      }
}

// With friction: the spring of a sticking node moves along and pulls with its mean, one that slides pulls
// with mu r_N the way its mean would be strained. Whatever the normal spring, coupling and all.
TEST(Penalty, WithFrictionServesAnyH) {
  constexpr double h = 1e-2, k = 1e3, tangential = 600.0, mu = 0.3;
  Random random(6);
  for (const std::map<std::string, double>& more : {std::map<std::string, double>{},
                                                    {{"damping", 5.0}},
                                                    {{"restitution", 0.3}},
                                                    {{"exponent", 1.5}, {"damping", 1.0}}}) {
    std::map<std::string, double> numbers = more;
    numbers.insert({{"stiffness", k}, {"tangential_stiffness", tangential}, {"friction", mu}});
    const bool plain = more.empty();
    NodeRun node("penalty", with("implicit", numbers), h, ILAW_DELASSUS_FULL);
    int sticking = 0, slipping = 0;
    for (int trial = 0; trial < 10000; ++trial) {
      node.h = {4.0, 3.0, 2.0, random(), random(), random()};
      node.gap = 0.05 * random();
      const Vector previous = {random(), 0.2 * random(), 0.2 * random()};
      node.v_previous = previous;
      const std::vector<double> before = node.state;
      ASSERT_EQ(node.step({random(), 0.2 * random(), 0.2 * random()}), ILAW_OK);
      if (plain && node.state[0] > 0.0) {
        ASSERT_NEAR(node.r[0], 0.5 * h * k * (before[0] + node.state[0]), 1e-13);
        ASSERT_NEAR(node.state[0], before[0] - 0.5 * h * (previous[0] + node.v[0]), 1e-15);
      }
      const double shear = std::hypot(node.r[1], node.r[2]);
      ASSERT_LE(shear, mu * node.r[0] * (1.0 + 8 * ulp));
      double along = 0.0, strain = 0.0;
      for (std::size_t c = 1; c < 3; ++c) {
        const double mean = before[c] + 0.25 * h * (previous[c] + node.v[c]);
        along -= mean * node.r[c];
        strain = std::hypot(strain, mean);
        if (node.status != ILAW_STICK) continue;
        ASSERT_NEAR(node.r[c], -0.5 * h * tangential * (before[c] + node.state[c]), 1e-13);
      }
      if (node.status == ILAW_SLIP) {
        ASSERT_NEAR(along, strain * mu * node.r[0], 1e-13 * strain);
        ASSERT_GE(h * tangential * strain, shear * (1.0 - 1e-12));
      }
      sticking += node.status == ILAW_STICK;
      slipping += node.status == ILAW_SLIP;
    }
    EXPECT_GT(sticking, 500);
    EXPECT_GT(slipping, 500);
  }
}

// The two steps: an impulse is a force times the velocity step, and the indentation moves by it as well, so
// that the work comes back; the position step predicts the gap that closes.
TEST(Penalty, UsesEachStepWhereItBelongs) {
  NodeRun node(
      "penalty",
      with("implicit",
           {{"stiffness", 500.0}, {"damping", 7.0}, {"tangential_stiffness", 90.0}, {"friction", 5.0}}),
      2e-3);
  const double h = 2e-3;
  node.position_dt = 3e-3;
  node.h[0] = 0.5;
  const double damper = 7.0 / (1.0 + 0.5 * h * 7.0 * 0.5);
  for (const double gap : {1.4e-3, 1.6e-3}) {  // closed where g + l v^-/2 <= 0: up to 1.5e-3
    node.state = {0.0, 0.0, 0.0, 0.0};
    node.gap = gap;
    node.v_previous = {-1.0, 0.2, 0.0};
    ASSERT_EQ(node.step({-1.0, 0.3, 0.0}), ILAW_OK);
    if (gap > 1.5e-3) {
      EXPECT_EQ(node.r[0], 0.0);
      continue;
    }
    const double mean = 0.5 * (node.v[0] - 1.0), slip = 0.5 * (node.v[1] + 0.2);
    EXPECT_NEAR(node.r[0], h * (500.0 * 0.5 * (0.0 - h * mean) - damper * mean), 1e-15);
    EXPECT_NEAR(node.state[0], -h * mean, 1e-17);
    EXPECT_NEAR(node.r[1], -h * 90.0 * 0.5 * h * slip, 1e-16);
    EXPECT_NEAR(node.state[1], h * slip, 1e-17);
  }
}

// The explicit form: the configuration and the half step before, not what the step leads to.
TEST(Penalty, ExplicitReadsWhatIsKnownBefore) {
  for (const double exponent : {1.0, 1.5}) {
    NodeRun node("penalty",
                 with("explicit", {{"stiffness", 500.0}, {"damping", 7.0}, {"exponent", exponent}}));
    node.gap = -0.04;
    node.v_previous = {0.2, 0.0, 0.0};
    ASSERT_EQ(node.step({-9.0, 1.0, 0.0}), ILAW_OK);
    EXPECT_NEAR(node.r[0], 1e-3 * (500.0 * std::pow(0.04, exponent) - 7.0 * 0.2), 1e-17);
    EXPECT_EQ(node.status, ILAW_CLOSED);
    node.v_previous = {100.0, 0.0, 0.0};  // the damper would pull
    ASSERT_EQ(node.step({-9.0, 1.0, 0.0}), ILAW_OK);
    EXPECT_EQ(node.r[0], 0.0);
  }
}

// A damper slows down a node that penetrates, not one that comes.
TEST(Penalty, AnExplicitDamperWaitsForTouch) {
  for (const double gap : {0.0, 0.01}) {
    NodeRun node("penalty", with("explicit", {{"stiffness", 2.0}, {"damping", 100.0}}));
    node.gap = gap;
    node.v_previous = {-1.0, 0.0, 0.0};
    ASSERT_EQ(node.step({-1.0, 0.0, 0.0}), ILAW_OK);
    EXPECT_EQ(node.r[0], 0.0) << "gap " << gap;
    EXPECT_EQ(node.status, ILAW_FREE) << "gap " << gap;
  }
}

}  // namespace
}  // namespace ilaw::testing
