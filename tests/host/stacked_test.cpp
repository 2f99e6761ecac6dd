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

}  // namespace
}  // namespace ilaw::host::testing::stacked
