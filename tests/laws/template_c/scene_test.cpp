// The scene of template_c shows what its text says: a law in plain C with a field, amounts and a table over
// slip speed and temperature in the program. The same scene from Python and Fortran: tests/hosts.
#include "brake_reference.hpp"

#include "laws/shown_scene.hpp"

namespace ilaw::host::testing {
namespace {

// Each block loses mu(v, T) g h per step, solved within the step, and half of that at the start of the
// motion.
TEST(LawScenes, template_c_BrakesByTheBisection) {
  constexpr ilaw::testing::FrictionTable mu{
      {0.0, 1.0, 4.0}, {273.15, 673.15}, {{{0.6, 0.4}, {0.4, 0.25}, {0.3, 0.2}}}};
  constexpr double temperatures[] = {293.15, 593.15}, g = 10.0;
  ShownScene shown("template_c.json");
  const double h = shown.scene.dt;
  double v[2], stopped[] = {0.0, 0.0};
  for (std::size_t k = 0; k < 2; ++k)
    v[k] = ilaw::testing::slip_after(mu, temperatures[k], 1.0, 0.5 * g * h, 4.0);
  shown.run([&] {
    for (std::size_t k = 0; k < 2; ++k) {
      v[k] = ilaw::testing::slip_after(mu, temperatures[k], 1.0, g * h, v[k]);
      ASSERT_NEAR(shown.integrator.velocity()[2 * k], v[k], 1e-12)
          << "node " << k << ", step " << shown.integrator.steps();
      if (v[k] == 0.0 && stopped[k] == 0.0) stopped[k] = static_cast<double>(shown.integrator.steps()) * h;
    }
  });
  EXPECT_GT(stopped[0], 0.5);
  EXPECT_GT(stopped[1], 1.2 * stopped[0]);
  EXPECT_LT(stopped[1], shown.scene.dt * static_cast<double>(shown.scene.steps));
}

}  // namespace
}  // namespace ilaw::host::testing
