// A mass against a penalised obstacle, step by step, against the closed forms of continuous time.
#include "support/law_runner.hpp"

namespace ilaw::testing {
namespace {

constexpr double pi = 3.14159265358979323846;

// The impact of a free mass at speed 1, from its first closed step to its last.
struct Impact {
  double duration = 0.0, rebound = 0.0, deepest = 0.0;
};

// The mass starts `phase` of a step above the obstacle and moves freely but for the law.
Impact collide(const Parameters& parameters, double mass, double step, double phase, int most = 1000000) {
  NodeRun node("penalty", parameters, step);
  node.h[0] = 1.0 / mass;
  node.v = node.v_previous = {-1.0, 0, 0};
  double position = phase * step;
  Impact impact;
  for (int k = 0; k < most; ++k) {
    node.gap = position;
    EXPECT_EQ(node.step(node.v), ILAW_OK);
    position += step * node.v[0];
    impact.deepest = std::max(impact.deepest, -position);
    if (node.r[0] > 0.0) impact.duration += step;
    if (node.r[0] == 0.0 && node.v[0] >= 0.0 && position + 0.5 * step * node.v[0] > 0.0) break;
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
// at most (omega h)^2/8; the duration by the two cut steps. Implicit: the speed is exact.
TEST(Impact, LinearSpringReturnsTheMass) {
  constexpr double mass = 2.0, stiffness = 5000.0;  // omega = 50
  for (const double h : {1e-3, 1.3e-4, 1.7e-5})
    for (const double phase : {0.0, 0.3, 0.77}) {
      const double omega_h = 50.0 * h;
      for (const char* integration : {"explicit", "implicit"}) {
        const Impact free = collide(with(integration, {{"stiffness", stiffness}}), mass, h, phase);
        const bool exact = integration == std::string("implicit");
        EXPECT_NEAR(free.duration, pi / 50.0, 2.0 * h) << integration;
        EXPECT_NEAR(free.rebound, 1.0, exact ? 1e-13 : omega_h * omega_h / 8.0 + 1e-12) << integration;
        EXPECT_NEAR(free.deepest, 0.02, 0.02 * omega_h * omega_h + (exact ? h : 0.0)) << integration;
      }
    }
}

// Whatever the stiffness and the phase, from two thousand steps in contact to one: all of the speed comes
// back, or what the restitution leaves of it, exactly so where the spring is soft or stiff to the step.
TEST(Impact, ImplicitReachesItsRestitution) {
  for (const double e : {1.0, 0.95, 0.8, 0.5, 0.3, 0.15, 0.05, 0.0})
    for (double pace = 0.02; pace < 2000.0; pace *= 1.87)
      for (const double phase : {0.0, 0.13, 0.31, 0.5, 0.77, 0.93})
        for (const double exponent : {1.0, 1.5}) {
          if (exponent != 1.0 && e != 1.0) continue;
          const Impact impact = collide(
              with("implicit", {{"stiffness", pace * pace}, {"restitution", e}, {"exponent", exponent}}), 1.0,
              1.0, phase, static_cast<int>(20.0 / pace) + 20);
          const double tolerance = e == 1.0 ? 1e-12 : 0.04;
          ASSERT_NEAR(impact.rebound, e, tolerance) << "omega h " << pace << ", phase " << phase;
          if (e > 0.05 && pace > 100.0) {
            ASSERT_NEAR(impact.rebound, e, 0.01) << "omega h " << pace << ", phase " << phase;
          }
          ASSERT_LE(impact.rebound, 1.0 + 1e-12);
        }
}

// Steps that change, as adaptive codes have them: h = (dt_1 + dt_2)/2 in the velocity, l = dt_2 in the
// position, each up to half as long again or half as short as the one before. The speed still is exact.
TEST(Impact, ImplicitReturnsTheMassWhateverTheSteps) {
  Random random(5);
  for (const double exponent : {1.0, 1.5})
    for (const double stiffness : {1e2, 1e4, 1e6, 1e9})
      for (int run = 0; run < 20; ++run) {
        NodeRun node("penalty", with("implicit", {{"stiffness", stiffness}, {"exponent", exponent}}), 1e-2);
        node.v = node.v_previous = {-1.0, 0, 0};
        double position = 0.017, last = 1e-2;
        for (int k = 0; k < 1000 && (k < 4 || node.state[0] > 0.0 || node.v[0] < 0.0); ++k) {
          const double next = 1e-2 * random(0.5, 1.5);
          node.dt = 0.5 * (last + next);
          node.position_dt = last = next;
          node.gap = position;
          ASSERT_EQ(node.step(node.v), ILAW_OK);
          position += next * node.v[0];
        }
        ASSERT_NEAR(node.v[0], 1.0, 1e-12) << "stiffness " << stiffness << ", run " << run;
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

// A node that is shaken while it stays pressed: the lead h tau A of its velocity amplitude A is given back in
// each cycle, at slow and at fast shaking, for soft springs and stiff ones.
TEST(Impact, ShakenUnderPressureItStaysAtItsDepth) {
  constexpr double h = 1e-3;
  for (const double e : {1.0, 0.5, 0.0})
    for (const double stiffness : {1e4, 1e6, 3e7})
      for (const int period : {320, 40, 5}) {
        NodeRun node("penalty", with("implicit", {{"stiffness", stiffness}, {"restitution", e}}), h);
        node.state[0] = 100.0 / stiffness;
        double position = -node.state[0], fastest = 0.0, first = 0.0, last = 0.0;
        constexpr int window = 9600;  // of whole periods
        for (int k = 0; k < 6 * window; ++k) {
          node.gap = position;
          const double force = -100.0 + 20.0 * std::sin(2.0 * pi * k / period);
          ASSERT_EQ(node.step({node.v[0] + h * force, 0, 0}), ILAW_OK);
          position += h * node.v[0];
          fastest = std::max(fastest, std::abs(node.v[0]));
          if (k >= window && k < 2 * window) first += position / window;
          if (k >= 5 * window) last += position / window;
        }
        const std::string at = std::to_string(e) + ", stiffness " + std::to_string(stiffness) + ", period " +
                               std::to_string(period);
        EXPECT_NEAR(last, first, 0.01 * h * fastest) << at;
        EXPECT_NEAR(last, -100.0 / stiffness, h * fastest) << at;
      }
}

// A resting weight turns up a force of h m g per step and stays, whatever the restitution; where it rests is
// off by the gap at which it closed, at most h V, and by what h g lets it sink while it settles.
TEST(Impact, ImplicitWeightComesToRest) {
  for (const double e : {0.9, 0.5, 0.0})
    for (const double stiffness : {4e3, 1e6, 1e9}) {
      const double h = 1e-3;
      NodeRun node("penalty", with("implicit", {{"stiffness", stiffness}, {"restitution", e}}), h);
      double position = 0.0, fastest = 0.0;
      for (int k = 0; k < 40000; ++k) {
        position += h * node.v[0];
        node.gap = position;
        ASSERT_EQ(node.step({node.v[0] - h * 9.81, 0, 0}), ILAW_OK);
        fastest = std::max(fastest, std::abs(node.v[0]));
      }
      EXPECT_NEAR(position, -9.81 / stiffness, h * (fastest + h * 9.81)) << e << " " << stiffness;
      EXPECT_NEAR(node.state[0], 9.81 / stiffness, 1e-6 * 9.81 / stiffness) << e << " " << stiffness;
      EXPECT_NEAR(node.r[0], h * 9.81, 1e-6 * h * 9.81) << e << " " << stiffness;
    }
}

}  // namespace
}  // namespace ilaw::testing
