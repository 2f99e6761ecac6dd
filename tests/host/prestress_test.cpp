// Runs that start from static equilibrium, against closed forms.
#include "run_result.hpp"

#include <chrono>
#include <csignal>
#include <numeric>
#include <thread>

namespace ilaw::host::testing::prestress {
namespace {

constexpr double young = 1e6, density = 1000.0, acceleration = 10.0, height = 0.5, side = 0.1;
constexpr double weight = density * acceleration * height * side * side;

// A column on a floor, under its weight.
json column(double cfl) {
  json source = scene_of_blocks(
      {block("b", {0, 0, 0}, {side, side, height}, {1, 1, 6}, elastic(young, 0, density))},
      R"([{"name": "floor", "law": "coulomb", "parameters": {"friction": 0.3}, "nodes": "b.z_min",
           "obstacle": {"type": "plane", "point": [0, 0, 0], "normal": [0, 0, 1]}}])");
  source["prestress"] = {{"tolerance", 1e-8}};
  source["time"] = {{"cfl", cfl}, {"end", 0.2}};
  source["loads"] = json::parse(R"([{"type": "gravity", "acceleration": [0, 0, -10]}])");
  source["output"] =
      json::parse(R"({"watch": [{"near": [0, 0, 0.5]}], "forces": ["floor"], "balance": true})");
  return source;
}

// A bar, a cube and a stack of three blocks, each of height 1 on a floor under its weight.
std::vector<json> standing_bodies() {
  json of_bar = scene_of_bars({bar("b", 0, 1, 40, young, density)}, {law_on("b.left", ground(1), "contact")},
                              {gravity({-10})});
  const json material = elastic(young, 0, density), friction = {{"friction", 0.3}};
  json of_cube = scene_of_blocks({block("b", {0, 0, 0}, {1, 1, 1}, {4, 4, 4}, material)},
                                 {law_on("b.z_min", ground(3), "coulomb", friction)});
  std::vector<json> blocks, joints{law_on("b0.z_min", ground(3), "coulomb", friction)};
  for (int k = 0; k < 3; ++k) {
    const std::string name = "b" + std::to_string(k);
    blocks.push_back(block(name.c_str(), {0, 0, k / 3.0}, {1, 1, 1 / 3.0}, {2, 2, 2}, material));
    if (k > 0)
      joints.push_back(law_between(name + ".z_min", {{"surface", "b" + std::to_string(k - 1) + ".z_max"}},
                                   "coulomb", friction));
  }
  json of_stack = scene_of_blocks(blocks, joints);
  for (json* scene : {&of_cube, &of_stack}) (*scene)["loads"] = {gravity({0, 0, -10})};
  return {of_bar, of_cube, of_stack};
}

// The step of the run has no part in it. At a height z bodies sink by rho g (z - z^2/2)/E.
TEST(Prestress, TakesFewStepsWhateverTheRun) {
  for (const json& body : standing_bodies()) {
    std::set<std::int64_t> steps;
    for (const double cfl : {0.999, 0.5, 0.03}) {
      GIVEN(body["model"]["type"], body["interfaces"].size(), cfl);
      json source = until_at_cfl(1.0, cfl, body);
      source["prestress"] = json::object();
      auto [scene, integrator] = simulation_of(source);
      integrator.start();
      const int d = scene.model->dimension();
      for (int node = 0; node < scene.model->node_count(); ++node) {
        const double z = scene.model->position(node)[d - 1];
        EXPECT_NEAR(integrator.displacement()[d * node + d - 1],
                    -density * acceleration * (z - 0.5 * z * z) / young, 1e-7);
      }
      steps.insert(integrator.prestressed()->steps);
    }
    EXPECT_EQ(steps.size(), 1U);
    EXPECT_LE(*steps.begin(), 400);
  }
}

// It ends at its next step, too, without results but a summary that says so.
TEST(Prestress, EndsAtAnInterrupt) {
  const auto folder = fresh_folder();
  json source = column(0.9);
  source["prestress"] = {{"tolerance", 1e-300}, {"steps", 1000000000}};
  const pid_t child =
      start_program({"run", written(source, folder), "--out", folder.string()}, folder / "messages");
  for (int k = 0; k < 5000 && !fs::exists(folder / "history.csv.partial"); ++k)
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  kill(child, SIGTERM);
  int status = 0;
  waitpid(child, &status, 0);
  EXPECT_EQ(WEXITSTATUS(status), 1);
  EXPECT_TRUE(json_of(folder / "summary.json")["interrupted"]);
  EXPECT_THAT(text_of(folder / "messages"), HasSubstr("interrupted at step 0 of "));
}

}  // namespace
}  // namespace ilaw::host::testing::prestress
