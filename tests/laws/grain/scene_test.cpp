// The scene of grain shows what its text says.
#include "laws/shown_scene.hpp"

namespace ilaw::host::testing {
namespace {

TEST(LawScenes, SlowGrainsStickAndFastOnesLeave) {
  ShownScene shown("sticking_grains.json");
  const Interface& plane = *shown.scene.interfaces[0];
  shown.run([] {});
  const double sticking = 0.0116383;
  for (int k = 0; k < 6; ++k) {
    const double thrown = shown.scene.source["model"]["points"][static_cast<std::size_t>(k)]["velocity"][1];
    if (k < 3)
      EXPECT_NE(plane.state(k, 0), 0.0) << k;
    else
      EXPECT_NEAR(shown.integrator.velocity()[2 * k + 1], std::sqrt(thrown * thrown - sticking * sticking),
                  1e-5);
  }
}

}  // namespace
}  // namespace ilaw::host::testing
