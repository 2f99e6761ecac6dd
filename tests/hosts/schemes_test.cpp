// The three cases with known answers of docs/schemes.md, in each of the schemes that the page tells where to
// call a law: what an owner of a solver runs in a code of his own.
// SPDX-License-Identifier: BSD-3-Clause
#include "support/law_runner.hpp"

#include <functional>
#include <vector>

namespace ilaw::testing {
namespace {

constexpr double mass = 2.0, gravity = 10.0;
constexpr double steps[] = {1e-3, 7e-4, 1.3e-3};

// The length of step n, in one test another for each.
using Steps = std::function<double(int)>;
Steps constant(double h) {
  return [h](int) { return h; };
}

struct Point {
  Vector u{}, v{};  // in the axes of the law: normal first
  double time = 0.0;
};
using Force = std::function<Vector(const Point&)>;
using Observer = std::function<void(const Point&, const NodeRun&)>;

void advance(Vector& a, double factor, const Vector& b) {
  for (std::size_t c = 0; c < 3; ++c) a[c] += factor * b[c];
}

// The law's impulse at the end of a step, from the free and the half-step velocity.
Vector impulse_of(NodeRun& law, const Vector& v_free, const Vector& v, double gap, double time) {
  law.h = {1.0 / mass};
  law.gap = gap;
  law.time = time;
  law.v_previous = v;
  EXPECT_EQ(law.step(v_free), ILAW_OK) << law.report.reason;
  return law.r;
}

// Called when all other forces of step n are summed; v is still the half-step velocity. Adds the law's force.
void force_hook(NodeRun& law, const Steps& step_length, int n, double time, const Vector& u, const Vector& v,
                Vector& f) {
  law.dt = (step_length(n) + step_length(n + 1)) / 2;  // velocity_step: this and the next half kick
  law.position_dt = step_length(n + 1);                // position_step
  Vector v_free = v;
  advance(v_free, law.dt / mass, f);
  const Vector r = impulse_of(law, v_free, v, u[0], time);
  advance(f, 1.0 / law.dt, r);
}

// Velocities live at half steps. v of the point is that of the last half step.
void central_differences(NodeRun& law, Point point, double end, const Force& force, const Observer& see,
                         const Steps& length) {
  advance(point.v, length(0) / (2 * mass), force(point));
  for (int n = 0; point.time < end; ++n) {
    law.dt = (length(n) + length(n + 1)) / 2;
    law.position_dt = length(n + 1);
    point.time += length(n);
    advance(point.u, length(n), point.v);
    Vector v_free = point.v;
    advance(v_free, law.dt / mass, force(point));
    const Vector r = impulse_of(law, v_free, point.v, point.u[0], point.time);
    point.v = v_free;
    advance(point.v, 1.0 / mass, r);
    see(point, law);
  }
}

void velocity_verlet(NodeRun& law, Point point, double end, const Force& force, const Observer& see,
                     const Steps& length) {
  Vector f = force(point);
  for (int n = 0; point.time < end; ++n) {
    advance(point.v, length(n) / (2 * mass), f);
    point.time += length(n);
    advance(point.u, length(n), point.v);
    f = force(point);
    force_hook(law, length, n, point.time, point.u, point.v, f);
    Point half = point;  // what the next step moves with
    advance(half.v, law.dt / mass, f);
    see(half, law);
    advance(point.v, length(n) / (2 * mass), f);
  }
}

// Newmark's scheme with beta = 0 (Newmark 1959; Hughes, The Finite Element Method, 1987, section 9.1).
void predictor_corrector(double gamma, NodeRun& law, Point point, double end, const Force& force,
                         const Observer& see) {
  Vector a{};
  advance(a, 1.0 / mass, force(point));
  while (point.time < end) {
    advance(point.u, law.dt, point.v);
    advance(point.u, law.dt * law.dt / 2.0, a);
    advance(point.v, (1.0 - gamma) * law.dt, a);  // the predicted velocity is the half-step velocity
    point.time += law.dt;
    Vector f = force(point);
    force_hook(law, constant(law.dt), 0, point.time, point.u, point.v, f);
    a = {f[0] / mass, f[1] / mass, f[2] / mass};
    Point half = point;
    advance(half.v, law.dt, a);
    see(half, law);
    advance(point.v, gamma * law.dt, a);
  }
}

using Scheme = std::function<void(NodeRun&, Point, double, const Force&, const Observer&)>;
struct NamedScheme {
  const char* name;
  Scheme run;
};
const NamedScheme schemes[] = {
    {"central differences",
     [](NodeRun& law, auto&&... given) { central_differences(law, given..., constant(law.dt)); }},
    {"velocity Verlet",
     [](NodeRun& law, auto&&... given) { velocity_verlet(law, given..., constant(law.dt)); }},
    {"predictor-corrector", [](auto&&... given) { predictor_corrector(0.5, given...); }},
    {"predictor-corrector, gamma 0.6", [](auto&&... given) { predictor_corrector(0.6, given...); }}};

// Every scheme at steps that share no factor.
void for_each_scheme(const std::function<void(const Scheme&, double)>& check) {
  for (const NamedScheme& scheme : schemes)
    for (const double h : steps) {
      SCOPED_TRACE(::testing::Message() << scheme.name << ", h = " << h);
      check(scheme.run, h);
    }
}

Vector weight(const Point&) { return {-mass * gravity, 0.0, 0.0}; }

TEST(Schemes, ADroppedBallReboundsToTheSquareOfItsRestitution) {
  for_each_scheme([](const Scheme& run, double h) {
    NodeRun law("contact", {{{"restitution", 0.5}}, {}}, h);
    double touch = 0.0, rebound = 0.0, peak = 0.0, lowest = 1.0, last = 1.0;
    run(law, {.u = {1.0, 0.0, 0.0}}, 2.0, weight, [&](const Point& p, const NodeRun& node) {
      if (node.r[0] > 0.0 && touch == 0.0) touch = p.time, rebound = p.v[0];
      if (touch > 0.0 && p.time < 0.9) peak = std::max(peak, p.u[0]);
      lowest = std::min(lowest, p.u[0]);
      last = std::abs(p.v[0]);
    });
    EXPECT_NEAR(touch, std::sqrt(0.2), 2 * h);
    EXPECT_NEAR(rebound, 0.5 * std::sqrt(20.0), 2 * gravity * h);
    EXPECT_NEAR(peak, 0.25, 5 * h);
    EXPECT_GE(lowest, -1e-2 * h);
    EXPECT_LE(last, 1e-12);  // at rest since 3 sqrt(0.2) = 1.34
  });
}

TEST(Schemes, ASlidingBlockStopsWhereFrictionStopsIt) {
  for_each_scheme([](const Scheme& run, double h) {
    NodeRun law("coulomb", {{{"friction", 0.3}}, {}}, h);
    double stop = 0.0, distance = 0.0, speed = 1.0;
    run(law, {.v = {0.0, 2.0, 0.0}}, 1.0, weight, [&](const Point& p, const NodeRun& node) {
      if (node.status == ILAW_STICK && stop == 0.0) stop = p.time;
      distance = p.u[1];
      speed = std::abs(p.v[1]);
    });
    EXPECT_NEAR(stop, 2.0 / 3.0, 2 * h);
    EXPECT_NEAR(distance, 2.0 / 3.0, 3 * h);
    EXPECT_LE(speed, 1e-15);
  });
}

TEST(Schemes, AWeldUnderARampBreaksWhenTheImpulseOfItsMemoryDoes) {
  for_each_scheme([](const Scheme& run, double h) {
    NodeRun law("tie", {{{"strength", 1.0}, {"memory", 0.1}}, {}}, h);
    const Force ramp = [](const Point& p) { return Vector{10.0 * p.time, 0.0, 0.0}; };
    double broken = 0.0, moved = 0.0;
    run(law, {}, 1.25, ramp, [&](const Point& p, const NodeRun& node) {
      if (node.status == ILAW_BROKEN && broken == 0.0) broken = p.time;
      if (broken == 0.0) moved = std::max(moved, std::abs(p.u[0]));
    });
    EXPECT_NEAR(broken, 1.05, 2 * h);
    EXPECT_LE(moved, 1e-15);
  });
}

// A code that has nothing but a hook for nodal forces, at steps that vary: a block on a spring falls,
// bounces, slides and is dragged back.
TEST(Schemes, VelocityVerletIsTheSchemeItselfAtVariableSteps) {
  const auto velocities_of = [](auto scheme) {
    NodeRun law("coulomb", {{{"friction", 0.3}, {"restitution", 0.5}}, {}});
    const Force force = [](const Point& p) {
      return Vector{-mass * gravity, -40.0 * p.u[1], -40.0 * p.u[2]};
    };
    std::vector<Vector> found;
    scheme(
        law, Point{.u = {0.2, 0.0, 0.1}, .v = {-0.5, 2.0, -1.0}}, 4.0, force,
        [&](const Point& p, const NodeRun&) { found.push_back(p.v); },
        [](int n) { return 1e-3 * (1.0 + 0.4 * std::sin(n)); });
    return found;
  };
  const std::vector<Vector> expected = velocities_of(central_differences),
                            found = velocities_of(velocity_verlet);
  ASSERT_EQ(found.size(), expected.size());
  int bounces = 0;
  for (std::size_t n = 0; n < found.size(); ++n) {
    for (std::size_t c = 0; c < 3; ++c) ASSERT_NEAR(found[n][c], expected[n][c], 1e-12) << "step " << n;
    bounces += n > 0 && found[n - 1][0] < 0.0 && found[n][0] > 0.0;
  }
  EXPECT_GE(bounces, 4);
  EXPECT_LE(std::abs(found.back()[0]), 1e-2);
  EXPECT_EQ(expected.back()[1], 0.0) << "it sticks in the end";
}

}  // namespace
}  // namespace ilaw::testing
