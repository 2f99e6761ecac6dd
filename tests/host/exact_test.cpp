// Solutions in closed form: what they say at instants that are worked out by hand, and that runs with steps
// that share no factor approach them. Bars that start deformed.
#include "host_runner.hpp"
#include "study/errors.hpp"

namespace ilaw::host::testing::exact {
namespace {

ExactNode exact_of(const json& source) {
  Scene scene = scene_of(source);
  return exact_solution(scene).at(0);
}

// ---- Post-it --------------------------------------------------------------------------------------------

// A pull has to make up for the presses within the memory of 0.1. A press of 0.2 at 0.25, then a pull of
// 2.01 from 0.3 on: the press leaves the window at 0.35, and 0.2 are passed 0.2/2.01 after the pull began. A
// pull of 1.9 never fills the window with more than 0.19.
TEST(ExactMotion, PostitCountsPressesWithinItsMemory) {
  json scene = shipped("postit_test3");
  scene["loads"] = json::parse(R"([{"type": "shock", "nodes": [0], "time": 0.25, "impulse": [-0.2]},
    {"type": "force", "nodes": [0], "direction": [1.0], "history": [[0.3, 0.0], [0.3000001, 2.01]]}])");
  scene["interfaces"][0]["parameters"]["memory"] = 0.1;
  EXPECT_NEAR(exact_of(scene).instants.last_rupture, 0.3 + 0.2 / 2.01, 1e-6);
  scene["loads"][1]["history"] = {{0.0, 0.0}, {0.3, 0.0}, {0.3000001, 1.9}};  // 0.19 in the window
  EXPECT_TRUE(std::isnan(exact_of(scene).instants.last_rupture));
}

// ---- bars -----------------------------------------------------------------------------------------------

Errors errors_of(json scene, int elements, double cfl) {
  scene["model"]["bars"][0]["elements"] = elements;
  scene["time"]["cfl"] = cfl;
  Scene run = scene_of(scene);
  return errors_against(exact_solution(run), trace_of(run));
}

// At the critical step waves are exact, and what the end's own mass costs at each impact and release is of
// first order. Below it fronts are smeared over h^(2/3), which is the order of positions; velocities ring,
// h^(1/2). Meshes and steps without a common factor.
TEST(ExactMotion, BarsConvergeToIt) {
  for (const char* name : {"bouncing_bar", "held_rod"}) {
    const json scene = shipped(name);
    for (const int elements : {37, 64, 101})
      EXPECT_LE(errors_of(scene, elements, 1.0).u_L2, 1.2 / elements) << name << ", " << elements;
    for (const auto& [elements, cfl] : {std::pair{37, 0.93}, std::pair{64, 0.77}, std::pair{101, 0.59}}) {
      const Errors errors = errors_of(scene, elements, cfl);
      EXPECT_LE(errors.u_L2, 0.6 * std::pow(elements, -2.0 / 3.0)) << name << ", " << elements;
      EXPECT_LE(errors.v_L1, 1.5 * std::pow(elements, -0.5)) << name << ", " << elements;
    }
    std::vector<double> sizes, positions, velocities;
    for (const int elements : {50, 100, 200, 400}) {
      const Errors errors = errors_of(scene, elements, 0.9);
      sizes.push_back(1.0 / elements);
      positions.push_back(errors.u_L2);
      velocities.push_back(errors.v_L1);
    }
    EXPECT_GE(order(sizes, positions), 0.65) << name;
    EXPECT_GE(order(sizes, velocities), 0.4) << name;
  }
}

// ---- what has no closed form -----------------------------------------------------------------------------

// A shipped scene, and what is put where so that its closed form no longer holds.
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
}  // namespace ilaw::host::testing::exact
