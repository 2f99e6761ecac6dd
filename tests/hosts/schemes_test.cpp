// The three cases with known answers of docs/schemes.md, in each of the schemes that the page tells where to
// call a law: what an owner of a solver runs in a code of his own.
// SPDX-License-Identifier: BSD-3-Clause
#include "support/law_runner.hpp"

#include <functional>

namespace ilaw::testing {
namespace {

constexpr double mass = 2.0, gravity = 10.0;
constexpr double steps[] = {1e-3, 7e-4, 1.3e-3};

struct Point {
  Vector u{}, v{};  // in the axes of the law: normal first
  double time = 0.0;
};
using Force = std::function<Vector(const Point&)>;
using Observer = std::function<void(const Point&, const NodeRun&)>;

void advance(Vector& a, double factor, const Vector& b) {
  for (std::size_t c = 0; c < 3; ++c) a[c] += factor * b[c];
}

// The law's impulse at the end of a step, from the half-step velocity and the sum of all other forces.
Vector impulse_of(NodeRun& law, const Point& point, const Vector& half_velocity, const Vector& f) {
  Vector v_free = half_velocity;
  advance(v_free, law.dt / mass, f);
  law.h = {1.0 / mass};
  law.gap = point.u[0];
  law.time = point.time;
  law.v_previous = half_velocity;
  EXPECT_EQ(law.step(v_free), ILAW_OK) << law.report.reason;
  return law.r;
}

// Velocities live at half steps. v of the point is that of the last half step.
void central_differences(NodeRun& law, Point point, double end, const Force& force, const Observer& see) {
  advance(point.v, law.dt / (2 * mass), force(point));
  while (point.time < end) {
    point.time += law.dt;
    advance(point.u, law.dt, point.v);
    const Vector f = force(point), r = impulse_of(law, point, point.v, f);
    advance(point.v, law.dt / mass, f);
    advance(point.v, 1.0 / mass, r);
    see(point, law);
  }
}

void velocity_verlet(NodeRun& law, Point point, double end, const Force& force, const Observer& see) {
  Vector f = force(point);
  while (point.time < end) {
    advance(point.v, law.dt / (2 * mass), f);
    point.time += law.dt;
    advance(point.u, law.dt, point.v);
    f = force(point);
    advance(f, 1.0 / law.dt, impulse_of(law, point, point.v, f));
    Point half = point;  // what the next step moves with
    advance(half.v, law.dt / mass, f);
    see(half, law);
    advance(point.v, law.dt / (2 * mass), f);
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
    advance(f, 1.0 / law.dt, impulse_of(law, point, point.v, f));
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
    {"central differences", central_differences},
    {"velocity Verlet", velocity_verlet},
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

}  // namespace
}  // namespace ilaw::testing
