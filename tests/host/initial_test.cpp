// Displacements at the start, against motions that are known.
#include "host_runner.hpp"

namespace ilaw::host::testing::initial {
namespace {

json block(const char* material, double poisson) {
  json scene = json::parse(R"({"model": {"type": "blocks", "blocks": [{"name": "b", "corner": [1, 2, 3],
      "size": [1, 0.5, 0.5], "elements": [3, 2, 1], "material": {"young": 2, "density": 1}}]},
    "time": {"cfl": 0.8, "end": 1}, "interfaces": []})");
  scene["model"]["blocks"][0]["material"]["type"] = material;
  scene["model"]["blocks"][0]["material"]["poisson"] = poisson;
  return scene;
}

// Central difference gives a cos(W n h) exactly, sin(W h/2) = w h/2.
TEST(Initial, DisplacementOfASpringSwingsAsACosine) {
  json scene = json::parse(R"({"model": {"type": "points", "dimension": 2, "points": [
      {"mass": 2, "position": [0, 0], "stiffness": [8, 18]}, {"mass": 1, "position": [1, 0]}]},
    "time": {"end": 3}, "initial": [{"nodes": [0], "displacement": [0.1, 0.2]},
                                    {"nodes": [0], "displacement": [0, 0.1]}], "interfaces": []})");
  for (const double h : {0.07, 0.11, 0.13}) {
    scene["time"]["dt"] = h;
    auto [read, integrator] = simulation_of(scene);
    while (integrator.steps() < read.steps) {
      integrator.step();
      const double n = static_cast<double>(integrator.steps());
      EXPECT_NEAR(integrator.displacement()[0], 0.1 * std::cos(2.0 * std::asin(h) * n), 1e-13) << h;
      EXPECT_NEAR(integrator.displacement()[1], 0.3 * std::cos(2.0 * std::asin(1.5 * h) * n), 1e-13) << h;
    }
    EXPECT_EQ(integrator.displacement()[2], 0.0) << "h " << h;
    EXPECT_LT(integrator.energy().balance_error, 1e-13) << "h " << h;
  }
}

// A rotation strains nothing, about whatever point: a body with large displacements stays as it is.
TEST(Initial, RotationLeavesALargeBodyAtRest) {
  json scene = block("neo_hookean", 0.3);
  const double c = std::cos(0.7), s = std::sin(0.7);
  scene["initial"] = {
      {{"gradient", {{c - 1, -s, 0}, {s, c - 1, 0}, {0, 0, 0}}}, {"displacement", {1, 0, 2}}}};
  auto [read, integrator] = simulation_of(scene);
  const Dofs start = integrator.displacement();
  EXPECT_NEAR(start[0], c * 1.0 - s * 2.0 - 1.0 + 1.0, 1e-15);
  EXPECT_NEAR(start[1], s * 1.0 + c * 2.0 - 2.0, 1e-15);
  while (integrator.steps() < read.steps) integrator.step();
  EXPECT_LT((integrator.displacement() - start).cwiseAbs().maxCoeff(), 1e-13);
}

// A stretch stores E eps^2/2 per volume where nothing contracts; of a bar it moves the ends.
TEST(Initial, StretchStoresWhatAnElasticBodyDoes) {
  json scene = block("linear", 0.0);
  scene["initial"] = {{{"nodes", "b"}, {"gradient", {{0.01, 0, 0}, {0, 0, 0}, {0, 0, 0}}}}};
  Scene read = scene_of(scene);
  EXPECT_NEAR(read.model->potential(read.model->initial_displacement()), 0.5 * 2.0 * 1e-4 * 0.25, 1e-17);
  json bar = json::parse(R"({"model": {"type": "bars", "bars": [{"start": 1, "length": 2, "elements": 7,
      "young": 1, "density": 1}]}, "time": {"cfl": 0.9, "end": 1}, "interfaces": []})");
  bar["initial"] = {{{"gradient", {{0.15}}}, {"displacement", {-0.05}}}};
  EXPECT_LT(
      (scene_of(bar).model->initial_displacement() - Dofs::LinSpaced(8, 0.1, 0.4)).cwiseAbs().maxCoeff(),
      1e-15);
}

// ---- bars that start deformed ---------------------------------------------------------------------------

// A bar of E = S = L = 1, moved by a at its left and b at its right end, has the strain b - a everywhere: the
// energy (b - a)^2/2 at the start, and forces of b - a on its ends alone, which give half a step's velocity.
TEST(InitialDisplacement, IsLinearAlongTheBar) {
  for (const auto& [a, b] : {std::pair{0.3, -0.1}, std::pair{-0.2, 0.4}, std::pair{0.7, 0.7}}) {
    json source = shipped("held_rod");
    source.erase("exact");
    source["loads"] = json::array();
    source["model"]["bars"][0]["elements"] = 7;
    source["initial"] = {{{"displacement", {a}}, {"gradient", {{b - a}}}}};
    source["interfaces"] = json::array();
    auto [scene, integrator] = simulation_of(source);
    const double half_mass = 0.5 / 7.0, kick = 0.5 * scene.dt * (b - a) / half_mass;
    for (int k = 0; k <= 7; ++k) {
      EXPECT_NEAR(integrator.displacement()[k], a + (b - a) * k / 7.0, 1e-15) << k;
      EXPECT_NEAR(integrator.velocity()[k], k == 0 ? kick : k == 7 ? -kick : 0.0, 1e-13) << k;
    }
    EXPECT_NEAR(integrator.energy().potential, 0.5 * (b - a) * (b - a), 1e-15);
    while (integrator.steps() < scene.steps) integrator.step();
    EXPECT_LE(integrator.energy().balance_error, 1e-13);
  }
}

TEST(InitialDisplacement, IntoAnObstacleIsWarnedOf) {
  json scene = shipped("held_rod");
  scene["initial"] = {{{"displacement", {-0.25}}, {"gradient", {{0.25}}}}};
  scene.erase("exact");
  EXPECT_THAT(scene_of(scene).warnings,
              ElementsAre("/interfaces/0: 1 node(s) start inside the obstacle, node 0 by 0.25"));
}

}  // namespace
}  // namespace ilaw::host::testing::initial
