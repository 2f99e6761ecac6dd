// The energy of rupture where friction acts beside it.
#include "laws/cohesive/bond.hpp"

namespace ilaw::testing {
namespace {

// A mass under the force F and the pressure p on a rigid bilinear bond has w'' = (F - sigma)/m + a w with
// a = (sigma - mu p)/(m w_f) until it breaks, and (F - mu p)/m after that. Friction has the mean damage of
// the step, so that the place of the mass and the work of friction are of second order.
TEST(CohesiveFriction, IsOfSecondOrderWhileTheBondSoftens) {
  constexpr double force = 3.0, strength = 1.0, toughness = 1.5, end = 2.2;
  constexpr double longest = 2.0 * toughness / strength;  // w_f
  for (const double pressure : {1.0, 2.0})
    for (const double friction : {0.2, 0.4}) {
      const double drive = force - strength, root = std::sqrt((strength - friction * pressure) / longest);
      const double broken = std::acosh(1.0 + root * root * longest / drive) / root;
      const double speed = drive / root * std::sinh(root * broken), left = force - friction * pressure;
      std::vector<double> errors;
      const std::vector<double> steps{0.013, 0.0037, 0.0011};
      for (const double step : steps) {
        Hung mass({{{"strength", strength}, {"toughness", toughness}, {"friction", friction}}, {}}, step);
        int k = 0;
        for (; k * step < end; ++k) mass.push({-pressure, force, 0.0});
        const double time = k * step - broken, slip = mass.position[1] + 0.5 * step * mass.v[1];
        const double exact = longest + speed * time + 0.5 * left * time * time;
        errors.push_back(std::abs(slip / exact - 1.0));
        const double worked = friction * pressure * (slip - 0.5 * longest);
        const std::string at = "pressure " + std::to_string(pressure) + ", friction " +
                               std::to_string(friction) + ", step " + std::to_string(step);
        EXPECT_NEAR(mass.parts[ILAW_ENERGY_RUPTURE] / toughness, 1.0, 1e-9) << at;
        EXPECT_NEAR(mass.parts[ILAW_ENERGY_FRICTION] / worked, 1.0, 0.5 * step * step) << at;
        EXPECT_LE(errors.back(), 0.1 * step * step) << at;
      }
      const double order = std::log(errors.front() / errors.back()) / std::log(steps.front() / steps.back());
      EXPECT_GT(order, 1.8) << "pressure " << pressure << ", friction " << friction;
    }
}

}  // namespace
}  // namespace ilaw::testing
