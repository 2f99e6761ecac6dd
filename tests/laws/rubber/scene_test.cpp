// The scene of rubber shows what its text says.
#include "laws/shown_scene.hpp"

#include <cmath>

namespace ilaw::host::testing {
namespace {

TEST(LawScenes, RubberCreepsFasterWhenWarm) {
  ShownScene shown("creeping_rubber.json");
  shown.run([] {});
  const double cold = 0.1 * std::pow(10.0, -std::sqrt(std::log(2.0)));
  EXPECT_NEAR(shown.integrator.velocity()[0], cold, 1e-12);
  EXPECT_NEAR(shown.integrator.velocity()[2], cold * std::pow(10.0, 8.86 * 20.0 / 121.5), 1e-9);
}

}  // namespace
}  // namespace ilaw::host::testing
