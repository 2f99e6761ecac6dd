// The scene of table_friction shows what its text says.
#include "laws/shown_scene.hpp"

namespace ilaw::host::testing {
namespace {

TEST(LawScenes, TableFrictionStopsBlocksByItsTable) {
  ShownScene shown("braked_blocks.json");
  double stopped[3] = {};
  shown.run([&] {
    for (std::size_t k = 0; k < 3; ++k)
      if (stopped[k] == 0.0 && shown.integrator.velocity()[2 * k] == 0.0)
        stopped[k] = static_cast<double>(shown.integrator.steps()) * shown.scene.dt;
  });
  EXPECT_NEAR(stopped[0], std::log(3.0), 3e-3);
  EXPECT_NEAR(stopped[1], 2.0 * std::log(3.0), 3e-3);
  EXPECT_NEAR(stopped[2], std::log(3.0) / 1.6, 3e-3);
}

}  // namespace
}  // namespace ilaw::host::testing
