// A law in a velocity-Verlet code that has nothing but a nodal-force hook, against the scheme laws are
// written for (central differences with velocities at half steps): the same half-step velocities, also at
// variable steps.
// SPDX-License-Identifier: BSD-3-Clause
#include "support/law_runner.hpp"

#include <ilaw/arrays.hpp>

#include <stdexcept>

namespace ilaw::testing {
namespace {

using vector = Vector;

constexpr double mass = 1.7, stiffness = 40.0;
constexpr vector gravity{-10.0, 0.0, 0.0}, start{0.2, 0.0, 0.1}, start_velocity{-0.5, 2.0, -1.0};
constexpr int steps = 4000;

double step_length(int n) { return 1e-3 * (1.0 + 0.4 * std::sin(n)); }

ilaw::interface coulomb_with_restitution() {
  return make_law("coulomb", SetupBuilder({{{"friction", 0.3}, {"restitution", 0.5}}, {}}));
}

vector impulse_of(const ilaw::interface& interface, const vector& v_free, const vector& v_previous,
                  double gap, double time, double velocity_step, double position_step) {
  const double inverse_mass = 1.0 / mass;
  vector r;
  ilaw_batch batch{};
  batch.struct_size = sizeof batch;
  batch.node_count = 1;
  batch.time = time;
  batch.velocity_step = velocity_step;
  batch.position_step = position_step;
  batch.v_free = ilaw::input(v_free.data(), 3, 1);
  batch.v_previous = ilaw::input(v_previous.data(), 3, 1);
  batch.delassus = ilaw::input(&inverse_mass, 1, 1);
  batch.gap = ilaw::input(&gap, 1, 1);
  batch.impulse = ilaw::output(r.data(), 3, 1);
  if (interface.evaluate(batch) != ILAW_OK) throw std::runtime_error("evaluate refused");
  return r;
}

// A block on a spring over a floor: it falls, bounces, slides and is dragged back.
vector force_at(const vector& u) {
  return {mass * gravity[0], mass * gravity[1] - stiffness * u[1], mass * gravity[2] - stiffness * u[2]};
}

void advance(vector& a, double factor, const vector& b) {
  for (std::size_t c = 0; c < 3; ++c) a[c] += factor * b[c];
}

// Central differences as in docs/abi.md; gives all half-step velocities.
std::vector<vector> central_differences() {
  const ilaw::interface interface = coulomb_with_restitution();
  std::vector<vector> velocities;
  vector u = start, v = start_velocity;
  double time = 0.0;
  advance(v, step_length(0) / (2 * mass), force_at(u));
  for (int n = 0; n < steps; ++n) {
    velocities.push_back(v);
    const double position_step = step_length(n + 1),
                 velocity_step = (step_length(n) + step_length(n + 1)) / 2;
    time += step_length(n);
    advance(u, step_length(n), v);
    vector v_free = v;
    advance(v_free, velocity_step / mass, force_at(u));
    const vector r = impulse_of(interface, v_free, v, u[0], time, velocity_step, position_step);
    v = v_free;
    advance(v, 1.0 / mass, r);
  }
  return velocities;
}

// Called when all other forces of step n are summed; v is still the half-step velocity. Adds the law's force.
void force_hook(const ilaw::interface& interface, int n, double time, const vector& u, const vector& v,
                vector& f) {
  const double velocity_step = (step_length(n) + step_length(n + 1)) / 2;  // this and the next half kick
  vector v_free = v;
  advance(v_free, velocity_step / mass, f);
  const vector r = impulse_of(interface, v_free, v, u[0], time, velocity_step, step_length(n + 1));
  advance(f, 1.0 / velocity_step, r);
}

std::vector<vector> velocity_verlet() {
  const ilaw::interface interface = coulomb_with_restitution();
  std::vector<vector> velocities;
  vector u = start, v = start_velocity, f = force_at(u);
  double time = 0.0;
  for (int n = 0; n < steps; ++n) {
    advance(v, step_length(n) / (2 * mass), f);
    velocities.push_back(v);
    time += step_length(n);
    advance(u, step_length(n), v);
    f = force_at(u);
    force_hook(interface, n, time, u, v, f);
    advance(v, step_length(n) / (2 * mass), f);
  }
  return velocities;
}

TEST(Adaptor, ForceHookInVelocityVerletIsTheSchemeItself) {
  const std::vector<vector> expected = central_differences(), found = velocity_verlet();
  double largest = 0.0;
  for (int n = 0; n < steps; ++n)
    for (std::size_t c = 0; c < 3; ++c)
      largest = std::max(largest, std::abs(expected[static_cast<std::size_t>(n)][c] -
                                           found[static_cast<std::size_t>(n)][c]));
  EXPECT_LE(largest,
            1e-12);  // rounding of four thousand steps (3e-15 seen); a wrong step length gives 1
}

TEST(Adaptor, TheCaseBouncesSlidesAndComesToRest) {
  const std::vector<vector> velocities = central_differences();
  int bounces = 0;
  for (std::size_t n = 1; n < velocities.size(); ++n)
    bounces += velocities[n - 1][0] < 0.0 && velocities[n][0] > 0.0;
  EXPECT_GE(bounces, 4);
  EXPECT_LE(std::abs(velocities.back()[0]), 1e-2);
  EXPECT_EQ(velocities.back()[1], 0.0);
}

}  // namespace
}  // namespace ilaw::testing
