// The scene of rubber shows what its text says.
#include "laws/shown_scene.hpp"

namespace ilaw::host::testing {
namespace {

// m v' = F - m g mu(v, T(t)) of the scene, by Runge and Kutta's fourth order.
double speed_on_the_cooling_road(double end) {
  const auto rate = [](double t, double v) {
    const double above = 20.0 * std::clamp((4.0 - t) / 3.0, 0.0, 1.0);
    const double decades = std::log10(v / 0.1) - 8.86 * above / (101.5 + above);
    return 8.0 - 10.0 * (0.4 + 0.8 * std::exp(-decades * decades));
  };
  double v = 0.42255;
  const int steps = 4000;
  const double h = end / steps;
  for (int k = 0; k < steps; ++k) {
    const double t = k * h, a = rate(t, v), b = rate(t + 0.5 * h, v + 0.5 * h * a);
    const double c = rate(t + 0.5 * h, v + 0.5 * h * b), d = rate(t + h, v + h * c);
    v += h / 6.0 * (a + 2.0 * (b + c) + d);
  }
  return v;
}

TEST(LawScenes, RubberSlowsDownAsTheRoadCools) {
  ShownScene shown("cooling_tread.json");
  const double& speed = shown.integrator.velocity()[0];
  shown.run([&] {
    if (shown.integrator.steps() % 500 != 0) return;
    const double t = (static_cast<double>(shown.integrator.steps()) + 0.5) * shown.scene.dt;
    EXPECT_NEAR(speed / speed_on_the_cooling_road(t), 1.0, 2e-3) << t;
  });
  const std::vector<double>& amounts = shown.scene.interfaces[0]->amounts();
  const double path = shown.integrator.displacement()[0];
  EXPECT_NEAR(amounts[2], 1e-9 * 10.0 / 0.01 * path, 1e-3 * amounts[2]);
  EXPECT_NEAR(amounts[0] + amounts[1], 8.0 * path, 0.05 * 8.0 * path);
  EXPECT_NEAR(speed, 0.1 * std::pow(10.0, -std::sqrt(std::log(2.0))), 1e-12);
}

}  // namespace
}  // namespace ilaw::host::testing
