// Spins and moments of coupled contacts (ilaw/coupled.h) where they have closed forms: a ball on a plane,
// walls that spin, two balls.
// SPDX-License-Identifier: BSD-3-Clause
#include "coupled_grains.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace {

using namespace coupled_grains;

constexpr double mass = 0.3, radius = 0.05, gravity = 9.81, inertia = 0.4 * mass * radius * radius;

// A ball on a floor, with gravity along a slope of this angle, downwards along x.
Grains ball(const Parameters& parameters, double h, double slope = 0.0) {
  Grains made(parameters, h);
  made.grains.push_back({mass, radius, {0.0, 0.0, radius}});
  made.walls.push_back({});
  made.pull = {gravity * std::sin(slope), 0.0, -gravity * std::cos(slope)};
  return made;
}

// Any motion of a ball over a wall and of two balls of different size: the impulse and moment that the law
// gives for v, w and H of the contact, which here come from their definition. Forces and torques change the
// motion within the step: some spins turn round, where the law depends on the spin before.
TEST(CoupledRolling, OneContactIsOneNodeOfTheLaw) {
  Random within(5);
  const auto any = [&] { return within.vector(); };
  const Parameters parameters = resistance(0.8, 0.1, 0.05);
  int pressed = 0, turned = 0;
  for (int k = 0; k < 300; ++k) {
    Grains all(parameters, steps[k / 3 % 3]);
    all.pull = {};
    Vector n = any();
    n = (1.0 / length(n)) * n;
    const Grain a{within(0.5, 2.0), within(0.5, 2.0), {}, any(), any()};
    Grain b{within(0.5, 2.0), within(0.5, 2.0), {}, any(), any()};
    b.x = -(a.radius + b.radius) * n;
    if (k % 3 > 0) {
      all.pull = -within(2.0, 3.0) / all.h * a.v;
      all.torque = -within(1.0, 3.0) * a.inertia() / all.h * a.w;
    }
    const bool at_wall = k % 2 == 0;
    all.grains = at_wall ? std::vector{a} : std::vector{b, a};
    if (at_wall) all.walls.push_back({n, -a.radius, {}, {}});
    all.reach = 1e-9;
    const ilaw_coupled_report report = all.step();
    ASSERT_EQ(all.body.size(), 1U);

    Spheres node(parameters, 1);
    node.velocity_step = node.position_step = all.h;
    const double by_b = at_wall ? 0.0 : 1.0, m = 1.0 / a.mass + by_b / b.mass;
    const double j_a = 1.0 / a.inertia(), j_b = by_b / b.inertia();
    node.h[0] = {m, m + a.radius * a.radius * j_a + b.radius * b.radius * j_b,
                 a.radius * j_a - b.radius * j_b, j_a + j_b, j_a + j_b};
    node.normal[0] = n;
    const auto slip = [&](const Vector& v_a, const Vector& w_a, const Vector& v_b, const Vector& w_b) {
      return v_a + cross(w_a, -a.radius * n) - by_b * (v_b + cross(w_b, b.radius * n));
    };
    const Vector kick = all.h * all.pull, w_a = a.w + (all.h / a.inertia()) * all.torque,
                 w_b = b.w + (all.h / b.inertia()) * all.torque;
    node.v_previous[0] = slip(a.v, a.w, b.v, b.w);
    node.v_free[0] = slip(a.v + kick, w_a, b.v + kick, w_b);
    node.spin_previous[0] = a.w - by_b * b.w;
    node.spin_free[0] = w_a - by_b * w_b;
    node.gap[0] = all.gap[0];
    ASSERT_EQ(node.evaluate(), ILAW_OK);
    ASSERT_LE(length(all.impulse[0] - node.r[0]), 1e-14 * (1.0 + length(node.r[0]))) << k;
    ASSERT_LE(length(all.moment[0] - node.m[0]), 1e-14 * (1.0 + length(node.m[0]))) << k;
    ASSERT_LE(report.residual, 1e-14);
    pressed += node.r[0] != Vector{};
    const Vector moment = node.m[0];
    node.spin_previous = node.spin_free;
    ASSERT_EQ(node.evaluate(), ILAW_OK);
    turned += node.m[0] != moment;
  }
  EXPECT_GT(pressed, 100);
  EXPECT_GT(turned, 20) << "moments that depend on the spin before";
}

// The first iteration evaluates the law at the velocities without contact: the same bits.
TEST(CoupledRolling, FirstIterationHasTheBitsOfEvaluate) {
  for (const double h : steps) {
    const Parameters parameters = resistance(0.3, 0.002, 0.001);
    Grains one = ball(parameters, h);
    one.grains[0].v = {1.0, -0.3, 0.0}, one.grains[0].w = {3.0, 5.0, -2.0};
    one.options.most_sweeps = 1;
    Spheres node(parameters, 1);
    const Vector arm{0.0, 0.0, -radius};
    node.velocity_step = node.position_step = h;
    node.h[0] = {1.0 / mass, 1.0 / mass + (1.0 / inertia) * radius * radius, radius * (1.0 / inertia),
                 1.0 / inertia, 1.0 / inertia};
    node.v_previous[0] = one.grains[0].v + cross(one.grains[0].w, arm);
    node.v_free[0] = one.grains[0].v + h * one.pull + cross(one.grains[0].w, arm);
    node.spin_free[0] = node.spin_previous[0] = one.grains[0].w;
    one.step();
    ASSERT_EQ(node.evaluate(), ILAW_OK);
    EXPECT_EQ(one.impulse[0], node.r[0]) << h;
    EXPECT_EQ(one.moment[0], node.m[0]) << h;
  }
}

// A roller below the ball that spins ever faster, by alpha t about y: the rolling moment rho M g drives the
// ball with 7/5 a = rho g/R. The roller gives rho M g times its angle, of which the ball keeps its kinetic
// energy.
TEST(CoupledRolling, RollerDrivesTheBall) {
  constexpr double rho = 0.002, alpha = 40.0, a = rho * gravity / (1.4 * radius);
  static_assert(alpha > 2.0 * a / radius);
  for (const double h : steps) {
    Grains one = ball(resistance(0.5, rho, 0.0), h);
    one.walls_spin = true;
    const auto count = std::lround(0.5 / h);
    for (long k = 1; k <= count; ++k) {
      one.walls[0].spin_previous = one.walls[0].spin;
      one.walls[0].spin = {0.0, alpha * static_cast<double>(k) * h, 0.0};
      one.step();
    }
    const double time = h * static_cast<double>(count),
                 given = rho * mass * gravity * 0.5 * alpha * time * time;
    EXPECT_NEAR(one.grains[0].v[0], a * time, 1e-11) << "h " << h;
    EXPECT_NEAR(one.grains[0].w[1], a * time / radius, 1e-10) << "h " << h;
    EXPECT_NEAR(one.dissipated, given - one.kinetic(), 1e-12 * given) << "h " << h;
    EXPECT_NEAR(one.work, one.kinetic() - given, 1e-12 * given) << "h " << h;
  }
}

TEST(CoupledRolling, TwoBallsKeepTheirMomenta) {
  for (const double h : steps) {
    Grains two(resistance(0.3, 0.02, 0.01), h);
    two.pull = {};
    two.reach = 1e-9;
    const Vector n{0.6, 0.0, 0.8};
    two.grains = {{0.7, 0.2, {}, {0.3, -0.2, 0.9}, {3.0, -1.0, 2.0}},
                  {0.4, 0.5, 0.7 * n, {-0.5, 0.4, -0.6}, {-2.0, 5.0, 4.0}}};
    const auto momentum = [&] {
      return two.grains[0].mass * two.grains[0].v + two.grains[1].mass * two.grains[1].v;
    };
    const auto angular = [&](const Vector& x_0, const Vector& x_1) {
      const Grain &a = two.grains[0], &b = two.grains[1];
      return cross(x_0, a.mass * a.v) + cross(x_1, b.mass * b.v) + a.inertia() * a.w + b.inertia() * b.w;
    };
    const Vector x_0 = two.grains[0].x, x_1 = two.grains[1].x, p = momentum(), l = angular(x_0, x_1);
    const double before = two.kinetic();
    two.step();
    ASSERT_GT(length(two.moment[0]), 1e-3);
    EXPECT_LE(length(momentum() - p), 1e-15);
    EXPECT_LE(length(angular(x_0, x_1) - l), 1e-15);
    EXPECT_NEAR(two.kinetic() - before, two.work, 1e-15);
    EXPECT_NEAR(two.work, -two.dissipated, 1e-15);
    EXPECT_LT(two.work, 0.0);
  }
}

}  // namespace
