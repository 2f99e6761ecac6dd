// Scenes of many points: read from a table, stepped in blocks, by any number of threads.
#include "run_result.hpp"

#include <omp.h>

#include <numeric>

namespace ilaw::host::testing::large_scene {
namespace {

// Points that fall on a plane, each at its own time: enough for several chunks.
json falling_points(std::size_t count) {
  Random random(5);
  json points = json::array();
  for (std::size_t k = 0; k < count; ++k)
    points.push_back({{"mass", 0.5 + random(0.0, 1.0)},
                      {"position", {static_cast<double>(k), 0.0, 1e-3 * random(0.0, 1.0)}},
                      {"velocity", {random(0.0, 1.0), 0.0, -random(0.0, 1.0)}}});
  return {{"model", {{"type", "points"}, {"dimension", 3}, {"points", points}}},
          {"time", {{"dt", 1.1e-4}, {"end", 4e-3}}},
          {"loads", {{{"type", "gravity"}, {"acceleration", {0.0, 0.0, -10.0}}}}},
          {"interfaces",
           {{{"law", "postit"},
             {"parameters", {{"friction", 0.3}, {"memory", 1e-3}}},
             {"nodes", "all"},
             {"obstacle", {{"type", "plane"}, {"point", {0, 0, 0}}, {"normal", {0, 0, 1}}}}}}}};
}

struct Result {
  Dofs u, v;
  EnergyReport energy;
};

Result result_of(Scene scene, int threads, bool asks_energies = true) {
  omp_set_num_threads(threads);
  for (const auto& interface : scene.interfaces) interface->ask_energies(asks_energies);
  host::Integrator integrator = unaudited(scene);
  while (integrator.steps() < scene.steps) integrator.step();
  omp_set_num_threads(1);
  return {integrator.displacement(), integrator.velocity(), integrator.energy()};
}

TEST(LargeScene, MovesTheSameWhetherEnergiesAreAskedForOrNot) {
  const std::string points = falling_points(3000).dump();
  const Result asked = result_of(scene_of(points), 1), not_asked = result_of(scene_of(points), 1, false);
  EXPECT_EQ(asked.u, not_asked.u);
  EXPECT_EQ(asked.v, not_asked.v);
  EXPECT_EQ(asked.energy.interface_work, not_asked.energy.interface_work);
  EXPECT_GT(asked.energy.by_law[ILAW_ENERGY_IMPACT], 0.0);
  for (const double energy : not_asked.energy.by_law) EXPECT_EQ(energy, 0.0);
}

TEST(LargeScene, GivesTheSameBitsInAnyOrderOfNodesAndNumberOfThreads) {
  const json ordered = falling_points(5000);
  const Result one = result_of(scene_of(ordered), 1), two = result_of(scene_of(ordered), 3);
  EXPECT_EQ(one.u, two.u);
  EXPECT_EQ(one.v, two.v);
  EXPECT_EQ(one.energy.interface_work, two.energy.interface_work);
  EXPECT_EQ(one.energy.by_law, two.energy.by_law);
  ASSERT_LT(one.energy.interface_work, 0.0);

  json shuffled = ordered;
  std::vector<int> nodes(5000);
  std::iota(nodes.begin(), nodes.end(), 0);
  std::shuffle(nodes.begin(), nodes.end(), std::mt19937_64(6));
  shuffled["interfaces"][0]["nodes"] = nodes;
  const Result gathered = result_of(scene_of(shuffled), 1);
  EXPECT_EQ(one.u, gathered.u);
  EXPECT_EQ(one.v, gathered.v);
}

// Twice, by a checkpoint that knows its table.
TEST(LargeScene, HasItsPointsInATable) {
  json source = falling_points(100);
  const Scene written = scene_of(source);
  const auto folder = fresh_folder();
  std::ofstream table(folder / "points.csv");
  table << "mass,area,x0,x1,x2,v0,v1,v2\n";
  for (const json& point : source["model"]["points"]) {
    table << point["mass"] << ",1";
    for (const char* key : {"position", "velocity"})
      for (const json& component : point[key]) table << ',' << component;
    table << '\n';
  }
  table.close();
  source["model"]["points"] = "points.csv";
  const Scene read = read_scene(source, folder / "scene.json");
  EXPECT_EQ(read.model->mass(), written.model->mass());
  EXPECT_EQ(read.model->position(), written.model->position());
  EXPECT_EQ(read.model->initial_velocity(), written.model->initial_velocity());
  std::ofstream(folder / "scene.json") << source.dump();
  const std::string run = "run " + (folder / "scene.json").string() + " --out " + (folder / "out").string();
  EXPECT_EQ(run_program(run + " --checkpoint-every 10").code, 0);
  EXPECT_EQ(run_program(run + " --resume").code, 0);
  std::ofstream(folder / "points.csv", std::ios::app) << "1,1,0,0,1,0,0,0\n";
  EXPECT_THAT(run_program(run + " --resume"), Exits(2, HasSubstr("is of other meshes or points")));
}

TEST(LargeScene, TellsAMistakeInItsTable) {
  json source = falling_points(1);
  source["model"]["points"] = "points.csv";
  const auto folder = fresh_folder();
  const std::string header = "mass,area,x0,x1,x2,v0,v1,v2\n";
  for (const auto& [text, expected] :
       {std::pair<std::string, std::string>{"", "the columns mass, area, x0, x1, x2, v0, v1, v2"},
        {"mass,area,x0,v0\n", "the columns mass, area, x0, x1, x2, v0, v1, v2"},
        {header, "at least one point"},
        {header + "1,1,0,0,0,0,0\n", "found point 0"},
        {header + "1,1,0,0,0,0,0,0\n-1,1,0,0,0,0,0,0\n", "found point 1"}}) {
    std::ofstream(folder / "points.csv") << text;
    try {
      read_scene(source, folder / "scene.json");
      ADD_FAILURE() << text;
    } catch (const SceneError& error) {
      EXPECT_THAT(error.what(), AllOf(StartsWith("/model/points: "), HasSubstr(expected)));
    }
  }
}

}  // namespace
}  // namespace ilaw::host::testing::large_scene
