// A step that is refused leaves no trace in what laws remember on an obstacle that turns.
#include "host_runner.hpp"

namespace ilaw::host::testing::turning {
namespace {

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

// A point on a sphere that starts to spin: as the start is faster than the bound on speeds, that step is
// solved more than once. From time 0.5 on a second point is driven against a rigid floor, which ends the run.
TEST(TurningObstacle, LeavesNoTraceOfARefusedStep) {
  for (const json& law : laws_that_remember_vectors()) {
    GIVEN(law["law"]);
    json source = json::parse(R"({"model": {"type": "points", "dimension": 3, "points": [
        {"mass": 1, "position": [0.1, 0, 0.79372539331937719]}, {"mass": 1, "position": [9, 0, 0.5]}]},
      "time": {"dt": 0.01, "end": 1}, "loads": [{"type": "gravity", "acceleration": [0, -1, -10]},
        {"type": "motion", "nodes": [1], "axes": [2], "velocity": [0, 0, -1]}],
      "interfaces": [{"nodes": [0], "obstacle": {"type": "sphere", "center": [0, 0, 0], "radius": 0.8,
                                                 "axis": [0, 0, 1], "angles": [[0, 0], [0.2, 0], [1.2, 20]]}},
        {"law": "contact", "nodes": [1], "obstacle": {"type": "plane", "point": [0, 0, 0], "normal": [0, 0, 1]}}]})");
    source["interfaces"][0].update(law);
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
