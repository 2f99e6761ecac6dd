// The scene of template_law shows what its text says.
#include "laws/shown_scene.hpp"

namespace ilaw::host::testing {
namespace {

// Backward Euler, v' = (v - g h)/(1 + c h): after n steps g/c + v is (1 + c h)^-n of what it was.
TEST(LawScenes, template_law_TendsToTheTerminalSpeed) {
  ShownScene shown("template_law.json");
  shown.integrator.start();
  const Dofs first = shown.integrator.velocity();
  shown.run([] {});
  const auto n = static_cast<double>(shown.integrator.steps());
  for (std::size_t k = 0; k < 3; ++k) {
    const double damping[] = {1.0, 10.0, 100.0}, terminal = -10.0 / damping[k];
    const double rest = (first[k] - terminal) * std::pow(1.0 + damping[k] * shown.scene.dt, -n);
    EXPECT_NEAR(shown.integrator.velocity()[k], terminal + rest, 1e-12) << "node " << k;
    EXPECT_NEAR(shown.integrator.velocity()[k], terminal, 0.01 * -terminal) << "node " << k;
  }
}

}  // namespace
}  // namespace ilaw::host::testing
