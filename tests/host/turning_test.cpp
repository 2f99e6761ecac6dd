// Obstacles that turn: the surface that a node meets has a velocity of its own.
#include "host_runner.hpp"

#include <Eigen/Geometry>
#include <complex>

namespace ilaw::host::testing::turning {
namespace {

// A mass that a spring of stiffness k = 100 holds to a turntable, where both were at rest to each other. With
// z = x + iy and turned by w = 2, z'' = -k (z - e^(iwt)), so that
//     z = A e^(iwt) + (1 - A) (0.6 e^(10it) + 0.4 e^(-10it)),   A = k/(k - w^2).
// In the axes of space the spring would not turn, and fling it away.
struct Held {
  const char* law;
  double depth;                // of the place at rest under gravity
  double on_plane, on_sphere;  // error over h^2
};
class Turntable : public ::testing::TestWithParam<Held> {};
void follow_turntable(const Held& held, const json& obstacle, double error, const json& other = {}) {
  using namespace std::complex_literals;
  constexpr double a = 100.0 / 96.0;
  for (const double h : {0.003, 0.0013, 0.00037}) {
    json source = json::parse(R"({"model": {"type": "points", "dimension": 3, "points": [
        {"mass": 1, "position": [1, 0, 0], "velocity": [0, 2, 0]}]}, "time": {"end": 10},
        "loads": [{"type": "gravity", "acceleration": [0, 0, -10]}],
        "interfaces": [{"nodes": "all"}]})");
    source["time"]["dt"] = h;
    source["model"]["points"][0]["position"][2] = -held.depth;
    source["interfaces"][0].update(json::parse(held.law));
    source["interfaces"][0]["obstacle"] = obstacle;
    if (!other.is_null()) source["interfaces"].push_back(other);
    auto [scene, integrator] = simulation_of(source);
    while (integrator.steps() < scene.steps) {
      integrator.step();
      const double t = integrator.time();
      const std::complex<double> swings = 0.6 * std::exp(10i * t) + 0.4 * std::exp(-10i * t),
                                 there = a * std::exp(2i * t) + (1.0 - a) * swings;
      const Vector found = scene.model->position() + integrator.displacement();
      ASSERT_LT(std::abs(std::complex<double>(found[0], found[1]) - there), error * h * h)
          << "h " << h << ", time " << t;
    }
  }
}
TEST_P(Turntable, TurnsTheMemoryOfALaw) {
  follow_turntable(GetParam(),
                   json::parse(R"({"type": "plane", "point": [0, 0, 0], "normal": [0, 0, 1], "rate": 2})"),
                   GetParam().on_plane);
}
// At its pole it is as flat as that; whether the node has one interface, or two that are solved together.
TEST_P(Turntable, IsThePoleOfALargeSphereToo) {
  const json sphere = json::parse(
      R"({"type": "sphere", "center": [0, 0, -1e6], "radius": 1e6, "axis": [0, 0, 1], "rate": 2})");
  follow_turntable(GetParam(), sphere, GetParam().on_sphere);
  follow_turntable(GetParam(), sphere, GetParam().on_sphere, json::parse(R"({"law": "contact", "nodes": "all",
      "obstacle": {"type": "plane", "point": [0, 0, -1], "normal": [0, 0, 1]}})"));
}
INSTANTIATE_TEST_SUITE_P(
    Laws, Turntable,
    ::testing::Values(
        Held{R"({"law": "cohesive", "parameters": {"strength": "inf", "toughness": 1, "stiffness": 100}})",
             1e-9, 40.0, 50.0},
        Held{R"({"law": "penalty", "parameters": {"stiffness": 1e4, "integration": "implicit",
                 "friction": 1e6, "tangential_stiffness": 100}})",
             1e-3, 40.0, 50.0}));

// A point on a sphere that starts to spin. Alone, and with an interface out of reach, so that contacts are
// solved together: as the start is faster than the bound on speeds, that step is solved more than once.
json on_spinning_sphere(const json& interface, const json& gravity) {
  json scene = json::parse(R"({"model": {"type": "points", "dimension": 3, "points": [
      {"mass": 1, "position": [0.1, 0, 0.79372539331937719]}]}, "time": {"dt": 0.01, "end": 1},
    "loads": [{"type": "gravity"}], "interfaces": [{"nodes": "all", "obstacle": {"type": "sphere",
      "center": [0, 0, 0], "radius": 0.8, "axis": [0, 0, 1], "angles": [[0, 0], [0.2, 0], [1.2, 20]]}}]})");
  scene["loads"][0]["acceleration"] = gravity;
  scene["interfaces"][0].update(interface);
  return scene;
}
// Laws of the tree that remember vectors, with the parameters of their tests, and two stiff bonds.
std::vector<json> laws_that_remember_vectors() {
  std::vector<json> laws = {
      {{"law", "cohesive"}, {"parameters", {{"stiffness", 1e4}, {"strength", 1e3}, {"toughness", 1e3}}}},
      {{"law", "rccm"},
       {"parameters", {{"normal_stiffness", 1e4}, {"tangential_stiffness", 1e4}, {"adhesion_energy", 1e3}}}}};
  for (const auto& folder : fs::directory_iterator(ILAW_SOURCE "/tests/laws"))
    if (std::ifstream file(folder.path() / "cases.json"); file)
      for (const json& entry : json::parse(file).value("frame", json::array()))
        laws.push_back({{"law", folder.path().filename()}, {"parameters", entry["parameters"]}});
  return laws;
}

// From time 0.5 on the second point is driven against a rigid floor, which ends the run.
TEST(TurningObstacle, LeavesNoTraceOfARefusedStep) {
  for (const json& law : laws_that_remember_vectors()) {
    GIVEN(law["law"]);
    json source = on_spinning_sphere(law, {0, -1, -10});
    source["model"]["points"].push_back({{"mass", 1}, {"position", {9, 0, 0.5}}});
    source["interfaces"][0]["nodes"] = {0};
    source["interfaces"].push_back(json::parse(R"({"law": "contact", "nodes": [1],
        "obstacle": {"type": "plane", "point": [0, 0, 0], "normal": [0, 0, 1]}})"));
    source["loads"].push_back({{"type", "motion"}, {"nodes", {1}}, {"axes", {2}}, {"velocity", {0, 0, -1}}});
    auto [scene, integrator] = simulation_of(source);
    const auto state = [&found = *scene.interfaces[0], &u = integrator.displacement()] {
      return found.state_at(0, u);
    };
    std::vector<double> before = state();
    const auto step_to_the_floor = [&] {
      while (integrator.steps() < scene.steps) {
        before = state();
        integrator.step();
      }
    };
    EXPECT_THROW(step_to_the_floor(), std::runtime_error);
    EXPECT_NEAR(integrator.time(), 0.49, 0.011);  // of the last step that was made, one or two before
    EXPECT_EQ(state(), before);
  }
}

}  // namespace
}  // namespace ilaw::host::testing::turning
