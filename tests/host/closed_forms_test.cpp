// Shipped scenes with closed forms: an impact oscillator, stick-slip, a peeled double cantilever and a bond
// in mixed mode.
#include "host_runner.hpp"

namespace ilaw::host::testing {
namespace {

Scene shipped(const char* name, double dt = 0.0) {
  setenv("ILAW_PATH", ILAW_PLUGIN_FOLDER, 1);
  const std::filesystem::path file = scene_files::named(name);
  nlohmann::json source = read_scene_source(file);
  if (dt > 0.0) source["time"]["dt"] = dt;
  return read_scene(source, file);
}

struct Event {
  double time, speed;
};

// Mean difference of two lists of events, in time or in speed, whichever is larger; infinite when they differ
// in number.
double distance(const std::vector<Event>& found, const std::vector<Event>& exact) {
  if (found.size() != exact.size()) return std::numeric_limits<double>::infinity();
  double time = 0.0, speed = 0.0;
  for (std::size_t k = 0; k < found.size(); ++k) {
    time += std::abs(found[k].time - exact[k].time);
    speed += std::abs(found[k].speed - exact[k].speed);
  }
  return std::max(time, speed) / static_cast<double>(found.size());
}

// Over nine halvings, from a step that is no divisor of any instant: error <= bound h, of order one.
void expect_first_order(const char* scene, double bound, std::vector<Event> (*events)(Scene&),
                        const std::vector<Event>& exact) {
  std::vector<double> steps, errors;
  for (double h = 0.0073; h > 1e-5; h /= 2.0) {
    Scene run = shipped(scene, h);
    const double error = distance(events(run), exact);
    EXPECT_LE(error, bound * h) << scene << ", h = " << h;
    steps.push_back(h);
    errors.push_back(error);
  }
  EXPECT_GE(order(steps, errors), 0.9) << scene;
}

// ---- impact oscillator ----
// u = -sin(10 t)/10 meets -d = -0.05 at 10 t = pi/6 with the speed cos(pi/6). It leaves with w, 0.8 of what
// it came with, and -d cos s + (w/10) sin s = -d brings it back with w at s = 10 t = 2 (pi - atan(w/(10 d))).
std::vector<Event> exact_impacts() {
  std::vector<Event> impacts;
  double time = M_PI / 60.0, speed = 0.8 * std::cos(M_PI / 6.0);
  for (; time < 2.0; speed *= 0.8) {
    impacts.push_back({time, speed});
    time += 2.0 * (M_PI - std::atan(speed / 0.5)) / 10.0;
  }
  return impacts;
}

std::vector<Event> impacts(Scene& scene) {
  std::vector<Event> found;
  Integrator integrator = integrator_of(scene);
  while (integrator.steps() < scene.steps) {
    integrator.step();
    if (integrator.interface_impulse()[0] > 0.0)
      found.push_back({integrator.time(), integrator.velocity()[0]});
  }
  return found;
}

// A step may be one late (C = 1) and come with the spring's change of speed, of at most 10 d h = 5 h: C = 6.
TEST(ImpactOscillator, ImpactsAtExactInstantsWithExactSpeeds) {
  ASSERT_EQ(exact_impacts().size(), 5U);
  expect_first_order("impact_oscillator.json", 6.0, impacts, exact_impacts());
}

// ---- stick-slip ----
// Sticks to the belt of speed 0.1 until 100 x = 5. Kinetic friction is 3: then x = 0.03 + 0.02 cos s + 0.01
// sin s, s = 10 t, which has the speed of the belt again at s = 2 (pi - atan 2), where x = 0.01.
std::vector<Event> exact_turns() {
  const double slip = 2.0 * (M_PI - std::atan(2.0)) / 10.0, stick = 0.4;
  std::vector<Event> turns;
  double time = 0.5;
  for (bool slips = true; time < 3.0; slips = !slips) {
    turns.push_back({time, 0.0});
    time += slips ? slip : stick;
  }
  return turns;
}

std::vector<Event> turns(Scene& scene) {
  std::vector<Event> found;
  Integrator integrator = integrator_of(scene);
  bool sticks = true;
  while (integrator.steps() < scene.steps) {
    integrator.step();
    const bool at_rest_on_belt = std::abs(integrator.velocity()[0] - 0.1) <= 1e-12;
    if (at_rest_on_belt != sticks) found.push_back({integrator.time(), 0.0});
    sticks = at_rest_on_belt;
  }
  return found;
}

// Each of the seven turns is found up to about two steps late, on top of those before it: C = 8 for their
// mean.
TEST(StickSlip, TurnsAtExactInstants) {
  ASSERT_EQ(exact_turns().size(), 7U);
  expect_first_order("stick_slip.json", 8.0, turns, exact_turns());
}

// ---- double cantilever ----
// The half beam of thickness t lifted by w is open over a = (3 E t^3 w^2/(8 G))^(1/4) - 0.605 t: beam theory,
// with the correction for the root's rotation of Williams (1989), chi = 0.605 for an isotropic beam of nu =
// 0. What was broken, over toughness and width, is the crack's length.
TEST(DoubleCantilever, OpensAsBeamTheorySays) {
  Scene scene = shipped("dcb_peel.json");
  Integrator integrator = integrator_of(scene);
  while (integrator.steps() < scene.steps) integrator.step();
  const double t = 0.05, w = 0.01, toughness = 5e-8, width = 0.0125;
  const double crack = std::pow(3.0 * t * t * t * w * w / (8.0 * toughness), 0.25) - 0.605 * t;
  const double opened = integrator.energy().by_law[ILAW_ENERGY_RUPTURE] / (toughness * width);
  EXPECT_NEAR(opened, crack, 0.02 * crack);
}

// ---- mixed mode ----
// Pulled along x off a plane at 30 degrees, the opening has the share of shear B = 1/4: toughness G = 2e-6 +
// 6e-6 B^2 and strength^2 = 1e-6 + 3e-6 B^2 (Benzeggagh-Kenane, exponent 2). The bar of E = L = 1 loads to
// the strength s; then s' = s (w - u)/(w - s) falls to 0 at u = w = 2 G/s.
TEST(MixedModeBar, SoftensAndBreaksAsMixedTractionSays) {
  const double area = 0.01, toughness = 2e-6 + 6e-6 / 16.0, strength = std::sqrt(1e-6 + 3e-6 / 16.0);
  const double w = 2.0 * toughness / strength;
  Scene scene = shipped("mixed_mode_bar.json");
  Integrator integrator = integrator_of(scene);
  double largest = 0.0;
  while (integrator.steps() < scene.steps) {
    integrator.step();
    const Dofs impulse = integrator.interface_impulse();
    double force = 0.0;
    for (Eigen::Index k = 0; k < impulse.size(); k += 3) force -= impulse[k] / scene.dt;
    const double u = 1e-5 * integrator.time();
    const double exact = u < strength ? u : std::max(0.0, strength * (w - u) / (w - strength));
    largest = std::max(largest, std::abs(force / area - exact));
  }
  EXPECT_LE(largest, 0.01 * strength);
  EXPECT_NEAR(integrator.energy().by_law[ILAW_ENERGY_RUPTURE], toughness * area, 1e-12 * toughness * area);
}

}  // namespace
}  // namespace ilaw::host::testing
