// Springs and dampers between nodes, against closed forms of central difference and of two bodies.
#include "host_runner.hpp"
#include "scene_parts.hpp"

#include <Eigen/Eigenvalues>

namespace ilaw::host::testing::springs {
namespace {

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

}  // namespace
}  // namespace ilaw::host::testing::springs
