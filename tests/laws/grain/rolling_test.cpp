// Grains that spin: rolling and twisting resistance against their closed forms, on Mindlin's spring and
// without.
#include "laws/rolling/ball.hpp"

namespace ilaw::testing {
namespace {

// Three steps that share no factor.
constexpr double steps[] = {2.3e-4, 3.7e-4, 7.3e-4};
constexpr double rho = 0.002, tau = 0.001, modulus = 1e7, shear_modulus = 8e6, pi = 3.14159265358979323846;

Parameters soft(double friction, double rolling, double twisting, double adhesion = 0.0) {
  return {{{"radius", Ball::radius},
           {"modulus", modulus},
           {"adhesion_energy", adhesion},
           {"viscous_time", 5e-3},
           {"friction", friction},
           {"shear_modulus", shear_modulus},
           {"rolling_friction", rolling},
           {"twisting_friction", twisting}},
          {}};
}
Ball at_rest(const Parameters& parameters, double h, double slope = 0.0) {
  Ball ball(parameters, h, slope, "grain");
  ball.run(0.3);
  ball.x = {};
  ball.dissipated = 0.0;
  return ball;
}

// Mindlin's stiffness 8 G a of the ball at rest, with Hertz' circle: M g = (4/3) E a^3/R.
double mindlin_stiffness() {
  return 8.0 * shear_modulus * std::cbrt(0.75 * Ball::mass * Ball::gravity * Ball::radius / modulus);
}

// As rolling: (7/5) v0^2 R/(2 rho g), and h v0/2 less. Mindlin's spring moves it by its own strain, F/k with
// F = (5/7) M g rho/R. The spin stops for good, and the strain is left to swing, at most at (F/k) w/sqrt(1 -
// (h w)^2/4) with w^2 = k/M, the amplitude of central differences.
TEST(RollingGrain, RollsOutOnMindlinsSpring) {
  constexpr double v0 = 1.0, closed = 1.4 * v0 * v0 * Ball::radius / (2.0 * rho * Ball::gravity);
  for (const double h : steps) {
    Ball ball = at_rest(soft(0.5, rho, tau), h);
    ball.v = ball.v + Vector{v0, 0.0, 0.0};
    ball.w = {0.0, v0 / Ball::radius, 0.0};
    const double before = ball.kinetic_energy() + ball.stored_energy();
    ball.run(6.0);
    EXPECT_NEAR(ball.x[0], closed - 0.5 * h * v0, 2e-6) << "h " << h;
    const double k = mindlin_stiffness(), hw = h * std::sqrt(k / Ball::mass),
                 force = Ball::mass * Ball::gravity * rho / (1.4 * Ball::radius);
    EXPECT_LE(length(ball.w), 1e-15);
    EXPECT_LE(length(ball.v), force / std::sqrt(k * Ball::mass) / std::sqrt(1.0 - 0.25 * hw * hw));
    EXPECT_NEAR(ball.dissipated + ball.stored_energy() + ball.kinetic_energy(), before, 1e-6 * before);
  }
}

// Without friction the ball slides on, and its spin about any axis stops by itself: after I w0/(rho N) and I
// w0/(tau N), N = M g. With adhesion the limits are those of N + 2 F_p, F_p = 3/2 pi w R.
TEST(RollingGrain, SpinsDownWithoutFriction) {
  constexpr double w0 = 30.0;
  for (const double adhesion : {0.0, 5.0})
    for (const double h : steps) {
      const double force = Ball::mass * Ball::gravity + 3.0 * pi * adhesion * Ball::radius;
      Ball ball = at_rest(soft(0.0, rho, tau, adhesion), h);
      ball.v = ball.v + Vector{0.5, 0.0, 0.0};
      ball.w = {0.0, w0, w0};
      for (int k = 0; k < std::lround(0.5 / h); ++k) {
        ball.step();
        const double time = (k + 1) * h;
        ASSERT_NEAR(ball.w[1], std::max(0.0, w0 - rho * force * time / Ball::inertia), 1e-6 * w0) << time;
        ASSERT_NEAR(ball.w[2], std::max(0.0, w0 - tau * force * time / Ball::inertia), 1e-6 * w0) << time;
      }
      EXPECT_NEAR(ball.v[0], 0.5, 1e-15);
    }
}

// The top stands on Mindlin's spring as it does without.
TEST(RollingGrain, TopStopsOnMindlinsSpring) {
  constexpr double w0 = 30.0;
  for (const double adhesion : {0.0, 5.0})
    for (const double h : steps) {
      const double force = Ball::mass * Ball::gravity + 3.0 * pi * adhesion * Ball::radius;
      Ball ball = at_rest(soft(0.5, rho, tau, adhesion), h);
      ball.w = {0.0, 0.0, w0};
      const double closed = Ball::inertia * w0 / (tau * force);
      ball.run(0.7 * closed);
      const double time = h * static_cast<double>(std::lround(0.7 * closed / h));
      EXPECT_NEAR(ball.w[2], w0 * (1.0 - time / closed), 1e-6 * w0) << "h " << h;
      ball.run(0.31 * closed);
      EXPECT_EQ(ball.w[2], 0.0);
    }
}

// rho N holds R M g sin; above, 7/5 a = g sin - rho N/(M R), N = M g cos and with adhesion 2 F_p more. The
// ball swings on the spring at first, and may roll by its strain.
TEST(RollingGrain, StaysOnASlopeBelowTheLimit) {
  for (const double adhesion : {0.0, 5.0})
    for (const double h : steps) {
      const double pull = 3.0 * pi * adhesion * Ball::radius / (Ball::mass * Ball::gravity);
      const auto excess = [&](double angle) {
        return std::sin(angle) - rho / Ball::radius * (std::cos(angle) + pull);
      };
      const double limit = std::atan(rho / Ball::radius) * (1.0 + pull);  // nearly
      Ball below = at_rest(soft(0.5, rho, 0.0, adhesion), h, 0.98 * limit);
      below.run(1.0);
      EXPECT_LT(std::abs(below.x[0]), 1e-7) << "h " << h;
      const double angle = 1.05 * limit, expected = Ball::gravity / 1.4 * excess(angle);
      Ball above = at_rest(soft(0.5, rho, 0.0, adhesion), h, angle);
      const double start = above.v[0];
      above.run(1.0);
      const double time = h * static_cast<double>(std::lround(1.0 / h));
      EXPECT_NEAR(above.v[0] - start, expected * time, 0.02 * expected) << "h " << h;
    }
}

}  // namespace
}  // namespace ilaw::testing
