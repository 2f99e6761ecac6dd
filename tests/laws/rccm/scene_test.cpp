// The scene of rccm shows what its text says.
#include "laws/shown_scene.hpp"

namespace ilaw::host::testing {
namespace {

TEST(LawScenes, RccmWeakensTwiceAndRubs) {
  ShownScene shown("rccm_cycle.json");
  const Interface& bond = *shown.scene.interfaces[0];
  double at_turn = 1.0, at_start = 1.0, after = 1.0;
  shown.run([&] {
    const double time = shown.integrator.time(), beta = bond.state(0, 0);
    if (time < 2.6) at_turn = beta;
    if (time < 3.5) at_start = beta;
    if (time < 7.0) after = beta;
  });
  EXPECT_LT(at_turn, 0.7);
  EXPECT_EQ(at_turn, at_start);  // unloaded and loaded again without loss
  EXPECT_LT(after, 0.5 * at_start);
  EXPECT_GE(shown.integrator.energy().by_law[ILAW_ENERGY_RUPTURE], 0.5 * (1.0 - after));
  EXPECT_GT(shown.integrator.energy().by_law[ILAW_ENERGY_FRICTION], 0.0);
}

}  // namespace
}  // namespace ilaw::host::testing
