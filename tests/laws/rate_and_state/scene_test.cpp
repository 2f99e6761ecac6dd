// The scene of rate_and_state shows what its text says.
#include "laws/shown_scene.hpp"

namespace ilaw::host::testing {
namespace {

TEST(LawScenes, RateAndStateCreepsAtItsSteadySpeeds) {
  ShownScene shown("creeping_blocks.json");
  const Interface& floor = *shown.scene.interfaces[0];
  shown.run([] {});
  EXPECT_NEAR(floor.state(0, 0), 0.005 / 0.02, 1e-6);
  EXPECT_NEAR(floor.state(1, 0), 0.005 / 0.005, 1e-4);  // e^(-(1 - b/a) v t/D_c) is left
}

}  // namespace
}  // namespace ilaw::host::testing
