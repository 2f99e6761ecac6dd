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

}  // namespace
}  // namespace ilaw::host::testing::initial
