// Blocks on blocks, with meshes that match or not, and the border of a surface.
#include "run_result.hpp"

namespace ilaw::host::testing::stacked {
namespace {

// Block b on block a of a unit square, each of a height, that meet from one side or both.
json stacked_blocks(double height, const std::array<int, 3>& elements_a, const std::array<int, 3>& elements_b,
                    const json& material, bool both_sides = true) {
  json source = scene_of_blocks(
      {block("a", {0, 0, 0}, {1, 1, height}, elements_a, material),
       block("b", {0, 0, height}, {1, 1, height}, elements_b, material)},
      R"([{"name": "joint", "law": "contact", "nodes": "b.z_min", "against": {"surface": "a.z_max"}}])");
  if (both_sides) source["interfaces"][0]["against"]["both_sides"] = true;
  return source;
}

// The normal impulses of a face over its nodes' areas.
std::vector<double> pressures_on(const char* name, const Scene& scene, const Dofs& impulse) {
  const NodeSet& face = scene.model->sets().at(name);
  std::vector<double> pressures;
  for (std::size_t k = 0; k < face.nodes.size(); ++k)
    pressures.push_back(std::abs(impulse[3 * face.nodes[k] + 2]) / face.areas[k]);
  return pressures;
}

// A block on another with a different mesh, in contact from both sides, under a pressure that grows until
// 0.2.
json pressed_blocks(const std::array<int, 3>& low, const std::array<int, 3>& high, double end) {
  json source = stacked_blocks(0.5, low, high, elastic(1e6, 0.3, 1000));
  source["time"] = {{"cfl", 0.9}, {"end", end}};
  source["loads"] = json::parse(R"([
      {"type": "motion", "nodes": "a.z_min", "axes": [2]}, {"type": "damping", "rate": 60},
      {"type": "pressure", "surface": "b.z_max", "history": {"rows": [[0, 0], [0.2, 1000]], "smooth": true}}])");
  return source;
}

// Contacts of both sides are redundant, and their gaps differ by rounding: below that there is no better
// solution, for which iterations would creep. A pressure with lateral strain comes to rest.
TEST(NonMatchingMeshes, AreSolvedToTheRoundingOfTheirGaps) {
  auto [scene, integrator] = run_to_end(pressed_blocks({3, 3, 2}, {5, 5, 2}, 0.8));
  EXPECT_EQ(integrator.tally().unconverged, 0);
  EXPECT_LT(integrator.tally().sweeps_max, 300) << "iterations crept";
  const Dofs impulse = integrator.interface_impulse();
  double sum = 0.0;
  for (const int node : scene.model->sets().at("b.z_min").nodes) sum += impulse[3 * node + 2];
  EXPECT_NEAR(sum / scene.dt, 1000.0, 1.0);  // the loaded face has grown by 2 * 0.3 * 1e-3
  EXPECT_THAT(pressures_on("b.z_min", scene, impulse / sum), Each(DoubleNear(1.0, 1e-8)));
}

// While a load grows, faces are not quite flat: redundant contacts contradict each other by rounding, and
// iterations alone would creep until one of them opens.
TEST(NonMatchingMeshes, AreSolvedWhileALoadGrows) {
  auto [scene, integrator] = run_to_end(pressed_blocks({6, 6, 3}, {10, 10, 5}, 0.1));
  EXPECT_EQ(integrator.tally().unconverged, 0);
  EXPECT_LE(integrator.energy().balance_error, 1e-12);
}

// Each side has half of the areas: a bond keeps its strength. The scene may be read again.
TEST(NonMatchingMeshes, ShareAreasBetweenBothSides) {
  json source = stacked_blocks(1, {2, 2, 1}, {3, 3, 1}, elastic(1, 0, 1));
  source["time"] = {{"cfl", 0.5}, {"end", 0.1}};
  for (int time = 0; time < 2; ++time) {
    const Scene scene = read_scene(source, "joint.json");
    source = scene.source;
    ASSERT_EQ(scene.interfaces.size(), 2U);
    EXPECT_EQ(scene.interfaces[1]->name(), "joint_other_side");
    for (const auto& interface : scene.interfaces) {
      double area = 0.0;
      for (const double part : interface->setup().areas) area += part;
      EXPECT_NEAR(area, 0.5, 1e-15) << interface->name();
    }
  }
}

// The shipped patch test: all nodes bear p times their area from both sides. The loaded face grows by the
// lateral strain, so that p = 1000 (1 + 0.3 p/E)^2.
TEST(NonMatchingMeshes, PassThePatchTestThatIsShipped) {
  double pressure = 1000.0;
  for (int k = 0; k < 20; ++k) pressure = 1000.0 * std::pow(1.0 + 0.3e-6 * pressure, 2);
  json source = shipped("patch_test");
  for (const double cfl : {0.9, 0.71, 0.999}) {
    GIVEN(cfl);
    source["time"]["cfl"] = cfl;
    auto [scene, integrator] = run_to_end(source);
    EXPECT_EQ(integrator.tally().unconverged, 0);
    const Dofs share = integrator.interface_impulse() / (scene.dt * pressure);
    for (const char* name : {"high.z_min", "low.z_max"})
      EXPECT_THAT(pressures_on(name, scene, share), Each(DoubleNear(1.0, 1e-7))) << name;
    std::vector<double> one_side = pressures_on("high_2.z_min", scene, share);
    for (const double one : pressures_on("low_2.z_max", scene, share)) one_side.push_back(one);
    EXPECT_THAT(one_side, AllOf(Contains(Lt(0.9)), Contains(Gt(1.05)))) << "one side alone fails it";
    for (const int node : scene.model->sets().at("high.z_max").nodes)
      EXPECT_NEAR(integrator.displacement()[3 * node + 2], -1e-6 * pressure, 1e-11);
  }
}

// ---- the border of a surface ----------------------------------------------------------------------------

// Two equal stacked blocks; the lower one goes aside and back by a part of its width, then all rests again.
json moved_stack(double aside) {
  json source = stacked_blocks(1, {4, 4, 2}, {4, 4, 2}, elastic(1e6, 0, 1000), false);
  source["time"] = {{"cfl", 0.7}, {"end", 1}};
  source["loads"] = json::parse(R"([
      {"type": "damping", "rate": 60}, {"type": "gravity", "nodes": "b", "acceleration": [0, 0, -10]},
      {"type": "motion", "nodes": "a.z_min", "axes": [0, 1, 2]},
      {"type": "motion", "nodes": "b.z_max", "axes": [0, 1]}])");
  source["loads"][2]["path"] = {{0, 0, 0, 0}, {0.3, aside, 0, 0}, {0.6, 0, 0, 0}};
  source["output"] = {{"every", 5}, {"watch", {"b.z_min"}}, {"forces", {"joint"}}};
  return source;
}

// All nodes stay on the surface, where only rounding or a small motion says that they left it.
TEST(Border, HoldsAStackThatMovesALittle) {
  for (const double aside : {1e-6, 1e-3, 1e-2}) {
    GIVEN(aside);
    const Ran run = ran(moved_stack(aside));
    for (const auto& [name, column] : run.history)
      EXPECT_TRUE(!name.ends_with(".gap") || column.back() > -1e-9 - 0.3 * aside * aside) << column.back();
    EXPECT_NEAR(run.last("joint.F2"), 10000.0, 1.0);
    EXPECT_THAT(run.summary["warnings"], IsEmpty());
  }
}

// Nodes that go over the border while they touch are told of.
TEST(Border, WarnsOfNodesThatLeaveIt) {
  const Ran run = ran(moved_stack(0.1));
  ASSERT_EQ(run.summary["warnings"].size(), 1U) << run.summary["warnings"];
  EXPECT_THAT(run.summary["warnings"][0].get<std::string>(), HasSubstr("went over the border of a surface"));
}

// A block that falls past another with a side clearance of 0.03 edges is not caught.
TEST(Border, DoesNotCatchWhatFallsPast) {
  json source = moved_stack(0.0);
  source["model"]["blocks"][1]["corner"] = {1.0075, 0, 1.2};
  source["model"]["blocks"][1]["velocity"] = {0, 0, -1};
  source["loads"].erase(3);
  source["loads"].erase(0);
  source["time"] = {{"cfl", 0.2}, {"end", 0.4}};
  EXPECT_EQ(ran(source).summary["forces"]["joint"]["impulse"][2].get<double>(), 0.0);
}

// At rest the floor carries the weight, friction holds what the plane of symmetry does, and then it is
// shaken.
TEST(SettledStack, RestsOnItsFloorAndIsShaken) {
  json source = shipped("settled_stack");
  for (const double cfl : {0.9, 0.71, 0.999}) {
    GIVEN(cfl);
    source["time"]["cfl"] = cfl;
    const Ran run = ran(source);
    double largest = 0.0;
    for (std::size_t k = 0; k < run.rows(); ++k) {
      const double time = run["time"][k];
      if (time > 1.0) largest = std::max(largest, run["floor.F2"][k]);
      if (time < 0.8 || time > 0.9) continue;
      EXPECT_NEAR(run["floor.F2"][k], 2080.0, 1e-2);
      EXPECT_NEAR(run["joint.F2"][k], 1280.0, 1e-2);
      EXPECT_NEAR(run["floor.F0"][k], -run["symmetry_plane.F0"][k], 1e-2);
    }
    EXPECT_GT(largest, 2080.0 + 400.0);
    EXPECT_LT(run.energy("balance_error"), 1e-13);
  }
}

}  // namespace
}  // namespace ilaw::host::testing::stacked
