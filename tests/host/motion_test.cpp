// Motions with closed forms, at the level of scenes.
#include "host_runner.hpp"

#include <functional>

namespace ilaw::host::testing {
namespace {

json ball(double restitution, double h, double end, double height) {
  const json floor =
      law_on("all", ground(1), "contact", {{"restitution", restitution}, {"activation", "moreau"}});
  return until(end, h, scene_of_points({point(2, {height})}, {floor}, {gravity({-10})}));
}

// A plane that moves carries a resting point along, also through a path; the point's gap stays closed.
TEST(MovingPlane, CarriesItsPoint) {
  for (const char* motion : {R"({"velocity": [0.5]})", R"({"path": [[0, 0], [2, 1]]})"}) {
    json moving = ground(1);
    moving.update(json::parse(motion));
    auto [scene, integrator] = run_to_end(
        until(1, 1e-3, scene_of_points({point(1, {0})}, {law_on({0}, moving, "contact")}, {gravity({-10})})));
    EXPECT_NEAR(integrator.displacement()[0], 0.5, 2e-3) << "motion " << motion;
    EXPECT_NEAR(integrator.velocity()[0], 0.5, 1e-12) << "motion " << motion;
    EXPECT_LE(integrator.energy().balance_error, 1e-12) << "motion " << motion;
  }
}

// Over all nodes and steps, not the last of them.
TEST(Penetration, IsTheLargestOfAll) {
  const std::vector<json> points{point(1, {0.1}, {-3.1}), point(1, {-0.3}), point(1, {5}), point(1, {-0.1})};
  auto [scene, integrator] = run_to_end(until(
      0.5, 0.1, scene_of_points(points, {law_on("all", ground(1), "contact", {{"activation", "moreau"}})})));
  EXPECT_NEAR(integrator.tally().penetration_max, 0.3, 1e-15);
}

// A plane that starts to recede at the instant of the impact: it approached at v^- - 0, and leaves with v = w
// - e v^- for the plane's velocity w in the step to come.
TEST(MovingPlane, CountsWithItsVelocityBeforeAndAfterAKink) {
  for (const double w : {-0.3, 0.4}) {
    json wall = ground(1);
    wall["path"] = {{0, 0}, {0.25, 0}, {1.25, w}};
    const json law = law_on({0}, wall, "contact", {{"restitution", 0.5}, {"activation", "moreau"}});
    auto [scene, integrator] =
        run_to_end(until(0.3, 1e-3, scene_of_points({point(1, {0.2495}, {-1})}, {law})));
    EXPECT_NEAR(integrator.velocity()[0], w + 0.5, 1e-12) << w;
    EXPECT_LE(integrator.energy().balance_error, 1e-12) << "w " << w;
  }
}

// A point in the corner of two planes that are not at right angles: each impulse moves it along the other
// plane, and the sweep over both must leave it at rest.
TEST(Corner, OfTwoPlanesHoldsAPoint) {
  const json floor = law_on({0}, ground(2), "coulomb", {{"friction", 0.1}}),
             wall = law_on({0}, plane({0, 0}, {0.8, -0.6}), "coulomb", {{"friction", 0.1}});
  auto [scene, integrator] = run_to_end(
      until(0.1, 1e-3, scene_of_points({point(1, {0, 0}, {-1, -2})}, {floor, wall}, {gravity({0, -10})})));
  EXPECT_LE(integrator.velocity().norm(), 1e-12);
  EXPECT_GT(integrator.tally().sweeps_max, 2);
  EXPECT_LE(integrator.tally().coupling_residual_max, CoupledStep::default_tolerance);
  EXPECT_LE(integrator.energy().balance_error, 1e-12);
}

// A shock at a multiple of dt enters exactly one step, the one that ends there, at any rounding of n dt.
TEST(Shock, EntersExactlyOneStep) {
  for (const double h : {0.1, 1e-3, 7e-4, 1.0 / 3.0})
    for (int n = 1; n <= 300; n += 7) {
      auto [scene, integrator] =
          simulation_of(until(310 * h, h, scene_of_points({point(1, {9})}, {}, {shock({0}, n * h, {1})})));
      while (integrator.steps() < n - 1) integrator.step();
      EXPECT_EQ(integrator.velocity()[0], 0.0) << "n " << n;
      integrator.step();
      EXPECT_EQ(integrator.velocity()[0], 1.0) << "n " << n;
      run_to_end(integrator, scene);
      EXPECT_EQ(integrator.velocity()[0], 1.0) << "n " << n;
    }
}

// Instants as people write them, in decimals, which n dt meets only but for rounding: one for each step.
TEST(Shock, AtADecimalInstantEntersTheStepThatEndsThere) {
  constexpr int shocks = 120;
  const auto decimal = [](int thousandths) {
    char text[32];
    std::snprintf(text, sizeof text, "%d.%03d", thousandths / 1000, thousandths % 1000);
    return std::string(text);
  };
  for (const int dt : {1, 3, 7, 9, 11}) {
    std::string loads;
    for (int n = 1; n <= shocks; ++n)
      loads += std::string(n > 1 ? ", " : "") +
               R"({"type": "shock", "nodes": [0], "impulse": [1.0], "time": )" + decimal(n * dt) + "}";
    auto [scene, integrator] = simulation_of(
        R"({"model": {"type": "points", "dimension": 1, "points": [{"mass": 1.0, "position": [9.0]}]},
        "time": {"dt": )" +
        decimal(dt) + R"(, "end": 10.0}, "loads": [)" + loads + R"(], "interfaces": []})");
    for (int n = 1; n <= shocks; ++n) {
      integrator.step();
      ASSERT_EQ(integrator.velocity()[0], n) << "dt = " << decimal(dt) << ", step " << n;
    }
  }
}

// V_{1/2} = V_0 + (h/2) g: positions of a free fall are exact at all steps.
TEST(Start, TakesHalfAStepOfForce) {
  auto [scene, integrator] = simulation_of(ball(0.0, 1e-3, 0.3, 1.0));
  EXPECT_EQ(integrator.velocity()[0], -0.5 * 1e-3 * 10.0);
  while (integrator.steps() < scene.steps) integrator.step();
  EXPECT_NEAR(integrator.displacement()[0], -0.5 * 10.0 * 0.3 * 0.3, 1e-13);
}

}  // namespace
}  // namespace ilaw::host::testing
