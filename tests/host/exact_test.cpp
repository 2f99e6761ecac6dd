// Solutions in closed form: what they say at instants that are worked out by hand, and that runs with steps
// that share no factor approach them. Bars that start deformed.
#include "host_runner.hpp"
#include "study/errors.hpp"

namespace ilaw::host::testing {
namespace {

ExactNode exact_of(const json& source) {
  Scene scene = scene_of(source);
  return exact_solution(scene).at(0);
}

struct Instant {
  double time, position, velocity;
};

void expect_instants(const char* name, const std::vector<Instant>& instants) {
  const ExactNode exact = exact_of(shipped(name));
  for (const Instant& at : instants) {
    EXPECT_NEAR(exact.displacement(at.time), at.position, 1e-12) << name << " at " << at.time;
    EXPECT_NEAR(exact.velocity(at.time), at.velocity, 1e-12) << name << " at " << at.time;
  }
}

// ---- Post-it --------------------------------------------------------------------------------------------

// Each pull of 1.5 throws the mass up; 0.04 later, at 0.06, it is pushed back at 1, and lands 0.06 later.
TEST(ExactMotion, PostitTest1FollowsTheStoryByHand) {
  expect_instants("postit_test1", {{0.25, 0.0, 0.0},
                                   {0.32, 0.03, 1.5},
                                   {0.37, 0.03, -1.0},
                                   {0.45, 0.0, 0.0},
                                   {1.22, 0.03, 1.5},
                                   {1.7, 0.0, 0.0}});
  const ContactInstants instants = exact_of(shipped("postit_test1")).instants;
  EXPECT_EQ(instants.first_impulse, 0.05);
  EXPECT_EQ(instants.last_rupture, 1.2);
}

// Up at 0.8 from 1.1, at 2.3 from 0.08 at 1.2, at -0.2 from 0.172 at 1.24, at -1 from 0.15 at 1.35, down at
// 1.5, and up at 0.8 from 1.6 on.
TEST(ExactMotion, PostitTest2FollowsTheStoryByHand) {
  expect_instants("postit_test2", {{1.15, 0.04, 0.8},
                                   {1.22, 0.126, 2.3},
                                   {1.3, 0.16, -0.2},
                                   {1.4, 0.1, -1.0},
                                   {1.55, 0.0, 0.0},
                                   {1.7, 0.08, 0.8}});
  EXPECT_EQ(exact_of(shipped("postit_test2")).instants.last_rupture, 1.6);
}

// Broken at 1.05 it leaves at 0.25, is pushed back at 1.15 and down at 1.25. The ramp 40 (t - 1.5) breaks the
// bond at 1.665; then the velocity is 20 ((t - 1.5)^2 - 0.165^2), from 1.7 on it grows by 8.
TEST(ExactMotion, PostitTest3FollowsTheStoryByHand) {
  const double at_end_of_ramp = 20.0 * (0.04 - 0.165 * 0.165);
  expect_instants(
      "postit_test3",
      {{0.5, 0.0, 0.0}, {0.95, 0.0, 0.0}, {1.1, 0.0125, 0.25}, {1.2, 0.0125, -0.25}, {1.6, 0.0, 0.0}});
  const ExactNode exact = exact_of(shipped("postit_test3"));
  EXPECT_NEAR(exact.instants.last_rupture, 1.665, 1e-9);  // the slack of the limit
  EXPECT_NEAR(exact.velocity(1.7), at_end_of_ramp, 1e-8);
  EXPECT_NEAR(exact.velocity(1.78), at_end_of_ramp + 0.64, 1e-8);
  const double risen = 20.0 / 3.0 * (0.008 - 0.165 * 0.165 * 0.165) - 20.0 * 0.165 * 0.165 * 0.035;
  EXPECT_NEAR(exact.displacement(1.7), risen, 1e-9);
}

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

// ---- a mass on a spring against a stop

// Thrown at -1 from rest length, w = 10, towards a stop at 0.05: there at pi/60 with sqrt(3)/2, of which 0.8
// is left. Then u = -0.05 cos(10 s) + 0.04 sqrt(3) sin(10 s), s the time since.
TEST(ExactMotion, ImpactOscillatorFollowsTheStoryByHand) {
  const double meets = M_PI / 60.0, leaves = 0.4 * std::sqrt(3.0);
  const auto again = [&](double s) { return -0.05 * std::cos(10.0 * s) + 0.1 * leaves * std::sin(10.0 * s); };
  expect_instants("impact_oscillator",
                  {{0.03, -0.1 * std::sin(0.3), -std::cos(0.3)},
                   {meets + 0.05 * M_PI, 0.1 * leaves, 0.5},
                   {meets + 0.2, again(0.2), 0.5 * std::sin(2.0) + leaves * std::cos(2.0)}});
  const ExactNode exact = exact_of(shipped("impact_oscillator"));
  EXPECT_NEAR(exact.instants.first_impulse, meets, 1e-15);
  EXPECT_NEAR(exact.impulse(0.2), 0.9 * std::sqrt(3.0), 1e-14);
  EXPECT_NEAR(exact.work(0.2), -0.135, 1e-15);
}

// ---- bars -----------------------------------------------------------------------------------------------

// Dropped from 5 under g = 10 onto the plane, at 10 from 1 to 5/3; up for 1 and down for 1 while the end
// vibrates with the period 2/3 by g s (2/3 - s), most at its middle, by 10/9; again from 11/3 to 13/3; then
// it rises undeformed to where it was, at 16/3.
TEST(ExactMotion, BouncingBarFollowsTheStoryByHand) {
  expect_instants("bouncing_bar",
                  {{0.5, -1.25, -5.0},
                   {1.3, -5.0, 0.0},
                   {5.0 / 3.0 + 1.0 / 3.0, -5.0 + 10.0 / 3.0 - 5.0 / 9.0 - 10.0 / 9.0, 10.0 - 10.0 / 3.0},
                   {5.0 / 3.0 + 1.0, -10.0 / 9.0, 0.0},
                   {4.0, -5.0, 0.0},
                   {13.0 / 3.0 + 0.5, -1.25, 5.0},
                   {16.0 / 3.0 + 0.5, -1.25, -5.0}});
}

TEST(ExactMotion, HeldRodFollowsTheStoryByHand) {
  expect_instants("held_rod", {{0.5, 0.25, -0.5}, {1.5, 0.0, 0.0}, {2.5, 0.25, 0.5}, {3.5, 0.25, -0.5}});
}

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
}  // namespace ilaw::host::testing
