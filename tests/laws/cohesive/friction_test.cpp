// The energy of rupture where friction acts beside it.
#include "laws/cohesive/bond.hpp"

namespace ilaw::testing {
namespace {

// A bond that is sheared apart under pressure: rupture takes the toughness, and friction the rest, in the
// breaking step, too.
TEST(CohesiveFriction, RuptureTakesTheToughness) {
  constexpr double speed = 0.1, pressure = 2.0, toughness = 1.5;
  for (const char* shape : {"bilinear", "exponential", "camacho_ortiz"})
    for (const double friction : {0.2, 0.8})
      for (const double step : {0.11, 0.037, 0.013}) {
        Driven bond(
            {{{"strength", 1.0}, {"toughness", toughness}, {"friction", friction}}, {{"shape", shape}}},
            step);
        for (int k = 0; bond.named("damage") < 1.0; ++k) {
          ASSERT_LT(k, 100000);
          bond.pull({-step * pressure * bond.h[0], speed, 0.0});
        }
        const std::string at =
            std::string(shape) + ", friction " + std::to_string(friction) + ", step " + std::to_string(step);
        EXPECT_NEAR(bond.parts[ILAW_ENERGY_RUPTURE] / toughness, 1.0, 1e-9) << at;
        EXPECT_NEAR(bond.work, bond.parts[0] + bond.parts[1] + bond.parts[2], 1e-9) << at;
      }
}

}  // namespace
}  // namespace ilaw::testing
