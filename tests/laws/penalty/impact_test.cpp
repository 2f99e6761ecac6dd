// A mass against a penalised obstacle, step by step, against the closed forms of continuous time.
#include "support/law_runner.hpp"

#include <limits>

namespace ilaw::testing {
namespace {

constexpr double pi = 3.14159265358979323846;

// What an impact of a free mass at speed 1 did, from its first closed step to its last.
struct Impact {
  double duration = 0.0, rebound = 0.0, deepest = 0.0;
};

// The mass starts `phase` of a step above the obstacle and moves freely but for the law.
Impact collide(const Parameters& parameters, double mass, double step, double phase) {
  NodeRun node("penalty", parameters, step);
  node.h[0] = 1.0 / mass;
  node.v = node.v_previous = {-1.0, 0, 0};
  double position = phase * step;
  Impact impact;
  for (int k = 0; k < 100000000; ++k) {
    node.gap = position;
    EXPECT_EQ(node.step(node.v), ILAW_OK);
    position += step * node.v[0];
    impact.deepest = std::max(impact.deepest, -position);
    if (node.r[0] > 0.0) impact.duration += step;
    if (node.r[0] == 0.0 && node.v[0] > 0.0) break;
  }
  impact.rebound = node.v[0];
  return impact;
}

Parameters with(const std::string& integration, std::map<std::string, double> numbers) {
  return {std::move(numbers), {{"integration", integration}}};
}

// A mass on a spring for half a period: contact lasts pi sqrt(m/k), reaches V sqrt(m/k), and ends with the
// speed it began with. Explicit: the energy is exact within contact, and off by at most k |g_before
// g_after|/2 where the kink is crossed, twice, so that with |g_before| + |g_after| = V h the speed is off by
// at most (omega h)^2/8; the duration by the two cut steps. Implicit: backward Euler damps with exp(-omega^2
// h t/2) to first order.
TEST(Impact, LinearSpringReturnsTheMass) {
  constexpr double mass = 2.0, stiffness = 5000.0;  // omega = 50
  for (const double h : {1e-3, 1e-4, 1e-5})
    for (const double phase : {0.0, 0.3, 0.77}) {
      const double omega_h = 50.0 * h;
      const Impact free = collide(with("explicit", {{"stiffness", stiffness}}), mass, h, phase);
      EXPECT_NEAR(free.duration, pi / 50.0, 2.0 * h);
      EXPECT_NEAR(free.rebound, 1.0, omega_h * omega_h / 8.0 + 1e-12);
      EXPECT_NEAR(free.deepest, 0.02, 0.02 * omega_h * omega_h);
      const Impact damped = collide(with("implicit", {{"stiffness", stiffness}}), mass, h, phase);
      EXPECT_NEAR(damped.duration, pi / 50.0, 2.0 * h);
      EXPECT_NEAR(damped.rebound, std::exp(-0.5 * omega_h * pi), 0.5 * omega_h);
      EXPECT_LE(damped.rebound, 1.0);
    }
}

// Hertz: the energy m V^2/2 is K alpha^(5/2) 2/5 at the deepest point, so alpha_max = (5 m V^2/(4 K))^(2/5),
// and contact lasts 2.94327 alpha_max/V: the integral of 2 dx/sqrt(1 - x^(5/2)) from 0 to 1.
TEST(Impact, HertzReachesItsIndentation) {
  constexpr double mass = 0.5, stiffness = 2e6;
  const double deepest = std::pow(5.0 * mass / (4.0 * stiffness), 0.4);
  for (const char* integration : {"explicit", "implicit"})
    for (const double phase : {0.1, 0.6}) {
      const double h = 1e-3 * deepest;
      const Impact impact =
          collide(with(integration, {{"stiffness", stiffness}, {"exponent", 1.5}}), mass, h, phase);
      EXPECT_NEAR(impact.deepest, deepest, 2e-3 * deepest) << integration;
      EXPECT_NEAR(impact.duration, 2.94327 * deepest, 0.01 * deepest) << integration;
      EXPECT_NEAR(impact.rebound, 1.0, 5e-3) << integration;
    }
}

// Kelvin-Voigt that never pulls: x = V/w_d exp(-b t) sin(w_d t) until the force m x'' is zero again, which is
// where w_d t = atan2(2 b w_d, b^2 - w_d^2); there the speed is V exp(-b t). b = c/(2 m), w_d^2 = k/m - b^2.
TEST(Impact, KelvinVoigtRestitution) {
  constexpr double mass = 1.5, stiffness = 600.0;
  for (const double ratio : {0.05, 0.3, 0.7, 0.95}) {
    const double b = ratio * 20.0, w = 20.0 * std::sqrt(1.0 - ratio * ratio);
    const double end = std::atan2(2.0 * b * w, b * b - w * w) / w;
    for (const char* integration : {"explicit", "implicit"}) {
      const Impact impact = collide(
          with(integration, {{"stiffness", stiffness}, {"damping", 2.0 * mass * b}}), mass, 1e-5, 0.4);
      EXPECT_NEAR(impact.rebound, std::exp(-b * end), 2e-3) << integration << ", ratio " << ratio;
      EXPECT_NEAR(impact.duration, end, 1e-4) << integration << ", ratio " << ratio;
    }
  }
}

// A resting weight sinks by (m g/k)^(1/p), with either integration and whatever the step.
TEST(Impact, WeightRestsAtItsPenetration) {
  for (const char* integration : {"explicit", "implicit"})
    for (const double exponent : {1.0, 1.5, 2.3}) {
      NodeRun node("penalty",
                   with(integration, {{"stiffness", 4e3}, {"exponent", exponent}, {"damping", 20.0}}), 1e-3);
      double position = 0.0;
      for (int k = 0; k < 100000; ++k) {
        position += 1e-3 * node.v[0];
        node.gap = position;
        ASSERT_EQ(node.step({node.v[0] - 1e-3 * 9.81, 0, 0}), ILAW_OK);
      }
      EXPECT_NEAR(position, -std::pow(9.81 / 4e3, 1.0 / exponent), 1e-12) << integration << " " << exponent;
    }
}

// Without force, an implicit step never creates energy: -r (v^- + v)/2 is at least what the spring gained. At
// the end of an impact all energy is accounted for: kinetic energy lost = dissipated, as the output gives it.
TEST(Impact, ImplicitEnergyClosesAndNeverGrows) {
  for (const double stiffness : {1e2, 1e4, 1e6, 1e9})
    for (const double exponent : {1.0, 1.5}) {
      NodeRun node("penalty",
                   with("implicit", {{"stiffness", stiffness}, {"exponent", exponent}, {"damping", 3.0}}),
                   1e-3);
      node.v = node.v_previous = {-1.0, 0, 0};
      double position = 3e-4, dissipated = 0.0, total = 0.5;
      for (int k = 0; k < 2000; ++k) {
        node.gap = position;
        ASSERT_EQ(node.step(node.v), ILAW_OK);
        position += 1e-3 * node.v[0];
        dissipated += node.energy[ILAW_ENERGY_IMPACT];
        const double now = 0.5 * node.v[0] * node.v[0] + node.energy[ILAW_ENERGY_STORED];
        ASSERT_LE(now, total + 1e-15);
        ASSERT_NEAR(now + dissipated, 0.5, 1e-13);
        total = now;
      }
    }
}

}  // namespace
}  // namespace ilaw::testing
