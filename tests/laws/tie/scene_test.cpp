// The scene of tie shows what its text says.
#include "laws/shown_scene.hpp"

namespace ilaw::host::testing {
namespace {

// A pull of 3.9 puts 0.39 into the memory of 0.1; one of 8 reaches 0.4 after 0.05.
TEST(LawScenes, TieBreaksWhenItsMemoryIsFull) {
  ShownScene shown("tie_rupture.json");
  const Interface& tie = *shown.scene.interfaces[0];
  double broke = 0.0;
  shown.run([&] {
    if (broke == 0.0 && tie.state(0, 0) == 1.0) broke = shown.integrator.time();
  });
  EXPECT_NEAR(broke, 0.75, 1.01e-3);
}

}  // namespace
}  // namespace ilaw::host::testing
