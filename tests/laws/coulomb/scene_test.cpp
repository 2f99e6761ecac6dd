// The scene of coulomb shows what its text says, and its heat is the kinetic energy.
#include "laws/shown_scene.hpp"

namespace ilaw::host::testing {
namespace {

TEST(LawScenes, CoulombStopsABlockAndHeatsIt) {
  ShownScene shown("sliding_block.json");
  const Interface& floor = *shown.scene.interfaces[0];
  double stopped = 0.0;
  shown.run([&] {
    if (stopped == 0.0 && shown.integrator.velocity()[0] == 0.0)
      stopped = static_cast<double>(shown.integrator.steps()) * shown.scene.dt;
  });
  EXPECT_NEAR(stopped, 0.5, 2e-3);
  const std::vector<double>& amounts = floor.amounts();
  ASSERT_EQ(amounts.size(), 3U);
  EXPECT_NEAR(amounts[0] + amounts[1], 0.5 * 2.0 * 2.0 * 2.0, 1e-12);
  EXPECT_NEAR(amounts[0], 2.0, 1e-12);
  EXPECT_EQ(amounts[2], 0.0);
}

}  // namespace
}  // namespace ilaw::host::testing
