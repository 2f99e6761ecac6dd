// The scenes that draw the figures of the laws' pages show what their text says.
#include "host/host_runner.hpp"

#include <algorithm>

namespace ilaw::host::testing {
namespace {

struct Shown {
  explicit Shown(const char* name)
      : scene((setenv("ILAW_PATH", ILAW_PLUGIN_FOLDER, 1), read_scene(scene_files::named(name)))),
        integrator(integrator_of(scene)) {}

  template <class Look>
  void run(Look look) {
    while (integrator.steps() < scene.steps) {
      integrator.step();
      look();
    }
  }

  Scene scene;
  Integrator integrator;
};

// A pull of 3.9 puts 0.39 into the memory of 0.1; one of 8 reaches 0.4 after 0.05.
TEST(LawScenes, TieBreaksWhenItsMemoryIsFull) {
  Shown shown("tie_rupture.json");
  const Interface& tie = *shown.scene.interfaces[0];
  double broke = 0.0;
  shown.run([&] {
    if (broke == 0.0 && tie.state(0, 0) == 1.0) broke = shown.integrator.time();
  });
  EXPECT_NEAR(broke, 0.75, 1.01e-3);
}

// Dropped from 0.2 onto k = 1e4 (w = 100) with V = 2: sinks by g/w^2 (1 + sqrt(1 + (V w/g)^2)), the damped
// one by less.
TEST(LawScenes, PenaltySinksByItsClosedForm) {
  Shown shown("penalty_bounce.json");
  double deepest[2] = {};
  shown.run([&] {
    for (std::size_t k = 0; k < 2; ++k)
      deepest[k] = std::max(deepest[k], -shown.integrator.displacement()[k] - 0.2);
  });
  EXPECT_NEAR(deepest[0], 1e-3 * (1.0 + std::sqrt(401.0)), 1e-4);  // closes within h V of the wall
  EXPECT_LT(deepest[1], 0.9 * deepest[0]);
}

// Up to the middle of the softening, back along the secant, and through: broken at 2 G/sigma, with G A
// dissipated.
TEST(LawScenes, CohesiveUnloadsAndTakesItsToughness) {
  Shown shown("cohesive_pull.json");
  const Interface& bond = *shown.scene.interfaces[0];
  double opening = 0.0, at_turn = 0.0, after_turn = 0.0;
  shown.run([&] {
    const double damage = bond.state(0, 0);
    if (damage < 1.0) opening = std::max(opening, bond.state(0, 4));
    if (shown.integrator.time() < 2.5) at_turn = damage;
    if (shown.integrator.time() < 4.0) after_turn = damage;
  });
  EXPECT_NEAR(at_turn, 0.5, 0.02);  // the damper drags behind
  EXPECT_EQ(at_turn, after_turn);
  EXPECT_NEAR(opening, 0.1, 1e-4);
  EXPECT_NEAR(shown.integrator.energy().by_law[ILAW_ENERGY_RUPTURE], 0.5, 1e-9);
}

}  // namespace
}  // namespace ilaw::host::testing
