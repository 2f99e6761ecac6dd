// The scene of penalty shows what its text says.
#include "laws/shown_scene.hpp"

namespace ilaw::host::testing {
namespace {

// Dropped from 0.2 onto k = 1e4 (w = 100) with V = 2: sinks by g/w^2 (1 + sqrt(1 + (V w/g)^2)), the damped
// one by less.
TEST(LawScenes, PenaltySinksByItsClosedForm) {
  ShownScene shown("penalty_bounce.json");
  double deepest[2] = {};
  shown.run([&] {
    for (std::size_t k = 0; k < 2; ++k)
      deepest[k] = std::max(deepest[k], -shown.integrator.displacement()[k] - 0.2);
  });
  EXPECT_NEAR(deepest[0], 1e-3 * (1.0 + std::sqrt(401.0)),
              1e-4);  // closes within h V of the wall
  EXPECT_LT(deepest[1], 0.9 * deepest[0]);
}

}  // namespace
}  // namespace ilaw::host::testing
