// The scene of cohesive shows what its text says.
#include "laws/shown_scene.hpp"

namespace ilaw::host::testing {
namespace {

// Up to the middle of the softening, back along the secant, and through: broken at 2 G/sigma, with G A
// dissipated.
TEST(LawScenes, CohesiveUnloadsAndTakesItsToughness) {
  ShownScene shown("cohesive_pull.json");
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
