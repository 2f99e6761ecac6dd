// The host in C that hands spins to a law, against closed forms.
// SPDX-License-Identifier: BSD-3-Clause
#include "support/program.hpp"

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <sstream>
#include <string>

namespace {

using namespace ilaw::testing::programs;

struct end {
  double x = NAN, v = NAN, rolling_speed = NAN, spin = NAN, balance = NAN;
};

end run(double slope, double speed, double spin, double seconds) {
  setenv("ILAW_PATH", ILAW_PLUGIN_FOLDER, 1);
  char arguments[160];
  std::snprintf(arguments, sizeof arguments, " rolling %.17g %g %g %g", slope, speed, spin, seconds);
  const Outcome outcome = run_command(ILAW_ball_c + std::string(arguments));
  EXPECT_EQ(outcome.code, 0) << outcome.output;
  end found;
  std::istringstream(outcome.output) >> found.x >> found.v >> found.rolling_speed >> found.spin >>
      found.balance;
  return found;
}

constexpr double radius = 0.05, gravity = 9.81, rho = 2e-3, tau = 1e-3, h = 1e-4;

TEST(BallHost, RollsOut) {
  const end found = run(0.0, 1.0, 0.0, 6.0);
  EXPECT_NEAR(found.x, 1.4 * radius / (2.0 * rho * gravity) - 0.5 * h, 1e-8);
  EXPECT_NEAR(found.v, 0.0, 1e-14);
  EXPECT_NEAR(found.balance, 1.0, 1e-12);
}

TEST(BallHost, SpinsDown) {
  const double stops = 0.4 * radius * radius * 30.0 / (tau * gravity);
  EXPECT_NEAR(run(0.0, 0.0, 30.0, 0.5 * stops).spin, 15.0, 30.0 * h / stops);
  EXPECT_NEAR(run(0.0, 0.0, 30.0, 1.01 * stops).spin, 0.0, 1e-12);
}

TEST(BallHost, StaysOnASlopeAndRollsDownASteeperOne) {
  const double limit = std::atan(rho / radius), steep = 3.0 * limit;
  EXPECT_NEAR(run(0.98 * limit, 0.0, 0.0, 1.0).x, 0.0, 1e-15);
  const end found = run(steep, 0.0, 0.0, 1.0);
  EXPECT_NEAR(found.v, gravity / 1.4 * (std::sin(steep) - std::cos(steep) * rho / radius), 1e-11);
  EXPECT_NEAR(found.rolling_speed, found.v, 1e-12);
}

}  // namespace
