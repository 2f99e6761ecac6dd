// The scene of conductance shows what its text says.
#include "laws/shown_scene.hpp"

namespace ilaw::host::testing {
namespace {

TEST(LawScenes, ConductanceHeatsADroppedBlock) {
  ShownScene shown("dropped_block.json");
  shown.run([] {});
  EXPECT_NEAR(shown.integrator.velocity()[0], 0.0, 1e-15);
  const double bounces = 15.0;  // each conducts for one step
  EXPECT_NEAR(shown.scene.interfaces[0]->amounts()[0], 850.0, bounces * shown.scene.dt * 2000.0);
}

}  // namespace
}  // namespace ilaw::host::testing
