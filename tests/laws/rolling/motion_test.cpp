// A ball on a plane under gravity, in central differences: closed forms of rolling and twisting resistance.
#include "laws/rolling/spheres.hpp"

namespace ilaw::testing {
namespace {

// Three steps that share no factor.
constexpr double steps[] = {1e-4, 3.7e-4, 7.3e-4};

// A solid ball, I = 2/5 M R^2. Its contact point has the velocity v + w x (-R n).
class Ball {
 public:
  static constexpr double mass = 0.3, radius = 0.05, gravity = 9.81, inertia = 0.4 * mass * radius * radius;

  // slope: angle of the plane, downwards along x.
  Ball(const Parameters& parameters, double h, double slope = 0.0)
      : contact_(parameters, 1), pull_{gravity * std::sin(slope), 0.0, -gravity * std::cos(slope)} {
    contact_.velocity_step = contact_.position_step = h;
    contact_.h[0] = {1.0 / mass, 1.0 / mass + radius * radius / inertia, radius / inertia, 1.0 / inertia,
                     1.0 / inertia};
  }

  void step() {
    const Vector n = contact_.normal[0], arm = -radius * n;
    contact_.v_previous[0] = v + cross(w, arm);
    contact_.spin_previous[0] = w;
    v = v + contact_.velocity_step * pull_;
    contact_.v_free[0] = v + cross(w, arm);
    contact_.spin_free[0] = w;
    ASSERT_EQ(contact_.evaluate(), ILAW_OK) << contact_.report.reason;
    v = v + (1.0 / mass) * contact_.r[0];
    w = w + (1.0 / inertia) * (cross(arm, contact_.r[0]) + contact_.m[0]);
    // Masses and arms say what the five numbers of H say.
    ASSERT_LE(length(v + cross(w, arm) - contact_.v[0]), 1e-12);
    ASSERT_LE(length(w - contact_.w[0]), 1e-10);
    x = x + contact_.velocity_step * v;
    dissipated += contact_.energy[0][ILAW_ENERGY_FRICTION] + contact_.energy[0][ILAW_ENERGY_IMPACT];
  }
  void run(double time) {
    for (int k = 0; k < std::lround(time / contact_.velocity_step); ++k) step();
  }
  double kinetic_energy() const { return 0.5 * (mass * dot(v, v) + inertia * dot(w, w)); }
  std::uint8_t status() const { return contact_.status[0]; }

  Vector x{}, v{}, w{};
  double dissipated = 0.0;

 private:
  Spheres contact_;
  Vector pull_;
};

// While it rolls, M a = -F, (2/5) M R a = F R - rho M g: 7/5 a = -rho g/R, and the ball stops after
// (7/5) v0^2 R/(2 rho g). In steps the position is a sum of the velocities after them: h v0/2 less.
TEST(Ball, RollsOut) {
  constexpr double rho = 0.002, v0 = 1.0;
  constexpr double closed = 1.4 * v0 * v0 * Ball::radius / (2.0 * rho * Ball::gravity);
  static_assert(closed > 1.7838939 && closed < 1.7838941);
  for (const double h : steps) {
    Ball ball(resistance(0.5, rho, 0.001), h);
    ball.v = {v0, 0.0, 0.0};
    ball.w = {0.0, v0 / Ball::radius, 0.0};
    const double at_start = ball.kinetic_energy();
    ball.run(6.0);
    EXPECT_NEAR(ball.x[0], closed - 0.5 * h * v0, 0.2 * h * h) << "h " << h;
    EXPECT_LE(length(ball.v) + Ball::radius * length(ball.w), 1e-14);
    EXPECT_NEAR(ball.dissipated, at_start, 1e-12 * at_start);
    EXPECT_EQ(ball.status(), ILAW_STICK);
  }
}

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

// I dw/dt = -tau M g: with tau = mu_t R it stops after (2/5) R^2 w0/(tau g) = 2 R w0/(5 mu_t g).
TEST(Ball, SpinsDown) {
  constexpr double twist = 0.02, w0 = 30.0;  // mu_t
  constexpr double closed = 2.0 * Ball::radius * w0 / (5.0 * Ball::gravity * twist);
  for (const double h : steps) {
    Ball ball(resistance(0.5, 0.002, twist * Ball::radius), h);
    ball.w = {0.0, 0.0, w0};
    int count = 0;
    for (; ball.w[2] > 1e-12 && count < 100000; ++count) {
      ball.step();
      const double expected = std::max(0.0, w0 * (1.0 - (count + 1) * h / closed));
      ASSERT_NEAR(ball.w[2], expected, 1e-10) << "h " << h;
    }
    EXPECT_NEAR(count * h, closed, h);
    EXPECT_LE(length(ball.v), 1e-15);
  }
}

// rho M g cos holds R M g sin; above, 7/5 a = g (sin - rho/R cos).
TEST(Ball, StaysOnASlopeBelowTheLimit) {
  constexpr double rho = 0.002;
  const double limit = std::atan(rho / Ball::radius);
  for (const double h : steps) {
    Ball below(resistance(0.5, rho, 0.0), h, 0.98 * limit), above(resistance(0.5, rho, 0.0), h, 1.02 * limit);
    below.run(1.0);
    EXPECT_NEAR(below.x[0], 0.0, 1e-16) << "h " << h;
    const double a = 1.02 * limit;
    const double expected = (Ball::gravity / 1.4) * (std::sin(a) - std::cos(a) * rho / Ball::radius);
    above.run(1.0);
    const double time = h * static_cast<double>(std::lround(1.0 / h));
    EXPECT_NEAR(above.v[0], expected * time, 1e-11) << "h " << h;
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
