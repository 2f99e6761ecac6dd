// Ruptures in coupled contacts: a bond that broke at a solution stays broken in its step, whatever its
// neighbors then carry, and what broke depends on no order of contacts.
// SPDX-License-Identifier: BSD-3-Clause
#include "coupled_scene.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <string>
#include <vector>

namespace {

using namespace coupled_scene;

constexpr int hanging_count = 20;
constexpr double sphere_mass = 2.0, per_step = 1e-3;

// Spheres that hang from a ceiling one below the other, in a gravity that grows by a thousandth a step: bond
// k carries those from k on.
Scene hanging(ilaw::interface law, unsigned seed) {
  std::vector<int> order(hanging_count);
  std::iota(order.begin(), order.end(), 0);
  if (seed > 0) std::shuffle(order.begin(), order.end(), std::mt19937(seed));
  Scene scene(std::move(law), hanging_count);
  for (const int k : order) scene.add(k, k - 1, 0.0, {0.0, 0.0, -1.0});
  scene.initialise();
  return scene;
}

double gravity_of(int step) { return g * (1.0 + per_step * step); }

struct Rupture {
  int step = -1;
  std::vector<std::int32_t> bodies;  // below the bonds that broke
};

// Runs until a bond breaks; all that hangs below it has fallen freely in that step.
Rupture first_rupture(Scene& scene) {
  std::vector<ilaw_status> status(scene.body.size());
  for (int n = 0; n < 200; ++n) {
    scene.v_before = scene.v;
    scene.w_before = scene.w;
    scene.time += h;
    for (std::size_t i = 2; i < scene.v.size(); i += 3) scene.v[i] -= h * gravity_of(n);
    ilaw_batch batch = scene.batch();
    batch.status = status.data();
    batch.status_stride = 1;
    ilaw_coupled_options options{};
    options.tolerance = 1e-12;
    const ilaw_coupled_report report = scene.solver.solve(scene.bodies(), scene.contacts(batch), options);
    EXPECT_EQ(report.message, nullptr) << "step " << n << ": " << report.message;
    Rupture found{n, {}};
    for (std::size_t k = 0; k < status.size(); ++k)
      if (status[k] == ILAW_BROKEN) found.bodies.push_back(scene.body[k]);
    if (!found.bodies.empty()) return found;
  }
  return {};
}

class Ruptures : public ::testing::TestWithParam<const char*> {
 protected:
  // A bond that carries this impulse.
  static ilaw::interface bond(double impulse) {
    if (std::string(GetParam()) == "tie") return create("tie", ILAW_DELASSUS_FULL, {{"strength", impulse}});
    return create("postit", ILAW_DELASSUS_FULL, {{"adhesion_limit", impulse}, {"initial_adhesion", impulse}});
  }
};

// The bond at the ceiling carries the most and breaks alone, at the step in which the weight of all exceeds
// it.
TEST_P(Ruptures, HappenAtTheStepOfStaticsInAnyOrder) {
  constexpr int expected = 61;
  const double impulse =
      hanging_count * sphere_mass * h * 0.5 * (gravity_of(expected - 1) + gravity_of(expected));
  for (const unsigned seed : {0U, 1U, 2U, 3U, 4U}) {
    Scene scene = hanging(bond(impulse), seed);
    const Rupture rupture = first_rupture(scene);
    ASSERT_EQ(rupture.step, expected) << "order " << seed;
    ASSERT_EQ(rupture.bodies, std::vector<std::int32_t>{0}) << "order " << seed;
    for (std::size_t b = 0; b < hanging_count; ++b)
      ASSERT_NEAR(scene.v[3 * b + 2], -h * gravity_of(expected), 1e-11) << "order " << seed << ", body " << b;
  }
}

// Bonds of one strength between spheres without weight, pulled at the end: all carry the same, and break
// together.
TEST_P(Ruptures, OfEqualLoadsHappenTogether) {
  for (const unsigned seed : {0U, 1U, 2U}) {
    Scene scene = hanging(bond(1.0), seed);
    scene.v[3 * (hanging_count - 1) + 2] = -1.01 * scene.inverse_mass;
    std::vector<ilaw_status> status(scene.body.size());
    ilaw_batch batch = scene.batch();
    batch.status = status.data();
    batch.status_stride = 1;
    ilaw_coupled_options options{};
    options.tolerance = 1e-12;
    scene.solver.solve(scene.bodies(), scene.contacts(batch), options);
    EXPECT_EQ(std::count(status.begin(), status.end(), ILAW_BROKEN), hanging_count) << "order " << seed;
    for (const double r : scene.impulse) EXPECT_NEAR(r, 0.0, 1e-12);
  }
}

// Two bonds hold one sphere, neither of which could alone: however iterations shared its weight, it falls.
TEST_P(Ruptures, ShedTheirLoadOnOthersInTheSameStep) {
  const double weight = sphere_mass * h * g;
  for (const double stronger : {0.2, 0.8}) {
    Scene scene(bond(stronger * weight), 1);
    for (int k = 0; k < 2; ++k) scene.add(0, -1, 0.0, {0.0, 0.0, -1.0});
    scene.initialise();
    std::fill_n(scene.impulse.begin() + 3, 3, 0.0);
    scene.impulse[2] = -weight;  // all of it at the first one
    scene.step(g, 1e-12);
    EXPECT_NEAR(scene.v[2], -h * g, 1e-15) << stronger;
  }
}

INSTANTIATE_TEST_SUITE_P(Of, Ruptures, ::testing::Values("tie", "postit"),
                         [](const auto& of) { return std::string(of.param); });

}  // namespace
