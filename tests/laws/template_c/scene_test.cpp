// The scene of template_c shows what its text says: a law in plain C with a field, amounts and a table over
// slip speed and temperature in the program. The same scene from Python and Fortran: tests/hosts.
#include "brake_reference.hpp"

#include "laws/shown_scene.hpp"

namespace ilaw::host::testing {
namespace {

// Each block loses mu(v, T) g h per step, solved within the step; the first has half a step of weight more,
// as the motion starts with V_1/2 = V_0 + (h/2) g.
TEST(LawScenes, template_c_BrakesByTheBisection) {
  constexpr ilaw::testing::FrictionTable mu{
      {0.0, 1.0, 4.0}, {273.15, 673.15}, {{{0.6, 0.4}, {0.4, 0.25}, {0.3, 0.2}}}};
  constexpr double temperatures[] = {293.15, 593.15}, g = 10.0;
  ShownScene shown("template_c.json");
  double v[] = {4.0, 4.0}, stopped[] = {0.0, 0.0};
  shown.run([&] {
    const double h = shown.scene.dt, r_N = g * h * (shown.integrator.steps() == 1 ? 1.5 : 1.0);
    for (std::size_t k = 0; k < 2; ++k) {
      v[k] = ilaw::testing::slip_after(mu, temperatures[k], 1.0, r_N, v[k]);
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
