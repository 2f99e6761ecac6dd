// Impacts with friction, through the ABI: rebounds that stick and slide against closed forms,
// starts of slip, orders. The equations are those of docs/theory/resolved_impact.md.
#include "impact_runs.hpp"

#include "laws/changing_steps.hpp"

namespace ilaw::testing {
namespace {

// The tangential velocity after an impact of the speed w, in closed form: it slips on mu (1 + e) w/h_N, or
// sticks. coupling: h_T/h_N, 1 of a point and 7/2 of the lowest point of a sphere.
void rebound(Vector& v, double friction, double restitution, double coupling) {
  const double speed = tangential_length(v), lost = friction * (1.0 + restitution) * -v[0] * coupling;
  for (int c = 1; c < 3; ++c) v[c] *= speed > lost ? 1.0 - lost / speed : 0.0;
  v[0] *= -restitution;
}

struct Error {
  double position = 0.0, velocity = 0.0;  // the largest; of velocities where no work waits
};

// ---- constant forces

struct Throw {
  Vector u, v, acceleration;
};

// Where the thrown body is, and its velocity.
Throw thrown_at(Throw at, const Body& body, double time) {
  for (;;) {
    const double a = at.acceleration[0], w = -std::sqrt(at.v[0] * at.v[0] - 2.0 * a * at.u[0]);
    const double until = (w - at.v[0]) / a, now = std::min(until, time);
    for (std::size_t c = 0; c < 3; ++c) {
      at.u[c] += now * (at.v[c] + 0.5 * now * at.acceleration[c]);
      at.v[c] += now * at.acceleration[c];
    }
    if (time < until) return at;
    time -= until;
    at.u[0] = 0.0;
    at.v[0] = w;
    rebound(at.v, body.friction, body.restitution, body.coupling);
  }
}

Error error_of_throw(const Throw& start, const Body& body, const Steps& steps, double end) {
  NodeRun node("impact", rough(body.friction, body.restitution), 1.0, ILAW_DELASSUS_TRANSVERSE);
  node.h[1] = body.coupling;
  double time = 0.0, step = steps(0.0);
  Vector u = start.u, v = start.v;
  for (std::size_t c = 0; c < 3; ++c) v[c] += 0.5 * step * start.acceleration[c];
  Error found;
  while (time + step < end) {
    for (std::size_t c = 0; c < 3; ++c) u[c] += step * v[c];
    time += step;
    const Throw exact = thrown_at(start, body, time);
    for (std::size_t c = 0; c < 3; ++c)
      found.position = std::max(found.position, std::abs(u[c] - exact.u[c]));
    const double next = steps(time);
    node.time = time;
    node.dt = 0.5 * (step + next);
    node.position_dt = next;
    node.gap = u[0];
    node.v_previous = v;
    Vector free = v;
    for (std::size_t c = 0; c < 3; ++c) free[c] += node.dt * start.acceleration[c];
    EXPECT_EQ(node.step(free), ILAW_OK) << node.report.reason;
    expect_in_cone(node.r, body.friction);
    v = node.v;
    const bool waits = node.state[0] != 0.0;
    for (std::size_t c = 0; c < 3 && !waits; ++c) {
      const double half_step = exact.v[c] + 0.5 * next * start.acceleration[c];
      found.velocity = std::max(found.velocity, std::abs(v[c] - half_step));
    }
    step = next;
  }
  return found;
}

// Thrown askew above a tilted floor: neither the force nor the motion lies in one plane with the other.
const Throw askew{{0.3, 0.0, 0.0}, {-1.0, 2.0, 0.7}, {-9.81, -1.1, 2.3}};

TEST(RoughImpact, IsExactForThrownBodies) {
  for (const double coupling : {1.0, 3.5})
    for (const double restitution : {1.0, 0.8})
      for (const double friction : {0.0, 0.05, 0.3, inf_value})
        for (const auto& set : step_sets)
          for (const double h : set) {
            const Error found = error_of_throw(askew, {friction, restitution, coupling}, fixed(h), 1.5);
            const double rounding = 1e-15 / h;  // some ulp per step
            EXPECT_LE(found.position, rounding) << friction << ", e " << restitution << ", h " << h;
            EXPECT_LE(found.velocity, rounding) << friction << ", e " << restitution << ", h " << h;
          }
}

TEST(RoughImpact, HasOrderTwoAtChangingSteps) {
  for (const double restitution : {1.0, 0.8})
    for (const double friction : {0.05, 0.3, inf_value})
      for (const auto& set : step_sets)
        for (const double h : set) {
          const Error found = error_of_throw(askew, {friction, restitution, 3.5}, varying(h), 1.5);
          EXPECT_LE(found.position, 6.0 * h * h) << friction << ", e " << restitution << ", h " << h;
        }
}

// Both impulses together are that of the impact, and each has its part: 1 - s and s of the step.
TEST(RoughImpact, SharesTheImpulseOfTheImpact) {
  constexpr double h = 1e-2, inverse_mass = 0.5, w = 3.0;
  for (const double friction : {0.2, 2.0})
    for (const double restitution : {0.25, 1.0})
      for (double part = 1.0 / 64.0; part < 1.0; part += 1.0 / 32.0) {
        NodeRun node("impact", rough(friction, restitution), h, ILAW_DELASSUS_TRANSVERSE);
        node.h[0] = inverse_mass;
        node.h[1] = 2.0 * inverse_mass;
        node.gap = w * part * h;
        node.v_previous = {-w, 1.5, -2.0};
        Vector after = node.v_previous;
        rebound(after, friction, restitution, 2.0);
        for (const double share : {1.0 - part, part}) {
          ASSERT_EQ(node.step(node.v_previous), ILAW_OK);
          const Vector whole{(after[0] + w) / inverse_mass, 0.5 * (after[1] - 1.5) / inverse_mass,
                             0.5 * (after[2] + 2.0) / inverse_mass};
          EXPECT_THAT(node.r, VectorNear(share * whole, 1e-13)) << part;
          EXPECT_EQ(node.status, friction == 2.0 ? ILAW_STICK : ILAW_SLIP);
          node.gap += h * node.v[0];
        }
        EXPECT_THAT(node.v, VectorNear(after, 1e-13)) << part;
      }
}

// Thrown down so hard that a flight lasts 1.2 steps, and pulled along the floor, to which it sticks at each
// impact: at 0.5 of a step, and at 0.7 of the next.
TEST(RoughImpact, SticksAgainInTheNextStep) {
  constexpr double h = 1e-2, press = -100.0, pull = 70.0, w = 1.2, slides = 0.9, first = 0.5 * h,
                   flight = 1.2 * h, left = 2.0 * h - (first + flight);
  NodeRun node("impact", rough(inf_value, 0.5), h);
  node.gap = w * first + 0.5 * press * first * first;
  node.v_previous = {-w - press * (first + 0.5 * h), slides - pull * (first + 0.5 * h), 0.0};
  double x = 0.0;
  for (int k = 0; k < 2; ++k) {
    const Vector before = node.v_previous;
    ASSERT_EQ(node.step({before[0] + press * h, before[1] + pull * h, 0.0}), ILAW_OK);
    EXPECT_NE(node.state[0], 0.0) << "step " << k;
    node.gap += h * node.v[0];
    x += h * node.v[1];
  }
  EXPECT_NEAR(node.gap, left * (0.25 * w + 0.5 * press * left), 1e-16);
  EXPECT_NEAR(x, first * (slides - 0.5 * pull * first) + 0.5 * pull * (flight * flight + left * left), 1e-16);
}

// On a belt: the same, seen from it.
TEST(RoughImpact, ReboundsFromAMovingBelt) {
  constexpr double h = 1e-3, belt = 1.7, lift = 0.4, start = 0.1, end = 0.2;
  for (const double friction : {0.1, inf_value}) {
    NodeRun node("impact", rough(friction, 0.5), h);
    double z = start, x = 0.0, vz = -1.0, vx = 0.0, time = 0.0;
    for (; time < end; time += h) {
      node.gap = z - lift * time;
      node.v_previous = {vz - lift, vx - belt, 0.0};
      ASSERT_EQ(node.step(node.v_previous), ILAW_OK);
      vz = node.v[0] + lift;
      vx = node.v[1] + belt;
      z += h * vz;
      x += h * vx;
    }
    Vector after{-1.0 - lift, -belt, 0.0};
    const double meets = start / (1.0 + lift);
    rebound(after, friction, 0.5, 1.0);
    EXPECT_NEAR(vx, after[1] + belt, 1e-13) << friction;
    EXPECT_NEAR(x, (after[1] + belt) * (time - meets), 1e-13) << friction;
    EXPECT_NEAR(z, start - meets + (after[0] + lift) * (time - meets), 1e-13) << friction;
  }
}

// ---- forces of springs

// Springs to -offset along the normal and to 0 along the tangent, against a rough stop at 0.
constexpr double frequency = 7.0, offset = 0.3, tangential_frequency = 4.3;

struct Swing {
  double u = 1.0, v = 0.0, x = 0.8, y = 0.5;  // y: velocity along the tangent
};
void turn(double& u, double& v, double w, double time) {
  const double c = std::cos(w * time), s = std::sin(w * time), before = u;
  u = c * u + s / w * v;
  v = c * v - w * s * before;
}
Swing swing_at(const Body& body, double time) {
  Swing at;
  for (;;) {
    const double size = std::hypot(at.u + offset, at.v / frequency),
                 phase = std::atan2(at.v / frequency, at.u + offset),
                 until = (phase + std::acos(offset / size)) / frequency, now = std::min(time, until);
    at.u += offset;
    turn(at.u, at.v, frequency, now);
    at.u -= offset;
    turn(at.x, at.y, tangential_frequency, now);
    if (time < until) return at;
    time -= until;
    at.u = 0.0;
    Vector v{at.v, at.y, 0.0};
    rebound(v, body.friction, body.restitution, body.coupling);
    at.v = v[0];
    at.y = v[1];
    if (at.v < 1e-7) return at;
  }
}
double error_of_swing(const Body& body, const Steps& steps, double end) {
  NodeRun node("impact", rough(body.friction, body.restitution), 1.0);
  const auto pull = [](double u) { return -frequency * frequency * (u + offset); };
  const auto draw = [](double x) { return -tangential_frequency * tangential_frequency * x; };
  double time = 0.0, step = steps(0.0), error = 0.0, size = 0.0;
  Swing at;
  at.v += 0.5 * step * pull(at.u);
  at.y += 0.5 * step * draw(at.x);
  while (time + step < end) {
    at.u += step * at.v;
    at.x += step * at.y;
    time += step;
    const Swing exact = swing_at(body, time);
    error += step * (std::abs(at.u - exact.u) + std::abs(at.x - exact.x));
    size += step * (std::abs(exact.u) + std::abs(exact.x));
    const double next = steps(time);
    node.dt = 0.5 * (step + next);
    node.position_dt = next;
    node.gap = at.u;
    node.v_previous = {at.v, at.y, 0.0};
    EXPECT_EQ(node.step({at.v + node.dt * pull(at.u), at.y + node.dt * draw(at.x), 0.0}), ILAW_OK);
    at.v = node.v[0];
    at.y = node.v[1];
    step = next;
  }
  return error / size;
}

TEST(RoughImpact, HasOrderTwoAgainstARoughStop) {
  for (const double restitution : {1.0, 0.8})
    for (const double friction : {0.02, 0.3, inf_value})
      for (const auto& set : step_sets)
        for (const double h : set)
          for (const bool varies : {false, true}) {
            const Body body{friction, restitution};
            EXPECT_LE(error_of_swing(body, varies ? varying(h) : fixed(h), 2.0), 70.0 * h * h)
                << friction << ", e " << restitution << ", h " << h;
          }
}

// ---- start of slip

// A mass on a spring on a belt of speed 0.1, as in host_mock/scenes/stick_slip.json: it sticks until 100 x =
// 5; with the kinetic friction 3 it slides about 0.03 until it has the speed of the belt again.
double stuck_and_slid(double time) {
  const double slides = 2.0 * (M_PI - std::atan(2.0)) / 10.0, sticks = 0.4;
  if (time < 0.5) return 0.1 * time;
  time = std::fmod(time - 0.5, slides + sticks);
  if (time > slides) return 0.01 + 0.1 * (time - slides);
  return 0.03 + 0.02 * std::cos(10.0 * time) + 0.01 * std::sin(10.0 * time);
}

TEST(RoughImpact, StartsToSlipAtOrderTwo) {
  for (const auto& set : step_sets)
    for (const double h : set)
      for (const bool varies : {false, true}) {
        const Steps steps = varies ? varying(h) : fixed(h);
        Parameters parameters = rough(0.5, 0.0);
        parameters.numbers["kinetic_friction"] = 0.3;
        NodeRun node("impact", parameters, h);
        double time = 0.0, step = steps(0.0), x = 0.0, v = 0.1, error = 0.0, size = 0.0;
        bool sticks = true;
        while (time < 3.0) {
          x += step * v;
          time += step;
          error += step * std::abs(x - stuck_and_slid(time));
          size += step * std::abs(stuck_and_slid(time));
          const double next = steps(time);
          node.dt = 0.5 * (step + next);
          node.position_dt = next;
          node.v_previous = {0.0, v - 0.1, 0.0};
          ASSERT_EQ(node.step({-10.0 * node.dt, v - 0.1 - 100.0 * node.dt * x, 0.0}), ILAW_OK);
          expect_in_cone(node.r, 0.5);
          EXPECT_EQ(node.named("stick_ratio") > 0.0, node.status == ILAW_STICK && sticks) << "time " << time;
          sticks = node.status == ILAW_STICK;
          v = node.v[1] + 0.1;
          step = next;
        }
        EXPECT_LE(error / size, 14.0 * h * h) << "h " << h;
      }
}

}  // namespace
}  // namespace ilaw::testing
