// The scene of slip_weakening shows what its text says.
#include "laws/shown_scene.hpp"

namespace ilaw::host::testing {
namespace {

TEST(LawScenes, SlipWeakeningStopsAndBreaksAway) {
  ShownScene shown("weakening_block.json");
  const Interface& floor = *shown.scene.interfaces[0];
  double at_breakaway = -1.0;
  shown.run([&] {
    if (shown.integrator.time() < 0.7495) at_breakaway = floor.state(1, 0);
  });
  EXPECT_NEAR(floor.state(0, 0), 0.9, 2e-3);
  EXPECT_NEAR(at_breakaway, 0.0, 1e-15);
  EXPECT_GT(floor.state(1, 0), 0.1);
}

}  // namespace
}  // namespace ilaw::host::testing
