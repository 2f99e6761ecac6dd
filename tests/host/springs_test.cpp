// Springs and dampers between nodes, against closed forms of central difference and of two bodies.
#include "host_runner.hpp"
#include "scene_parts.hpp"

#include <Eigen/Eigenvalues>

namespace ilaw::host::testing::springs {
namespace {

json two_masses(double stiffness, double damping) {
  json scene = json::parse(R"({"model": {"type": "points", "dimension": 1, "points": [
      {"mass": 1, "position": [0], "velocity": [0.3]}, {"mass": 3, "position": [2], "velocity": [-0.1]}]},
    "time": {"end": 4}, "springs": [{"nodes": [0], "to": [1], "length": 1.5}], "interfaces": []})");
  scene["springs"][0]["stiffness"] = stiffness;
  scene["springs"][0]["damping"] = damping;
  return scene;
}

constexpr double reduced_mass = 0.75;

// About its rest length the distance is a cos(W n h) + b sin(W n h), sin(W h/2) = w h/2; the centre of
// mass is at rest, for the momentum is 0.
TEST(Spring, SwingsAboutItsRestLength) {
  constexpr double k = 3.0, stretch = 0.5, speed = -0.4;
  for (const double h : {0.07, 0.11, 0.13}) {
    json source = two_masses(k, 0.0);
    source["time"]["dt"] = h;
    auto [scene, integrator] = simulation_of(source);
    const double W = 2.0 * std::asin(0.5 * h * std::sqrt(k / reduced_mass));
    const double b = h * speed / std::sin(W);
    EXPECT_NEAR(integrator.energy().potential, 0.5 * k * stretch * stretch, 1e-15) << "h " << h;
    while (integrator.steps() < scene.steps) {
      integrator.step();
      const double phase = W * static_cast<double>(integrator.steps());
      const Dofs& u = integrator.displacement();
      ASSERT_NEAR(2.0 + u[1] - u[0], 1.5 + stretch * std::cos(phase) + b * std::sin(phase), 1e-13) << h;
      ASSERT_NEAR(u[0] + 3.0 * u[1], 0.0, 1e-14) << h;
    }
    EXPECT_LT(integrator.energy().balance_error, 1e-13) << "h " << h;
  }
}

// Each step takes h c/m of the speed before it, and the half step to the first velocity half of that.
TEST(Damper, StartsWithHalfAStep) {
  constexpr double c = 0.5;
  for (const double h : {0.07, 0.11, 0.13}) {
    json source = two_masses(0.0, c);
    source["time"]["dt"] = h;
    auto [scene, integrator] = simulation_of(source);
    const double part = h * c / reduced_mass;
    double rate = -0.4 * (1.0 - 0.5 * part);
    for (;; rate *= 1.0 - part) {
      ASSERT_NEAR(integrator.velocity()[1] - integrator.velocity()[0], rate, 1e-15)
          << "step " << integrator.steps() << " of " << h;
      if (integrator.steps() == scene.steps) break;
      integrator.step();
    }
  }
}

// One end drives, the other is dragged along: the reaction of what drives is what the damper gives to
// the mass, whatever else damps.
TEST(Damper, DragsFromAnEndThatIsDriven) {
  json source = two_masses(0.0, 0.5);
  source["loads"] =
      json::parse(R"([{"type": "damping", "rate": 0}, {"type": "motion", "nodes": [0], "velocity": [0.2]}])");
  for (const double h : {0.04, 0.03, 0.007}) {
    source["time"] = {{"dt", h}, {"end", 40}};
    auto [scene, integrator] = simulation_of(source);
    integrator.keep_load_impulse(1);
    double before = integrator.velocity()[1];
    // The node has the velocity of its motion before the start, too.
    EXPECT_NEAR(before, -0.1 + 0.5 * h * 0.5 / 3.0 * (0.2 + 0.1), 1e-15) << "h " << h;
    while (integrator.steps() < scene.steps) {
      integrator.step();
      Dofs reaction = Dofs::Zero(2);
      integrator.add_load_impulse(1, reaction);
      ASSERT_NEAR(reaction[0], 3.0 * (integrator.velocity()[1] - before), 1e-15) << integrator.steps();
      before = integrator.velocity()[1];
    }
    EXPECT_NEAR(integrator.velocity()[1], 0.2, 1e-2 * 0.3) << "h " << h;
    EXPECT_LT(integrator.energy().balance_error, 1e-12) << "h " << h;
  }
}

// In the plane a spring is a pendulum: the force is central, so that the angular momentum stays to rounding,
// and the energy that it stores is what it works.
TEST(Spring, TurnsWithItsEnds) {
  json source = json::parse(R"({"model": {"type": "points", "dimension": 2, "points": [
      {"mass": 1, "position": [1, 0], "velocity": [0, 1.5]}, {"mass": 2, "position": [3, 1], "velocity": [-0.5, 2]}]},
    "time": {"end": 6}, "interfaces": [],
    "springs": [{"nodes": [0, 1], "anchor": [0, 0], "stiffness": 2, "length": 1.5},
                {"nodes": [0], "to": [1], "stiffness": 1}]})");
  std::vector<double> steps, errors;
  for (const double h : {0.05, 0.035, 0.011}) {
    source["time"]["dt"] = h;
    Scene scene = scene_of(source);
    Integrator integrator = integrator_of(scene);
    const double momentum = integrator.angular_momentum()[0];
    // Work is booked from half step to half step.
    const auto potential_ahead = [&] {
      return scene.model->potential(integrator.displacement() + 0.5 * h * integrator.velocity());
    };
    const double since_start = potential_ahead() - integrator.energy().potential;
    double error = 0.0;
    while (integrator.steps() < scene.steps) {
      integrator.step();
      ASSERT_NEAR(integrator.angular_momentum()[0], momentum, 1e-13) << h;
      error = std::max(error, std::abs(integrator.energy().internal + since_start - potential_ahead()));
    }
    steps.push_back(h);
    errors.push_back(error);
    EXPECT_LT(integrator.energy().balance_error, 1e-13) << "h " << h;
    EXPECT_LT(error, 0.6 * h * h) << h;
  }
  EXPECT_NEAR(order(steps, errors), 2.0, 0.1);
}

json springs_between(const std::string& nodes, const std::string& partners, const std::vector<json>& blocks) {
  json scene = scene_of_blocks(blocks, "[]");
  scene["springs"] = {{{"name", "grip"}, {"nodes", nodes}, {"to", partners}, {"stiffness", 1}}};
  scene["time"] = {{"cfl", 0.5}, {"end", 1}};
  scene["output"] = {{"forces", {"grip"}}};
  return scene;
}

// Faces have orders of their own.
TEST(Spring, JoinsNodesOfFacesThatFaceEachOther) {
  const std::vector<json> cube = {block("cube", {0, 0, 0}, {2, 2, 2}, {2, 3, 4}, elastic(1, 0.3, 1))};
  for (const std::string axis : {"x", "y", "z"}) {
    const Scene scene = scene_of(springs_between("cube." + axis + "_min", "cube." + axis + "_max", cube));
    EXPECT_TRUE(scene.warnings.empty()) << axis;
    for (const Spring& spring : scene.output.forces.at(0).springs)
      EXPECT_NEAR(spring.length, 2.0, 1e-12) << axis;
  }
}

TEST(Spring, WarnsWhenSetsDoNotFaceEachOther) {
  const std::vector<json> blocks = {block("low", {0, 0, 0}, {1, 1, 1}, {2, 2, 1}, elastic(1, 0.3, 1)),
                                    block("up", {0, 0, 2}, {2, 2, 1}, {2, 2, 1}, elastic(1, 0.3, 1))};
  const Scene scene = scene_of(springs_between("low.z_max", "up.z_min", blocks));
  ASSERT_EQ(scene.warnings.size(), 1U);
  EXPECT_THAT(scene.warnings[0], StartsWith("/springs/0/to: these nodes do not face"));
}

// ---- the critical step ----------------------------------------------------------------------------------

double growth_at(json source, double h) {
  source["time"] = {{"dt", h}, {"end", 400.0 * h}};
  auto [scene, integrator] = simulation_of(source);
  try {
    while (integrator.steps() < scene.steps) integrator.step();
  } catch (const Diverged&) {
    return INFINITY;
  }
  const Dofs& u = integrator.displacement();
  return std::abs(u[1] - u[0]);
}

// One spring and damper: 2 (sqrt(1 + z^2) - z)/w, and it is the limit.
TEST(SpringsCriticalStep, IsTheLimitOfOneSpring) {
  for (const double z : {0.0, 0.2, 1.0, 3.0}) {
    const double k = 3.0, w = std::sqrt(k / reduced_mass), c = 2.0 * z * w * reduced_mass;
    json source = two_masses(k, c);
    source["springs"][0]["length"] = 0.0;  // linear, also where the ends pass each other
    source["time"] = {{"cfl", 1.0}, {"end", 1.0}};
    const double critical = scene_of(source).dt;
    EXPECT_NEAR(critical, 2.0 * (std::sqrt(1.0 + z * z) - z) / w, 1e-14) << z;
    EXPECT_LT(growth_at(source, 0.999 * critical), 100.0) << z;
    EXPECT_GT(growth_at(source, 1.05 * critical), 1e10) << z;
  }
  json source = two_masses(0.0, 2.0);
  source["time"] = {{"cfl", 1.0}, {"end", 1.0}};
  EXPECT_NEAR(scene_of(source).dt, 2.0 / (2.0 / reduced_mass), 1e-14);
}

// A chain of equal masses: hardly anything is given away; networks at random: no step is too large.
TEST(SpringsCriticalStep, IsABoundFromBelow) {
  Random random(14);
  for (int round = 0; round < 40; ++round) {
    const int n = 12;
    const bool is_chain = round == 0;
    json source = json::parse(
        R"({"model": {"type": "points", "dimension": 1}, "time": {"cfl": 1, "end": 100}, "interfaces": []})");
    Eigen::MatrixXd stiffness = Eigen::MatrixXd::Zero(n, n);
    Eigen::VectorXd mass(n);
    for (int i = 0; i < n; ++i) {
      mass[i] = is_chain ? 1.0 : random(0.1, 10.0);
      source["model"]["points"].push_back({{"mass", mass[i]}, {"position", {1.0 * i}}});
    }
    for (int s = 0; s + 1 < (is_chain ? n : 2 * n); ++s) {
      const int i = is_chain ? s : random.below(n);
      const int j = is_chain ? s + 1 : (i + 1 + random.below(n - 1)) % n;
      const double k = is_chain ? 1.0 : random(0.1, 10.0);
      source["springs"].push_back({{"nodes", {i}}, {"to", {j}}, {"stiffness", k}});
      for (const int end : {i, j}) stiffness(end, end) += k;
      stiffness(i, j) -= k;
      stiffness(j, i) -= k;
    }
    const Eigen::VectorXd root = mass.cwiseSqrt().cwiseInverse();
    const Eigen::MatrixXd scaled = root.asDiagonal() * stiffness * root.asDiagonal();
    const double limit =
        2.0 / std::sqrt(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(scaled).eigenvalues().maxCoeff());
    const double found = scene_of(source).dt;
    ASSERT_LE(found, limit * (1.0 + 1e-12)) << "round " << round;
    ASSERT_GE(found, (is_chain ? 0.98 : 0.6) * limit) << "round " << round;
  }
}

// Beside a body's own stiffness: a bar whose end is held by a spring.
TEST(SpringsCriticalStep, CountsTheBody) {
  json source = json::parse(R"({"model": {"type": "bars", "bars": [{"length": 1, "elements": 10, "young": 1,
      "density": 1}]}, "time": {"cfl": 1, "end": 5}, "interfaces": [],
    "springs": [{"nodes": "bar0.right", "anchor": [1.5], "stiffness": 30, "damping": 0.2}],
    "initial": [{"gradient": [[0.1]]}]})");
  Scene scene = scene_of(source);
  EXPECT_NEAR(scene.dt, 4.0 / (4.0 + std::sqrt(16.0 + 4.0 * (400.0 + 600.0))), 1e-15);
  Integrator integrator = integrator_of(scene);
  const double start = integrator.energy().scale;
  while (integrator.steps() < scene.steps) integrator.step();
  EXPECT_LT(integrator.energy().balance_error, 1e-12);
  EXPECT_LT(integrator.energy().damping_work, 0.0);
  EXPECT_LE(integrator.energy().scale, start * (1.0 + 1e-12));
}

}  // namespace
}  // namespace ilaw::host::testing::springs
