// Scenes of many points: read packed, stepped in blocks, by any number of threads.
#include "host_runner.hpp"

#include "scene/packed_points.hpp"
#include "scene/validation.hpp"

#include <nlohmann/json.hpp>

#include <omp.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <numeric>
#include <random>
#include <string>
#include <vector>

namespace ilaw::host::testing {
namespace {

using nlohmann::json;

// Points that fall on a plane, each at its own time: enough for packed text and several chunks.
json falling_points(std::size_t count) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  json points = json::array();
  for (std::size_t k = 0; k < count; ++k)
    points.push_back({{"mass", 0.5 + uniform(random)},
                      {"position", {static_cast<double>(k), 0.0, 1e-3 * uniform(random)}},
                      {"velocity", {uniform(random), 0.0, -uniform(random)}}});
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
  const Result one = result_of(scene_of(ordered.dump()), 1), two = result_of(scene_of(ordered.dump()), 3);
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
  const Result gathered = result_of(scene_of(shuffled.dump()), 1);
  EXPECT_EQ(one.u, gathered.u);
  EXPECT_EQ(one.v, gathered.v);
}

TEST(LargeScene, IsReadPackedToTheSameNumbers) {
  const json source = falling_points(5000);
  const Scene packed = scene_of(source.dump()), plain = read_scene(source, "scene.json");
  EXPECT_TRUE(packed.source["model"]["points"].is_binary());
  EXPECT_TRUE(plain.source["model"]["points"].is_array());
  EXPECT_EQ(packed.model->mass(), plain.model->mass());
  EXPECT_EQ(packed.model->position(), plain.model->position());
  EXPECT_EQ(packed.model->initial_velocity(), plain.model->initial_velocity());
}

// The text of many points, one of which is given as text.
std::string text_with(const std::string& point) {
  static const std::string points = falling_points(5000).dump();
  std::string text = points;
  const std::size_t first = text.find("{\"mass\"");
  return text.replace(first, text.find('}', first) + 1 - first, point);
}

std::string point_with(const std::string& number) {
  return "{\"mass\": 1.5, \"position\": [" + number + ", 2, 3]}";
}

TEST(LargeScene, ReadsNumbersAsJsonHasThem) {
  std::string wrong;
  const auto expect = [&wrong](const std::string& number, bool is_right, const std::string& what) {
    if (!is_right && wrong.empty()) wrong = number + ": " + what;
  };
  std::vector<std::string> numbers{"0",
                                   "-0",
                                   "-0.0",
                                   "0e5",
                                   "7",
                                   "-12",
                                   "0.5",
                                   "1e5",
                                   "1E5",
                                   "1e+5",
                                   "1E-5",
                                   "-1.5e3",
                                   "5e-324",
                                   "1e308",
                                   "1e-400",
                                   "0.1",
                                   "18446744073709551615",
                                   "9007199254740993",
                                   "18446744073709551617",
                                   "0.30000000000000004440892098500626161694526672363281250000001"};
  std::mt19937_64 random(7);
  for (int k = 0; k < 20; ++k) {
    std::array<char, 64> text{};
    std::snprintf(
        text.data(), text.size(), k % 2 ? "%.*e" : "%.*g", 1 + k,
        std::ldexp(static_cast<double>(random() % 1000003), static_cast<int>(random() % 200) - 100));
    numbers.emplace_back(text.data());
  }
  for (const std::string& number : numbers) {
    const json read = parse_scene(text_with(point_with(number)))["model"]["points"];
    const double expected = json::parse(number).get<double>(),
                 found =
                     are_packed(read) ? unpacked(read)[0].position[0] : read[0]["position"][0].get<double>();
    expect(number, std::bit_cast<std::uint64_t>(found) == std::bit_cast<std::uint64_t>(expected),
           json(found).dump());
    expect(number, are_packed(read) || number == "1e-400", "not packed");
  }
  for (const char* number : {"", "+1", "01", "-01", ".5", "-.5", "1.", "1.e5", "1e", "1e+", "0x10", "nan",
                             "inf", "-inf", "1e999", "1 2", "1,", "--1", "1_000"}) {
    EXPECT_FALSE(json::accept(point_with(number)) && json::accept("[" + std::string(number) + "]")) << number;
    try {
      parse_scene(text_with(point_with(number)));
      expect(number, false, "accepted");
    } catch (const SceneError& error) {
      expect(number, std::string(error.what()).find("not valid JSON") != std::string::npos, error.what());
    }
  }
  EXPECT_EQ(wrong, "");
}

TEST(LargeScene, ReadsAnyTextOfThePointsAsJsonDoes) {
  const std::string plain = "{\"position\": [1, 2, 3], \"mass\": 2, \"area\": 0.5}";
  const json spaced =
      parse_scene(text_with("\n {\t\"position\" :\r[ 1 ,2\n, 3 ] , \"mass\":2,\"area\":0.5 } "));
  ASSERT_TRUE(are_packed(spaced["model"]["points"]));
  EXPECT_EQ(spaced, parse_scene(text_with(plain)));
  // Of a form that is not packed, with the same scene.
  EXPECT_EQ(parse_scene(text_with("{\"m\\u0061ss\": 2, \"position\": [1, 2, 3]}")),
            json::parse(text_with("{\"mass\": 2, \"position\": [1, 2, 3]}")));
  // What is wrong is told as of any scene, with its line.
  const auto refusal_of = [](const std::string& text) -> std::string {
    try {
      parse_scene(text);
    } catch (const SceneError& error) {
      return error.what();
    }
    return "none";
  };
  for (const char* point :
       {"{\"mass\": 1", "{\"mass\": 1,}", "{\"mass\" 1}", "{\"position\": [1,]}", "{mass: 1}", "{}}", ""})
    EXPECT_EQ(refusal_of(text_with(point)).find("not valid JSON"), 0U) << point;
  const std::string text = falling_points(5000).dump(1);
  const auto lines = std::count(text.begin(), text.end(), '\n');
  const std::string cut = refusal_of(text.substr(0, text.size() - 1));
  EXPECT_NE(cut.find("line " + std::to_string(lines + 1)), std::string::npos) << cut;
  EXPECT_NE(refusal_of(text_with("{\"mass\": 1, \"mass\": 2, \"position\": [1, 2, 3]}")).find("twice"),
            std::string::npos);
}

TEST(LargeScene, TellsAMistakeInAPointByItsPointer) {
  const auto refusal_of = [](const json& point) -> std::string {
    json source = falling_points(5000);
    source["model"]["points"][4321] = point;
    try {
      scene_of(source.dump());
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
    EXPECT_EQ(found.find(expected), 0U) << point << ": " << found;
  }
}

}  // namespace
}  // namespace ilaw::host::testing
