// rolling at nodes with spins: its conditions, against an independent solver, and limits.
#include "laws/rolling/spheres.hpp"

namespace ilaw::testing {
namespace {

constexpr std::size_t node_count = 20000;
constexpr double friction = 0.3, rolling = 0.2, twisting = 0.1;

[[maybe_unused]] const int finds_law_in_c = setenv("ILAW_TEST_PLUGINS", ILAW_LAW_IN_C, 1);

// Signorini, and each resistance opposite to its motion where that does not vanish.
TEST(Rolling, KeepsItsComplementarity) {
  Spheres nodes(resistance(friction, rolling, twisting), node_count);
  nodes.draw(2, 0.999);
  nodes.v_previous = nodes.v_free;
  nodes.spin_previous = nodes.spin_free;
  ASSERT_EQ(nodes.evaluate(), ILAW_OK) << nodes.report.reason;
  for (std::size_t i = 0; i < node_count; ++i) {
    const Vector &n = nodes.normal[i], &r = nodes.r[i], &m = nodes.m[i], &v = nodes.v[i], &w = nodes.w[i];
    const Gain gain = gain_of(nodes.h[i], n, r, m);
    ASSERT_LE(length(v - nodes.v_free[i] - gain.velocity), 1e-14 * (1.0 + length(gain.velocity)));
    ASSERT_LE(length(w - nodes.spin_free[i] - gain.spin), 1e-14 * (1.0 + length(gain.spin)));
    const double r_N = dot(r, n), v_N = dot(v, n);
    ASSERT_GE(r_N, -1e-15);
    ASSERT_GE(v_N, -1e-14);
    ASSERT_LE(std::abs(r_N * v_N), 1e-14);
    const auto opposes = [&](const Vector& force, const Vector& motion, double most) {
      ASSERT_LE(length(force), most + 1e-14) << "node " << i;
      ASSERT_NEAR(dot(force, motion), -most * length(motion), 1e-12) << "node " << i;
    };
    opposes(tangential(r, n), tangential(v, n), friction * r_N);
    opposes(tangential(m, n), tangential(w, n), rolling * r_N);
    opposes(dot(m, n) * n, dot(w, n) * n, twisting * r_N);
  }
}

// Obstacle and body in each other's place: n, relative motion and k change their sign, and so do r and m.
TEST(Rolling, IsTheSameWithRolesSwapped) {
  const Parameters parameters = resistance(friction, rolling, twisting, 0.5);
  Spheres nodes(parameters, node_count), swapped(parameters, node_count);
  for (Spheres* one : {&nodes, &swapped}) one->draw(6);
  for (const auto of : VectorsOfSpheres{&Spheres::v_free, &Spheres::v_previous, &Spheres::spin_free,
                                        &Spheres::spin_previous, &Spheres::normal})
    for (Vector& a : swapped.*of) a = -1.0 * a;
  for (SpinInertia& h : swapped.h) h[2] = -h[2];
  for (Spheres* one : {&nodes, &swapped}) ASSERT_EQ(one->evaluate(), ILAW_OK) << one->report.reason;
  for (const auto of : VectorsOfSpheres{&Spheres::r, &Spheres::v, &Spheres::m, &Spheres::w})
    for (std::size_t i = 0; i < node_count; ++i)
      ASSERT_LE(length((nodes.*of)[i] + (swapped.*of)[i]), 1e-13) << "node " << i;
}

TEST(Rolling, HoldsWhereResistancesAreInfinite) {
  constexpr std::size_t count = 1000;
  constexpr double inf = std::numeric_limits<double>::infinity();
  Spheres nodes(resistance(inf, inf, inf), count);
  nodes.draw(9);
  nodes.v_previous = nodes.v_free;
  nodes.spin_previous = nodes.spin_free;
  ASSERT_EQ(nodes.evaluate(), ILAW_OK);
  for (std::size_t i = 0; i < count; ++i)
    if (nodes.status[i] != ILAW_FREE) {
      ASSERT_LE(length(nodes.v[i]), 1e-13) << "node " << i;
      ASSERT_LE(length(nodes.w[i]), 1e-13) << "node " << i;
    }
}

// The law in C of this folder finds its root by bisection, and its arrays are those of plain_c.h.
TEST(Rolling, AgreesWithALawInC) {
  int slips = 0, rolls = 0, both = 0, none = 0;
  for (const std::uint32_t frame : {ILAW_FRAME_LOCAL, ILAW_FRAME_GLOBAL}) {
    Spheres nodes(resistance(friction, rolling, twisting), node_count, frame),
        in_c({{{"friction", friction}, {"rolling", rolling}, {"twisting", twisting}}, {}}, node_count, frame,
             "rolling_in_c");
    for (Spheres* one : {&nodes, &in_c}) {
      one->draw(10);
      one->v_previous = one->v_free;
      one->spin_previous = one->spin_free;
      ASSERT_EQ(one->evaluate(), ILAW_OK) << one->report.reason;
    }
    for (const auto of : VectorsOfSpheres{&Spheres::r, &Spheres::m, &Spheres::v, &Spheres::w})
      for (std::size_t i = 0; i < node_count; ++i)
        ASSERT_LE(length((nodes.*of)[i] - (in_c.*of)[i]), 1e-13) << "node " << i;
    for (std::size_t i = 0; i < node_count; ++i) {
      const Vector n = frame == ILAW_FRAME_LOCAL ? Vector{1.0, 0.0, 0.0} : nodes.normal[i];
      const double r_N = dot(nodes.r[i], n);
      if (r_N == 0.0) continue;
      const bool at_r = length(tangential(nodes.r[i], n)) > (1.0 - 1e-9) * friction * r_N,
                 at_q = length(tangential(nodes.m[i], n)) > (1.0 - 1e-9) * rolling * r_N;
      ++(at_r && at_q ? both : at_r ? slips : at_q ? rolls : none);
      ASSERT_EQ(nodes.status[i], at_r ? ILAW_SLIP : ILAW_STICK) << "node " << i;
    }
  }
  EXPECT_GT(std::min({slips, rolls, both, none}), 50);
}

TEST(Rolling, LawInCNeedsSpins) {
  EXPECT_THAT(refusal_of("rolling_in_c", {{{"rolling", 0.1}}, {}}), HasSubstr("'rolling' needs spins"));
}

}  // namespace
}  // namespace ilaw::testing
