// Shipped scenes with closed forms: an impact oscillator, stick-slip, a bond in
// mixed mode, a landing gear, a seal and a rolling wheel.
#include "run_result.hpp"

namespace ilaw::host::testing::closed_forms {
namespace {

Scene scene_with_step(const char* name, double dt) {
  json source = shipped(name);
  source["time"]["dt"] = dt;
  return scene_of(source);
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
    Scene run = scene_with_step(scene, h);
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
  expect_first_order("impact_oscillator", 6.0, impacts, exact_impacts());
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
  expect_first_order("stick_slip", 8.0, turns, exact_turns());
}

// ---- mixed mode ----
// Pulled along x off a plane at 30 degrees, the opening has the share of shear B = 1/4: toughness G = 2e-6 +
// 6e-6 B^2 and strength^2 = 1e-6 + 3e-6 B^2 (Benzeggagh-Kenane, exponent 2). The bar of E = L = 1 loads to
// the strength s; then s' = s (w - u)/(w - s) falls to 0 at u = w = 2 G/s.
TEST(MixedModeBar, SoftensAndBreaksAsMixedTractionSays) {
  const double area = 0.01, toughness = 2e-6 + 6e-6 / 16.0, strength = std::sqrt(1e-6 + 3e-6 / 16.0);
  const double w = 2.0 * toughness / strength;
  auto [scene, integrator] = simulation_of(shipped("mixed_mode_bar"));
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
}

// ---- landing gear ----
// A mass m on a strut lands at w = 2: its strut shortens by s with m s'' = m g - k s - c s' from s
// = 0, s' = w, omega = 10 with half the critical damping.
struct Strut {
  double s, speed;
};
Strut exact_strut(double t) {
  const double omega = 10.0, zeta = 0.5, turning = omega * std::sqrt(1.0 - zeta * zeta), rest = 0.1;
  const double b = (2.0 - zeta * omega * rest) / turning;
  const double cosine = std::cos(turning * t), sine = std::sin(turning * t),
               fade = std::exp(-zeta * omega * t);
  const double swing = b * sine - rest * cosine;
  return {rest + fade * swing, fade * (turning * (b * cosine + rest * sine) - zeta * omega * swing)};
}

// It lands up to a step late, with the speed 2 and the slowing down 20: s is late by 2 h, the force
// by k 2 h + c 20 h. While the foot stands, the floor carries it and what the strut does to the
// mass.
TEST(LandingGear, SwingsAsADampedOscillatorOnAFootThatStands) {
  for (const double h : {1e-3, 7.3e-4, 1.1e-4}) {
    json source = shipped("landing_gear");
    source["time"]["dt"] = h;
    source["output"]["every"] = 1;
    const Ran run = ran(source);
    const auto at = [&](const char* column, std::size_t k) { return run[column][k]; };
    double largest = 0.0;
    for (std::size_t k = 0; k < run.rows(); ++k) {
      const double t = at("time", k) - 0.2;
      const std::string where = "h " + number(h) + ", time " + number(t + 0.2);
      if (t < 2.0 * h) continue;
      const Strut exact = exact_strut(t);
      ASSERT_NEAR(at("n0.u0", k) - at("n1.u0", k), exact.s, 2.0 * h) << where;
      ASSERT_NEAR(at("strut.F0", k), 1e4 * exact.s + 1e3 * exact.speed, 4e4 * h) << where;
      ASSERT_NEAR(at("floor.F0", k), at("strut.F0", k) + 50.0, 1e-9) << where;
      largest = std::max(largest, at("floor.F0", k));
    }
    EXPECT_NEAR(largest, 2330.0, 4e4 * h + 1.0) << h;
    EXPECT_NEAR(run.last("floor.F0"), 1050.0, 1e3 * 1.2 * std::exp(-5.0) + 4e4 * h) << "h " << h;
  }
}

// ---- seal ----
// ---- rolling wheel ----
// The brush model (Pacejka 2012, ch. 3): over a patch of half length a = sqrt(2 R d) bristles are
// pressed by k xi (2 a - xi)/(2 R), xi from where they enter, and drawn along by slip times xi, up
// to friction. Per spacing that is F_N = 2 k a^3/(3 R) and F_T = mu F_N (1 - (1 - q)^3), q = slip
// R/(mu a) <= 1, with the slip of the wheel's effective radius R - d/3.
//
// Left out, of F_T: the surface of the wheel slows down by s^2/(2 R^2) at the place s, of which
// d/(3 R) is the mean, k a^4/(24 R^2) at most; and of F_N what is of the order of m V^2/R over k d,
// of the spacing over a squared, and of V h/a, 1 % together.
TEST(RollingWheel, PullsAsTheBrushModel) {
  const double R = 0.5, d = 9e-4, a = 0.03, k = 1000.0 / 0.002, mu = 0.5;
  const double normal = 2.0 * k * a * a * a / (3.0 * R);
  for (const double h : {1e-4, 1.3e-4, 7e-5})
    for (const double slip : {0.0, 0.015, 0.03}) {
      GIVEN(h, slip);
      json source = shipped("rolling_wheel");
      source["time"]["dt"] = h;
      source["interfaces"][0]["obstacle"]["rate"] = -(1.0 + slip) / (R - d / 3.0);
      const Ran run = ran(source);
      const double q = std::min(1.0, slip * R / (mu * a));
      const double pull = mu * normal * (1.0 - (1.0 - q) * (1.0 - q) * (1.0 - q));
      EXPECT_NEAR(run.mean_after(0.066, "wheel.F0"), -pull,
                  k * a * a * a * a / (24.0 * R * R) + 0.01 * mu * normal);
      EXPECT_NEAR(run.mean_after(0.066, "wheel.F1"), -normal, 0.01 * normal);
    }
}

}  // namespace
}  // namespace ilaw::host::testing::closed_forms
