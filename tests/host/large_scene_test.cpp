// Scenes of many points: read packed, stepped in blocks, by any number of threads.
#include "host_runner.hpp"

#include <omp.h>

#include <numeric>

namespace ilaw::host::testing {
namespace {

// Points that fall on a plane, each at its own time: enough for packed text and several chunks.
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
  Integrator integrator = integrator_of(scene);
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

TEST(LargeScene, IsReadPackedToTheSameNumbers) {
  const json source = falling_points(5000);
  const Scene packed = scene_of(source), plain = read_scene(source, "scene.json");
  EXPECT_TRUE(packed.source["model"]["points"].is_binary());
  EXPECT_TRUE(plain.source["model"]["points"].is_array());
  EXPECT_EQ(packed.model->mass(), plain.model->mass());
  EXPECT_EQ(packed.model->position(), plain.model->position());
  EXPECT_EQ(packed.model->initial_velocity(), plain.model->initial_velocity());
}

// Two thousand million elements: found before any memory is asked for.
TEST(LargeScene, OfMoreElementsThanNumbersIsRefused) {
  json scene = json_of(scene_files::named("two_blocks.json"));
  scene["model"]["blocks"][1]["elements"] = {2000, 1000, 1000};
  try {
    scene_of(scene);
    FAIL() << "not refused";
  } catch (const SceneError& error) {
    const std::string refusal = error.what(),
                      begin = "/model/blocks/1/elements: found [2000,1000,1000], which makes ";
    EXPECT_THAT(refusal, StartsWith(begin));
    EXPECT_THAT(refusal, HasSubstr(" nodes, expected at most 5e8"));
  }
}

TEST(LargeScene, TellsAMistakeInAPointByItsPointer) {
  const auto refusal_of = [](const json& point) -> std::string {
    json source = falling_points(5000);
    source["model"]["points"][4321] = point;
    try {
      scene_of(source);
    } catch (const SceneError& error) {
      return error.what();
    }
    return "none";
  };
  const json right = {{"mass", 1.0}, {"position", {0, 0, 1}}};
  EXPECT_EQ(refusal_of(right), "none");
  for (const auto& [key, value, expected] :
       {std::tuple<const char*, json, const char*>{"mass", -1.0, "/model/points/4321/mass"},
        {"mass", "1", "/model/points/4321/mass"},
        {"area", -1, "/model/points/4321/area"},
        {"position", {0, 0}, "/model/points/4321/position"},
        {"position", 1, "/model/points/4321/position"},
        {"velocity", {0, 0, nullptr}, "/model/points/4321/velocity/2"},
        {"velocty", {0, 0, 1}, "/model/points/4321/velocty"}}) {
    json point = right;
    point[key] = value;
    const std::string found = refusal_of(point);
    EXPECT_THAT(found, StartsWith(expected)) << point;
  }
}

}  // namespace
}  // namespace ilaw::host::testing
