// Elastic grains: impacts, pull-off and hysteresis against their closed forms, at three steps.
#include "support/law_runner.hpp"

#include <numbers>

namespace ilaw::testing {
namespace {

constexpr double pi = std::numbers::pi;

// A grain of mass m that meets a plane.
struct Grain {
  double r = 5e-5, e = 1e9, w = 0.0, m = 1.309e-9, a = 0.0;
  const char* adhesion = "jkr";

  Parameters parameters() const {
    return {{{"radius", r}, {"modulus", e}, {"adhesion_energy", w}, {"viscous_time", a}},
            {{"adhesion", adhesion}}};
  }
  // Hertz: (8/15) E sqrt(R) x^(5/2) = m v^2/2.
  double depth(double v) const { return std::pow(15.0 * m * v * v / (16.0 * e * std::sqrt(r)), 0.4); }
  // JKR: what a cycle of contact and break takes, 7.09 (w^5 R^4/E^2)^(1/3) (Thornton and Ning 1998).
  double hysteresis() const {
    return 0.3314980262 * e / (r * r) * std::pow(2.0 * pi * w * r * r / e, 5.0 / 3.0);
  }
};

struct Bounce {
  double speed, time, depth, energy, lost, broken;
};

// Thrown at a plane from a gap that is no multiple of the way of a step.
Bounce bounce(const Grain& grain, double v, double h) {
  NodeRun node("grain", grain.parameters(), h);
  node.h = {1.0 / grain.m};
  node.gap = 2.37 * v * h;
  node.v_previous = {-v, 0.0, 0.0};
  Bounce found{0.0, 0.0, 0.0, 0.0, 0.0, 0.0};
  bool met = false;
  for (int k = 0; k < 2000000; ++k) {
    EXPECT_EQ(node.step(node.v_previous), ILAW_OK) << node.report.reason;
    if (node.status != ILAW_FREE) {
      met = true;
      found.time += h;
    }
    found.lost += node.energy[1] + node.energy[2];
    found.broken += node.energy[2];
    node.gap += h * node.v[0];
    found.depth = std::max(found.depth, -node.gap);
    if (met && node.status == ILAW_FREE) break;
    if (met && k > 100000) break;  // it stuck
  }
  found.speed = node.v[0];
  found.energy = 0.5 * grain.m * node.v[0] * node.v[0] + node.energy[3];
  return found;
}

// Without adhesion all of the speed comes back, at any step; time and depth are of second order.
TEST(Grain, BouncesAsHertzSays) {
  const Grain grain;
  const double v = 0.3, depth = grain.depth(v);
  // 4/5 B(2/5, 1/2) = 2.9432751 (Deresiewicz 1968)
  const double duration = 2.9432751 * depth / v;
  double worst = 0.0;
  for (const double part : {1.0 / 31.0, 1.0 / 170.0, 1.0 / 983.0}) {
    const double h = part * duration;
    const Bounce found = bounce(grain, v, h);
    EXPECT_NEAR(found.speed, v, 1e-12 * v);
    EXPECT_NEAR(found.depth, depth, 8.0 * part * part * depth);
    EXPECT_NEAR(found.time, duration, 2.0 * h);
  }
  for (const double h : {duration, 7.3 * duration, 1e4 * duration}) {
    const Bounce found = bounce(grain, v, h);
    worst = std::max(worst, std::abs(found.speed - v) / v);
  }
  EXPECT_LT(worst, 1e-10);  // rounding of the long way in a step
}

// Leaving takes the hysteresis, and what is slower than that sticks (Thornton and Ning 1998).
TEST(Grain, OfJkrLosesItsHysteresis) {
  Grain grain;
  grain.w = 0.05;
  EXPECT_NEAR(
      grain.hysteresis() / std::cbrt(std::pow(grain.w, 5) * std::pow(grain.r, 4) / (grain.e * grain.e)), 7.09,
      0.005);
  const double sticking = std::sqrt(2.0 * grain.hysteresis() / grain.m);
  for (const double h : {7.1e-9, 1.7e-8, 4.3e-8}) {
    for (const double ratio : {1.01, 1.2, 2.0, 10.0}) {
      const double v = ratio * sticking, left = std::sqrt(1.0 - 1.0 / (ratio * ratio));
      const Bounce found = bounce(grain, v, h);
      EXPECT_NEAR(found.speed / v, left, 1e-9) << ratio << " " << h;
      EXPECT_NEAR(found.broken, grain.hysteresis(), 1e-9 * grain.hysteresis());
    }
    const Bounce stuck = bounce(grain, 0.99 * sticking, h);
    EXPECT_EQ(stuck.broken, 0.0);
    EXPECT_LT(std::abs(stuck.energy - 0.5 * grain.m * 0.99 * 0.99 * sticking * sticking),
              1e-6 * grain.m * sticking * sticking);
  }
}

// The least force that breaks a contact when it is raised slowly.
double pull_off(const Grain& grain, double h) {
  Parameters parameters = grain.parameters();
  parameters.numbers["viscous_time"] = 3e-6;  // comes to rest
  NodeRun node("grain", parameters, h);
  node.h = {1.0 / grain.m};
  node.gap = 1e-12;
  node.v_previous = {-1e-3, 0.0, 0.0};
  const double most = 2.0 * pi * grain.w * grain.r * 1.2;
  double force = 0.0;
  for (int k = 0; force < most; ++k) {
    if (k * h > 5e-4) force += 20.0 * h * most;
    EXPECT_EQ(node.step({node.v_previous[0] + h / grain.m * force, 0.0, 0.0}), ILAW_OK);
    node.gap += h * node.v[0];
    if (node.status == ILAW_BROKEN) return force;
  }
  return -1.0;
}

TEST(Grain, ComesOffAtThePullOfItsModel) {
  Grain grain;
  grain.w = 0.05;
  for (const double h : {9.7e-8, 1.9e-7, 4.1e-7}) {
    grain.adhesion = "jkr";
    EXPECT_NEAR(pull_off(grain, h) / (pi * grain.w * grain.r), 1.5, 2e-3) << h;
    grain.adhesion = "dmt";
    EXPECT_NEAR(pull_off(grain, h) / (pi * grain.w * grain.r), 2.0, 2e-3) << h;
  }
}

// Moved by hand: nothing before the surfaces meet, a neck on the way back, whose length and last force are
// known.
TEST(Grain, OfJkrHasANeckOnlyOnTheWayBack) {
  Grain grain;
  grain.w = 0.05;
  const double touch = -4.0 / 3.0 * pi * grain.w * grain.r, last = -5.0 / 6.0 * pi * grain.w * grain.r;
  const double neck = 0.75 * std::cbrt(pi * pi * grain.w * grain.w * grain.r / (grain.e * grain.e));
  for (const double v : {1e-4, 3.7e-4, 1.3e-3}) {
    const double h = 1e-8;
    NodeRun node("grain", grain.parameters(), h);
    node.h = {1e-6};  // a mass that no contact moves
    node.gap = 5e-9;
    node.v_previous = {-v, 0.0, 0.0};
    double first = 0.0, before = 0.0, at = 0.0;
    int turned = 1;
    while (true) {
      if (turned > 0 && node.gap < -2.0 * neck) {
        turned = -1;
        node.v_previous[0] = v;
      }
      ASSERT_EQ(node.step(node.v_previous), ILAW_OK);
      if (node.status == ILAW_BROKEN) break;
      if (first == 0.0) first = node.r[0] / h;
      before = node.r[0] / h;
      at = node.gap;
      node.v_previous = {turned > 0 ? -v : v, 0.0, 0.0};
      node.gap += h * node.v_previous[0];
    }
    EXPECT_LT(first, 0.0);
    EXPECT_GT(first, 1.02 * touch);
    EXPECT_NEAR(before, last, 0.1 * std::abs(last));
    EXPECT_NEAR(at, neck, 2.0 * v * h + 1e-3 * neck);
  }
}

// DMT's contact parts where it was made: no hysteresis.
TEST(Grain, OfDmtKeepsItsEnergy) {
  Grain grain;
  grain.w = 0.05;
  grain.adhesion = "dmt";
  for (const double h : {3.1e-9, 7.7e-9, 1.9e-7})
    for (const double v : {0.02, 0.3}) EXPECT_NEAR(bounce(grain, v, h).speed, v, 1e-12 * v);
}

// Stiff grains, whose impulses are far below that of the pull, in which the terms of the force cancel: a step
// rounds by the pull and the overlap under it, whatever its length.
TEST(Grain, KeepsItsEnergyBelowThePullOfItsModel) {
  constexpr int steps = 3000;
  constexpr double epsilon = std::numeric_limits<double>::epsilon();
  for (const char* adhesion : {"jkr", "dmt"})
    for (const double v : {0.2, 3.1e-3, 7.3e-5})
      for (const double h : {0.041, 1.7e-3, 2.3e-5}) {
        const Grain grain{1.0, 3e11, 1.0, 1.25e-3, 0.0, adhesion};
        const double pull = 2.0 * pi * grain.w * grain.r;
        const double overlap = std::cbrt(pull * pull / (grain.r * grain.e * grain.e));
        NodeRun node("grain", grain.parameters(), h);
        node.h = {1.0 / grain.m};
        node.v_previous = {-v, 0.0, 0.0};
        const double thrown = 0.5 * grain.m * v * v;
        double lost = 0.0, worst = 0.0;
        for (int k = 0; k < steps; ++k) {
          ASSERT_EQ(node.step(node.v_previous), ILAW_OK) << node.report.reason;
          lost += node.energy[0] + node.energy[1] + node.energy[2];
          const double now = 0.5 * grain.m * node.v[0] * node.v[0] + node.energy[3];
          worst = std::max(worst, std::abs(now + lost - thrown));
          node.gap += h * node.v[0];
        }
        EXPECT_LT(worst, epsilon * (128.0 * thrown + 8.0 * steps * pull * overlap))
            << adhesion << ", " << v << " m/s, " << h << " s";
      }
}

// To first order in A the loss is 3/2 rho A times the integral of sqrt(x) x'^2 over Hertz's impact, rho = 4/3
// E sqrt(R): 1 - e = (6/5) B(3/5, 3/2) rho A x_m^(3/2)/(m v).
TEST(Grain, LosesWhatViscosityTakes) {
  Grain grain;
  const double v = 0.3, beta = std::tgamma(0.6) * std::tgamma(1.5) / std::tgamma(2.1);
  const double rho = 4.0 / 3.0 * grain.e * std::sqrt(grain.r), depth = grain.depth(v);
  const double loss = 1.2 * beta * rho * std::pow(depth, 1.5) / (grain.m * v);
  for (const double part : {1.0 / 310.0, 1.0 / 570.0, 1.0 / 1930.0}) {
    grain.a = 1e-3 / loss;
    const Bounce found = bounce(grain, v, part * 2.94 * depth / v);
    EXPECT_NEAR((1.0 - found.speed / v) / 1e-3, 1.0, 3e-3) << part;
    EXPECT_NEAR(found.lost, 0.5 * grain.m * (v * v - found.speed * found.speed), 1e-12 * grain.m * v * v);
  }
}

// Pressed by a weight, it swings aside with Mindlin's stiffness 8 G a and slips at friction times the weight,
// to which adhesion adds twice its pull-off.
TEST(Grain, SwingsOnMindlinsSpringAndSlips) {
  Grain grain;
  for (const double w : {0.0, 0.05}) {
    grain.w = w;
    Parameters parameters = grain.parameters();
    parameters.numbers["viscous_time"] = 3e-6;
    parameters.numbers["friction"] = 0.4;
    parameters.numbers["shear_modulus"] = 7e8;
    const double weight = 2e-5, pull = 1.5 * pi * w * grain.r;
    for (const double h : {2.3e-8, 5.1e-8, 1.7e-8}) {
      NodeRun node("grain", parameters, h);
      node.h = {1.0 / grain.m};
      node.gap = 1e-12;
      node.v_previous = {-1e-3, 0.0, 0.0};
      const auto step = [&](double aside) {
        const Vector free{node.v_previous[0] - h / grain.m * weight, node.v_previous[1] + h / grain.m * aside,
                          0.0};
        ASSERT_EQ(node.step(free), ILAW_OK);
        node.gap += h * node.v[0];
      };
      for (int k = 0; k * h < 4e-4; ++k) step(0.0);
      const double circle = node.named("growth") + std::cbrt(2.0 * pi * w * grain.r * grain.r / grain.e);
      // JKR: a of a force; Hertz: a^3 = 3 F R/(4 E).
      const double six = 6.0 * pi * w * grain.r;
      const double load = weight + 0.5 * six + std::sqrt(six * weight + 0.25 * six * six);
      EXPECT_NEAR(circle, std::cbrt(0.75 * load * grain.r / grain.e), 1e-6 * circle);
      const double omega = std::sqrt(8.0 * 7e8 * circle / grain.m);
      node.v_previous[1] = 1e-5;
      double moved = 0.0, before = 0.0;
      int crossings = 0, steps = 0, last = 0;
      while (crossings < 9) {
        step(0.0);
        ++steps;
        before = moved;
        moved += h * node.v[1];
        if (before < 0.0 && moved >= 0.0) {
          ++crossings;
          last = steps;
        }
      }
      const double seen = 2.0 * pi * 9 / (last * h), discrete = 2.0 / h * std::asin(0.5 * omega * h);
      EXPECT_NEAR(std::min(seen / omega, seen / discrete), 1.0, 0.02 + omega * h);
      for (int k = 0; k * h < 3e-4; ++k) step(0.5 * (weight + 2.0 * pull));
      EXPECT_NEAR(-node.r[1] / h, 0.4 * (weight + 2.0 * pull), 1e-6 * weight);
      EXPECT_EQ(node.status, w > 0.0 ? ILAW_BONDED : ILAW_SLIP);
    }
  }
}

}  // namespace
}  // namespace ilaw::testing
