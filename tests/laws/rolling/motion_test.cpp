// A ball on a plane under gravity, in central differences. That it rolls out, spins down and stays on a slope
// is tested in hosts: tests/hosts/programs_test.py.
#include "laws/rolling/ball.hpp"

namespace ilaw::testing {
namespace {

// Three steps that share no factor.
constexpr double steps[] = {1e-4, 3.7e-4, 7.3e-4};

// Friction turns 2/7 of the momentum into spin, whatever its coefficient (Euler 1758).
TEST(Ball, SlidesIntoRolling) {
  for (const double h : steps) {
    Ball ball(resistance(0.3, 0.0, 0.0), h);
    ball.v = {1.0, 0.0, 0.0};
    ball.step();
    EXPECT_EQ(ball.status(), ILAW_SLIP);
    ball.run(1.0);
    EXPECT_NEAR(ball.v[0], 5.0 / 7.0, 1e-12) << "h " << h;
    EXPECT_NEAR(Ball::radius * ball.w[1], 5.0 / 7.0, 1e-12) << "h " << h;
    EXPECT_EQ(ball.status(), ILAW_STICK);
  }
}

// Sliding, rolling and twisting at once: what the energy loses is what the law says it dissipated.
TEST(Ball, LosesTheEnergyThatIsDissipated) {
  for (const double h : steps) {
    Ball ball(resistance(0.2, 0.004, 0.003), h);
    ball.v = {1.0, -2.0, 0.0};
    ball.w = {30.0, -20.0, 60.0};
    double before = ball.kinetic_energy();
    const double at_start = before;
    for (int k = 0; k < std::lround(1.0 / h); ++k) {
      ball.step();
      const double now = ball.kinetic_energy();
      ASSERT_LE(now, before * (1.0 + 1e-14)) << "step " << k;
      before = now;
    }
    EXPECT_LT(before, 0.5 * at_start);
    EXPECT_NEAR(ball.dissipated, at_start - before, 1e-11 * at_start) << "h " << h;
  }
}

}  // namespace
}  // namespace ilaw::testing
