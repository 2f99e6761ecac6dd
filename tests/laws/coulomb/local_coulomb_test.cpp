// The law for diagonal and full H, elliptical cones and kinetic friction, through the ABI.
#include "kit/local_coulomb/draw.hpp"
#include "support/law_batch.hpp"

namespace ilaw::testing {
namespace {

// Many closed contacts at once, each with its own full H.
LawBatch contacts_of(const Parameters& parameters, std::size_t count) {
  return LawBatch(make_law("coulomb", SetupBuilder(parameters, 3, ILAW_DELASSUS_FULL)), count);
}

void fill(LawBatch& contacts, Draw& draw) {
  for (std::size_t i = 0; i < contacts.v_free.size(); ++i) {
    kit::local_coulomb p{};
    draw.fill_coupled(p, 0.05);
    draw.fill_pressed_velocity(p, 1.0);
    std::copy(p.h, p.h + 6, contacts.h[i].begin());
    std::copy(p.q, p.q + 3, contacts.v_free[i].begin());
    if (i % 4 == 0) contacts.v_free[i][0] *= -1.0;
  }
}

// The plugin is compiled for other processors and with other flags than this test: the same bits all the
// same.
TEST(CoulombDelassus, GivesTheBitsOfTheLocalSolver) {
  for (const double friction_2 : {0.4, 0.1}) {
    LawBatch contacts = contacts_of({{{"friction", 0.4}, {"friction_2", friction_2}}, {}}, 100000);
    Draw draw(41);
    fill(contacts, draw);
    ASSERT_EQ(contacts.evaluate(), ILAW_OK) << "friction_2 " << friction_2;
    for (std::size_t i = 0; i < contacts.v_free.size(); ++i) {
      kit::local_coulomb p{{}, {}, {0.4, friction_2}};
      std::copy(contacts.h[i].begin(), contacts.h[i].end(), p.h);
      std::copy(contacts.v_free[i].begin(), contacts.v_free[i].end(), p.q);
      double r[3];
      const kit::contact_mode mode = kit::solve(p, r);
      ASSERT_EQ(contacts.r[i], (Vector{r[0], r[1], r[2]})) << "contact " << i;
      ASSERT_EQ(contacts.status[i], mode == kit::contact_mode::slip    ? ILAW_SLIP
                                    : mode == kit::contact_mode::stick ? ILAW_STICK
                                                                       : ILAW_FREE)
          << "friction_2 " << friction_2 << ", i " << i;
    }
  }
}

// A second coefficient below 2^-400 of the first acts as zero, and stays off the cone's equations.
TEST(CoulombDelassus, TakesANegligibleCoefficientForZero) {
  Draw draw(45);
  for (int k = 0; k < 1000; ++k) {
    kit::local_coulomb p{};
    draw.fill_coupled(p, 0.05);
    draw.fill_pressed_velocity(p, 1.0);
    double r[3], expected[3];
    p.mu[0] = 0.4;
    p.mu[1] = 0.0;
    const kit::contact_mode mode = kit::solve_pressed(p, expected);
    p.mu[1] = 1e-130;
    ASSERT_EQ(kit::solve_pressed(p, r), mode) << k;
    for (int c = 0; c < 3; ++c) ASSERT_EQ(r[c], expected[c]) << "problem " << k;
    ASSERT_EQ(r[2], 0.0) << k;
  }
}

// Newton's coefficient where H couples (Kane 1984): sticking, r = -H^-1 q with q = v^- + (e v_N^-, 0), the
// work is -q.H^-1 q/2 + e r_N, for v^- = (-1, -w) a gain of (e^2 + w^2 - 1)/(2 (1 - w^2)), which the law
// takes off. Equal coefficients lose 1 - e^2.
TEST(CoulombDelassus, RestitutionCreatesNoEnergyWhereHCouples) {
  constexpr double w = 0.8;
  for (const double e : {0.4, 0.8})
    for (const bool moreau : {false, true}) {
      NodeRun node(
          "coulomb",
          {{{"friction", 10.0}, {"restitution", e}, {"tangential_restitution", moreau ? e : 0.0}}, {}}, 1e-3,
          ILAW_DELASSUS_FULL);
      node.h = {1.0, 1.0, 1.0, w, 0.0, 0.0};
      const Vector v{-1.0, -w, 0.0};
      node.v_previous = v;
      ASSERT_EQ(node.step(v), ILAW_OK) << "moreau " << moreau;
      const double work = 0.5 * (dot(node.r, v) + dot(node.r, node.v));
      const double newton = (e * e + w * w - 1.0) / (2.0 * (1.0 - w * w));
      EXPECT_NEAR(work, moreau ? -0.5 * (1.0 - e * e) : std::min(newton, 0.0), 1e-14) << "moreau " << moreau;
    }
}

// H = diag(h_N, h_1, h_2): r_N = -q_N/h_N stands alone, and sliding is r_i = -q_i/(h_i + a) with a > 0 the
// root of |r_T| = mu r_N, which decreases in a. local_coulomb.hpp gives r_N as |r_T|/mu after Newton steps
// on 1/|r_T| = 1/(mu r_N): eight roundings of 2^-53 lie between |r_T| and q_N/h_N, 4 ulp. A step from the
// relative error 2^-13 leaves 3/2 k 2^-26, with k the variance of 1/(h_i + a), weighted by r_i^2, over its
// mean squared, and the last one, on |r_T|, (1 + 3/2 k) times the square of that.
TEST(CoulombDelassus, SlidesOnADiagonalHAtTheRootOfItsOneEquation) {
  NodeRun node("coulomb", {{{"friction", 0.5}}, {}}, 1e-3, ILAW_DELASSUS_DIAGONAL);
  Draw draw(44);
  for (int k = 0; k < 5000; ++k) {
    node.h = {draw.decades(-1, 1), draw.decades(-2, 2), draw.decades(-2, 2)};
    const Vector q{-draw(0.1, 1.0), draw.normal(), draw.normal()};
    node.v_previous = {};
    ASSERT_EQ(node.step(q), ILAW_OK) << "k " << k;
    const double limit = -0.5 * q[0] / node.h[0];
    const auto length = [&](double a) { return std::hypot(q[1] / (node.h[1] + a), q[2] / (node.h[2] + a)); };
    double low = 0.0, high = std::hypot(q[1], q[2]) / limit;
    for (int step = 0; step < 200; ++step) {
      const double a = 0.5 * (low + high);
      (length(a) > limit ? low : high) = a;
    }
    const double b_1 = 1.0 / (node.h[1] + low), b_2 = 1.0 / (node.h[2] + low),
                 part = node.r[1] * node.r[1] / (node.r[1] * node.r[1] + node.r[2] * node.r[2]),
                 mean = part * b_1 + (1.0 - part) * b_2,
                 variation = part * (1.0 - part) * (b_1 - b_2) * (b_1 - b_2) / (mean * mean),
                 left = 1.5 * variation;
    ASSERT_NEAR(node.r[0], -q[0] / node.h[0], (4.0 + (1.0 + left) * left * left) * ulp * node.r[0])
        << "k " << k;
    ASSERT_NEAR(node.r[1], -q[1] / (node.h[1] + low), 1e-13 * limit + 1e-15) << "k " << k;
    ASSERT_NEAR(node.r[2], -q[2] / (node.h[2] + low), 1e-13 * limit + 1e-15) << "k " << k;
  }
}

TEST(CoulombEllipse, HasItsOwnCoefficientAlongEachAxis) {
  NodeRun node("coulomb", {{{"friction", 0.5}, {"friction_2", 0.2}}, {}});
  ASSERT_EQ(node.step({-1.0, 9.0, 0.0}), ILAW_OK);
  EXPECT_EQ(node.status, ILAW_SLIP);
  EXPECT_NEAR(node.r[1], -0.5, 2 * ulp);
  EXPECT_EQ(node.r[2], 0.0);
  ASSERT_EQ(node.step({-1.0, 0.0, 9.0}), ILAW_OK);
  EXPECT_NEAR(node.r[2], -0.2, 2 * ulp);
  EXPECT_EQ(node.r[1], 0.0);
  // In between, the ellipse's normal is opposite to the slip: v_i proportional to r_i/mu_i^2.
  ASSERT_EQ(node.step({-1.0, 3.0, 4.0}), ILAW_OK);
  EXPECT_NEAR(std::hypot(node.r[1] / 0.5, node.r[2] / 0.2), 1.0, 4 * ulp);
  EXPECT_NEAR(node.v[1] * node.r[2] / 0.04, node.v[2] * node.r[1] / 0.25, 1e-14);
}

// mu(v) = mu_k + (mu - mu_k) exp(-decay |v_T|), at the velocity before the step.
TEST(KineticFriction, FallsFromTheStaticOneWithTheSlipSpeed) {
  for (const double decay : {0.0, 0.7, inf_value}) {
    NodeRun node("coulomb", {{{"friction", 0.5}, {"kinetic_friction", 0.2}, {"decay", decay}}, {}});
    for (const double speed : {0.0, 0.3, 2.0, 500.0}) {
      node.v_previous = {0.0, 0.6 * speed, -0.8 * speed};
      ASSERT_EQ(node.step({-1.0, 6.0, -8.0}), ILAW_OK) << "decay " << decay << ", speed " << speed;
      const double left = speed == 0.0 ? 1.0 : std::exp(-decay * speed);
      const double expected = 0.2 + 0.3 * left;
      ASSERT_NEAR(node.r[1], -0.6 * expected, 4 * ulp) << "decay " << decay << ", speed " << speed;
      ASSERT_NEAR(node.r[2], 0.8 * expected, 4 * ulp) << "decay " << decay << ", speed " << speed;
    }
  }
}

// A kinetic coefficient between the two static ones leaves the smaller as it is, at rest and at any speed.
TEST(KineticFriction, LeavesTheSmallerOfTwoCoefficientsAsItIs) {
  for (const double decay : {0.7, inf_value}) {
    NodeRun node("coulomb",
                 {{{"friction", 0.5}, {"friction_2", 0.1}, {"kinetic_friction", 0.2}, {"decay", decay}}, {}});
    for (const double speed : {0.0, 2.0, 5000.0}) {
      node.v_previous = {0.0, 0.0, -speed};
      ASSERT_EQ(node.step({-1.0, 0.0, -8.0}), ILAW_OK) << "decay " << decay << ", speed " << speed;
      EXPECT_NEAR(node.r[2], 0.1, 4 * ulp) << "decay " << decay << ", speed " << speed;
    }
  }
}

// Infinite friction that would have to pull: refused, with the reason.
TEST(CoulombDelassus, SaysWhereThereIsNoSolution) {
  NodeRun node("coulomb", {{{"friction", inf_value}}, {}}, 1e-3, ILAW_DELASSUS_FULL);
  node.h = {1.0, 1.0, 1.0, 0.9, 0.0, 0.0};
  EXPECT_EQ(node.step({-0.1, -1.0, 0.0}), ILAW_BAD_NODES);
  EXPECT_STREQ(node.report.reason, "the law's equations have no solution for this H");
  EXPECT_EQ(node.r, (Vector{}));
  node.v_previous = {};
  EXPECT_EQ(node.step({-0.1, 0.01, 0.0}), ILAW_OK);
  EXPECT_EQ(node.status, ILAW_STICK);
}

}  // namespace
}  // namespace ilaw::testing
