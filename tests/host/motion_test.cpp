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

// Height of a ball dropped from h0 under gravity g: first fall t1 = sqrt(2 h0/g), then flights k of 2 e^k t1,
// in which it starts with e^k g t1.
double ball_height(double restitution, double height, double time) {
  constexpr double g = 10.0;
  const double fall = std::sqrt(2.0 * height / g);
  if (time < fall) return height - 0.5 * g * time * time;
  double start = fall, speed = restitution * g * fall;
  while (speed > 1e-6 && time > start + 2.0 * speed / g) {
    start += 2.0 * speed / g;
    speed *= restitution;
  }
  if (speed <= 1e-6) return 0.0;
  return speed * (time - start) - 0.5 * g * (time - start) * (time - start);
}

// Mean position error over the run, averaged over heights, since errors depend on where impacts fall in the
// steps.
double ball_error(double restitution, double h) {
  double error = 0.0;
  constexpr int draws = 10;
  for (int draw = 0; draw < draws; ++draw) {
    const double height = 1.0 + 0.04 * std::sqrt(2.0) * draw;
    auto [scene, integrator] = simulation_of(ball(restitution, h, 2.5, height));
    while (integrator.steps() < scene.steps) {
      integrator.step();
      error += std::abs(height + integrator.displacement()[0] -
                        ball_height(restitution, height, integrator.time())) /
               static_cast<double>(scene.steps * draws);
    }
  }
  return error;
}

// First order: an impact is seen up to a step late, at speed up to 4.5, and each of three flights adds up: C
// = 20.
TEST(BouncingBall, ConvergesToItsParabolasForEveryRestitution) {
  for (const double restitution : {0.0, 0.5, 1.0}) {
    std::vector<double> steps, errors;
    for (const double h : {1.1e-3, 4.3e-4, 1.9e-4}) {
      steps.push_back(h);
      errors.push_back(ball_error(restitution, h));
      EXPECT_LE(errors.back(), 20.0 * h) << "e = " << restitution << ", h = " << h;
    }
    EXPECT_GE(order(steps, errors), 0.9) << "e = " << restitution;
  }
}

// After k impacts the speed is e^k times that of the first, but for gravity over the step of the impact.
TEST(BouncingBall, KeepsTheRestitutionToTheKthImpact) {
  constexpr double h = 1e-4, e = 0.7;
  auto [scene, integrator] = simulation_of(ball(e, h, 3.0, 1.0));
  double before = 0.0;
  int impacts = 0;
  while (impacts < 5) {
    const double v = integrator.velocity()[0];
    integrator.step();
    if (integrator.interface_impulse()[0] > 0.0) {
      EXPECT_NEAR(integrator.velocity()[0], -e * v, 1e-15);
      if (impacts > 0) {
        EXPECT_NEAR(-v, before, 2.0 * 10.0 * h + 10.0 * h);  // within the steps at both ends of the flight
      }
      before = -e * v;
      ++impacts;
    }
  }
}

json sliding(const Numbers& velocity, double h, const Numbers& weight, const Numbers& normal,
             double friction) {
  const Numbers origin(velocity.size());
  const json floor = law_on("all", plane(origin, normal), "coulomb", {{"friction", friction}});
  return until(1, h, scene_of_points({point(3, origin, velocity)}, {floor}, {gravity(weight)}));
}

// Stops after v0^2/(2 mu g) along its direction. The first step sees gravity from half a step before, so the
// speed it slides with is mu g h/2 less or more: error below v0 h = 2 h over the distance, C = 2.
TEST(SlidingBlock, StopsAtItsDistanceAndKeepsItsDirection) {
  std::vector<double> steps, errors;
  for (double h = 7e-3; h > 2e-4; h /= 2.0) {
    double error = 0.0;
    for (const double friction : {0.4, 0.43, 0.47, 0.51}) {
      auto [scene, integrator] = run_to_end(sliding({1.2, 1.6, 0}, h, {0, 0, -10}, {0, 0, 1}, friction));
      const Dofs& u = integrator.displacement();
      // Rounding of up to 4600 sums below 0.5.
      EXPECT_NEAR(u[0] * 1.6, u[1] * 1.2, 4600 * 0.5 * 2.2e-16) << "h " << h << ", friction " << friction;
      EXPECT_EQ(integrator.velocity().head(2).norm(), 0.0) << "h " << h << ", friction " << friction;
      error += std::abs(std::hypot(u[0], u[1]) - 2.0 * 2.0 / (2.0 * friction * 10.0)) / 4.0;
    }
    steps.push_back(h);
    errors.push_back(error);
    EXPECT_LE(error, 2.0 * h) << "h " << h;
  }
  EXPECT_GE(order(steps, errors), 0.9);
}

// On an incline a block sticks for tan(theta) <= mu, else accelerates at g (sin - mu cos).
TEST(SlidingBlock, OnAnInclineSticksOrAccelerates) {
  const double angle = 0.5, h = 1e-3;
  for (const double friction : {0.3, 0.54, 0.55, 0.8}) {
    auto [scene, integrator] =
        run_to_end(sliding({0, 0}, h, {0, -10}, {-std::sin(angle), std::cos(angle)}, friction));
    const double down =
        -(integrator.velocity()[0] * std::cos(angle) + integrator.velocity()[1] * std::sin(angle));
    const bool sticks = std::tan(angle) <= friction;
    const double acceleration = sticks ? 0.0 : 10.0 * (std::sin(angle) - friction * std::cos(angle));
    // One second, and half a step of gravity without friction at the start.
    EXPECT_NEAR(down, acceleration, sticks ? 1e-12 : 10.0 * h) << friction;
  }
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
