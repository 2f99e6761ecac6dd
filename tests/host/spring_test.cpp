// The rotating spring: large rotations, a central force, a stop.
#include "host_runner.hpp"

namespace ilaw::host::testing {
namespace {

std::string spring(double dt, double end, const std::string& interfaces) {
  char times[80];
  std::snprintf(times, sizeof times, R"({"dt": %.17g, "end": %.17g})", dt, end);
  return R"({"model": {"type": "rotating_spring", "mass": 1.0, "stiffness": 100.0, "length": 1.0,
             "position": [1.2, 0.0], "velocity": [0.0, 3.0]}, "time": )" +
         std::string(times) + R"(, "interfaces": [)" + interfaces + "]}";
}

// x_{n+1} x v_{n+3/2} = x_{n+1} x v_{n+1/2} + (h/m) x_{n+1} x f(x_{n+1}) = x_n x v_{n+1/2}: a central force
// and x_{n+1} = x_n + h v keep it. Each step rounds x, f and v, by a few 1e-16 of angular momentum each, at
// random: a walk of 1e6 steps goes some 1e-13, a bias of one rounding per step would go 1e-10.
TEST(RotatingSpring, KeepsItsAngularMomentumToRounding) {
  auto [scene, integrator] = simulation_of(spring(1e-3, 1000.0, ""));
  const double start = integrator.angular_momentum()[0];
  EXPECT_NEAR(start, 3.6, 1e-12);  // the first half step's force is central as well
  double drift = 0.0;
  while (integrator.steps() < scene.steps) {
    integrator.step();
    drift = std::max(drift, std::abs(integrator.angular_momentum()[0] / start - 1.0));
  }
  EXPECT_EQ(integrator.steps(), 1000000);
  EXPECT_LE(drift, 1e-11);
  EXPECT_LE(integrator.energy().balance_error, 1e-10);
}

// Along itself it is an oscillator, which central differences bear up to h = 2 sqrt(m/k).
TEST(RotatingSpring, DivergesBeyondItsCriticalStepOnly) {
  for (const double part : {0.9, 1.3}) {
    std::string text = spring(0.1, 20.0, "");
    text.replace(text.find("[0.0, 3.0]"), 10, "[0.0, 0.0]");
    Scene scene = scene_of(text);
    EXPECT_NEAR(scene.model->critical_step(), 0.2, 1e-15) << "part " << part;
    host::Integrator integrator(*scene.model, scene.loads, scene.interfaces, part * 0.2);
    const auto run = [&] {
      while (integrator.steps() < 60) integrator.step();
    };
    if (part > 1.0) {
      EXPECT_THROW(run(), Diverged);
    } else {
      EXPECT_NO_THROW(run());
    }
  }
}

}  // namespace
}  // namespace ilaw::host::testing
