// Impacts without friction, through the ABI: their order, energy and state. The equations are those of
// docs/theory/resolved_impact.md.
#include "laws/changing_steps.hpp"

#include "support/law_runner.hpp"

#include <functional>

namespace ilaw::testing {
namespace {

Parameters frictionless(double restitution) { return {{{"restitution", restitution}}, {}}; }

// ---- a mass under a force that depends on its position

using Motion = std::function<double(double)>;

// Mean error of positions over that of the exact ones.
double error_of(double restitution, const Steps& steps, double end, const Motion& acceleration,
                const Motion& exact) {
  NodeRun node("impact", frictionless(restitution));
  double time = 0.0, step = steps(time), u = 1.0, v = 0.5 * step * acceleration(u), error = 0.0, size = 0.0;
  while (time + step < end) {
    u += step * v;
    time += step;
    error += step * std::abs(u - exact(time));
    size += step * std::abs(exact(time));
    const double next = steps(time);
    node.time = time;
    node.dt = 0.5 * (step + next);
    node.position_dt = next;
    node.gap = u;
    node.v_previous = {v, 0.0, 0.0};
    EXPECT_EQ(node.step({v + node.dt * acceleration(u), 0.0, 0.0}), ILAW_OK) << node.report.reason;
    v = node.v[0];
    step = next;
  }
  return error / size;
}

constexpr double gravity = 9.81;
double falls(double) { return -gravity; }
Motion ball(double restitution) {
  return [restitution](double time) {
    const double fall = std::sqrt(2.0 / gravity);
    if (time < fall) return 1.0 - 0.5 * gravity * time * time;
    double t = time - fall, w = restitution * gravity * fall;
    for (; w > 1e-9; w *= restitution) {
      if (t < 2.0 * w / gravity) return w * t - 0.5 * gravity * t * t;
      t -= 2.0 * w / gravity;
    }
    return 0.0;
  };
}

constexpr double frequency = 7.0, offset = 0.3;
double swings(double u) { return -frequency * frequency * (u + offset); }
// From rest at 1, about -offset, against the stop at 0.
Motion oscillator(double restitution) {
  return [restitution](double time) {
    double u = 1.0, v = 0.0, t = time;
    for (;;) {
      const double size = std::hypot(u + offset, v / frequency),
                   phase = std::atan2(v / frequency, u + offset),
                   until = (phase + std::acos(offset / size)) / frequency;
      if (t < until) return -offset + size * std::cos(frequency * t - phase);
      t -= until;
      u = 0.0;
      v = restitution * frequency * size * std::sin(frequency * until - phase);
      if (v < 1e-7) return 0.0;
    }
  };
}

TEST(Impact, IsExactForAnElasticBall) {
  for (const auto& set : step_sets)
    for (const double h : set) EXPECT_LE(error_of(1.0, fixed(h), 5.0, falls, ball(1.0)), 5e-12) << "h " << h;
}

// Through the accumulation point: bounces that last less than a step are cut, h^2 high.
TEST(Impact, BringsABallToRestAtOrderTwo) {
  for (const double restitution : {0.8, 0.5})
    for (const auto& set : step_sets)
      for (const double h : set)
        EXPECT_LE(error_of(restitution, fixed(h), 5.0, falls, ball(restitution)), 0.05 * h * h + 1e-11)
            << "e " << restitution << ", h " << h;
}

TEST(Impact, HasOrderTwoAtChangingSteps) {
  for (const double restitution : {1.0, 0.8, 0.5})
    for (const auto& set : step_sets)
      for (const double h : set) {
        GIVEN(restitution, h);
        EXPECT_LE(error_of(restitution, varying(h), 5.0, falls, ball(restitution)), 8.0 * h * h);
        EXPECT_LE(error_of(restitution, varying(h), 3.0, swings, oscillator(restitution)), 250.0 * h * h);
      }
}

TEST(Impact, HasOrderTwoAgainstAStop) {
  for (const double restitution : {1.0, 0.8, 0.5})
    for (const auto& set : step_sets)
      for (const double h : set)
        EXPECT_LE(error_of(restitution, fixed(h), 3.0, swings, oscillator(restitution)), 150.0 * h * h)
            << "e " << restitution << ", h " << h;
}

// ---- energy

// An impact under a constant force, anywhere in its step, loses (1 - e^2) w^2/(2 H) over both impulses, and
// the node goes on along its parabola.
TEST(Impact, LosesTheEnergyOfItsRestitution) {
  constexpr double h = 1e-2, w = -3.0, inverse_mass = 0.5;
  for (const double restitution : {0.25, 1.0 / 3.0, 0.8, 1.0})
    for (const double force : {0.0, -10.0, 10.0})
      for (double part = 0.0; part < 1.0; part += 1.0 / 64.0) {
        NodeRun node("impact", frictionless(restitution), h);
        node.h[0] = inverse_mass;
        const double s = part * h, leaving = -restitution * w;
        node.gap = -w * s + 0.5 * force * s * s;
        node.v_previous = {w - force * (s + 0.5 * h), 0.0, 0.0};
        double lost = 0.0;
        for (int k = 0; k < 2; ++k) {
          ASSERT_EQ(node.step({node.v_previous[0] + force * h, 0.0, 0.0}), ILAW_OK) << node.report.reason;
          lost += node.energy[ILAW_ENERGY_IMPACT];
          node.gap += h * node.v[0];
        }
        const double loss = 0.5 * (1.0 - restitution * restitution) * w * w / inverse_mass;
        EXPECT_NEAR(lost, loss, 1e-13) << "e " << restitution << ", part " << part << ", " << force;
        EXPECT_NEAR(node.v[0], leaving + force * (1.5 * h - s), 1e-13)
            << "e " << restitution << ", part " << part << ", " << force;
        EXPECT_NEAR(node.energy[ILAW_ENERGY_STORED], 0.0, 1e-300);
      }
}

// ---- impacts close to one another, walls that move

// Pressed so that a flight lasts little more than a step: the floor is never passed, and each step is within
// what the one before left of the energy.
TEST(Impact, IsHitAgainInTheNextStep) {
  constexpr double h = 1e-2, force = -100.0;
  int again = 0;
  for (const double restitution : {0.5, 0.9, 1.0})
    for (double start = 0.01; start < 0.06; start += 0.00137) {
      NodeRun node("impact", frictionless(restitution), h);
      node.gap = start;
      double before = INFINITY;
      for (int k = 0; k < 400; ++k) {
        const double waited = node.state[0], gap = node.gap;
        ASSERT_EQ(node.step({node.v[0] + force * h, 0.0, 0.0}), ILAW_OK) << node.report.reason;
        again += waited != 0.0 && node.state[0] != 0.0;
        node.gap += h * node.v[0];
        const double energy =
            0.5 * node.v[0] * node.v[0] - 0.5 * force * (gap + node.gap) + node.energy[ILAW_ENERGY_STORED];
        ASSERT_GE(node.gap, -1e-17) << "start " << start << ", k " << k;
        ASSERT_LE(energy, before + 1e-14) << "start " << start << ", k " << k;
        before = energy;
      }
      EXPECT_LE(node.gap, restitution < 1.0 ? 1e-16 : 0.06) << "e " << restitution << ", start " << start;
    }
  EXPECT_GT(again, 100);
}

TEST(Impact, NeverPassesAtAnyPositionStep) {
  for (const double l : {3e-4, 1e-3, 7e-3})
    for (const double restitution : {0.3, 1.0}) {
      NodeRun node("impact", frictionless(restitution), 1e-3);
      node.position_dt = l;
      for (double gap = 0.0; gap < 3.0; gap += 0.0437) {
        node.initialise();
        node.gap = gap * l;
        node.v_previous = {-2.0, 0.0, 0.0};
        ASSERT_EQ(node.step({-2.1, 0.2, 0.0}), ILAW_OK);
        EXPECT_GE(node.gap + l * node.v[0], -1e-17) << "l " << l << ", gap " << gap;
      }
    }
}

}  // namespace
}  // namespace ilaw::testing
