// Parameters by the two materials that meet: a table of the scene against the same values written out.
#include "host_runner.hpp"

namespace ilaw::host::testing {
namespace {

// Four masses that slide on a plane, of rubber (0, 2) and steel (1, 3).
json sliders(double dt = 1e-3) {
  json scene =
      json::parse(R"({"model": {"type": "points", "dimension": 2, "points": []}, "time": {"end": 1.5},
    "sets": {"rubber": [0, 2], "steel": [1, 3]},
    "pairs": {"wet": [{"sides": ["rubber", "road"], "parameters": {"friction": 0.5, "restitution": 0.25}},
                      {"sides": ["steel", "road"], "parameters": {"friction": 0.2, "restitution": 0}}]},
    "loads": [{"type": "gravity", "acceleration": [0, -10]}],
    "interfaces": [{"law": "coulomb", "nodes": [3, 0, 1, 2], "pairs": "wet",
                    "obstacle": {"type": "plane", "name": "road", "point": [0, 0], "normal": [0, 1]}}]})");
  scene["time"]["dt"] = dt;
  for (int k = 0; k < 4; ++k)
    scene["model"]["points"].push_back({{"mass", 1 + k}, {"position", {0, 0}}, {"velocity", {2, 0}}});
  return scene;
}

Dofs end_of(const json& source) {
  auto [scene, integrator] = run_to_end(source);
  return integrator.displacement();
}

// Stopped after v^2/(2 mu g), up to what the steps round it to.
TEST(Pairs, GiveEachNodeThoseOfItsMaterials) {
  for (const double dt : {1e-3, 7e-4, 3.1e-4}) {
    const Dofs u = end_of(sliders(dt));
    for (int k = 0; k < 4; ++k) EXPECT_NEAR(u[2 * k], k % 2 == 0 ? 0.4 : 1.0, 2.0 * dt) << k << " " << dt;
  }
}

TEST(Pairs, HaveTheBitsOfValuesPerNode) {
  json written = sliders();
  written.erase("pairs");
  json& interface = written["interfaces"][0];
  interface.erase("pairs");
  interface["obstacle"].erase("name");
  interface["parameters"] = {{"friction", {{"per_node", {0.2, 0.5, 0.2, 0.5}}}},
                             {"restitution", {{"per_node", {0, 0.25, 0, 0.25}}}}};
  EXPECT_EQ(end_of(sliders()), end_of(written));
}

TEST(Pairs, HoldInBothOrdersUnlessTheOtherHasItsOwnRow) {
  json swapped = sliders();
  for (json& row : swapped["pairs"]["wet"]) row["sides"] = {row["sides"][1], row["sides"][0]};
  EXPECT_EQ(end_of(swapped), end_of(sliders()));
  json other = sliders();
  json row = other["pairs"]["wet"][0];
  row["sides"] = {"road", "rubber"};
  row["parameters"]["friction"] = 0.0;
  other["pairs"]["wet"].push_back(row);
  EXPECT_EQ(end_of(other), end_of(sliders()));
}

// One pair for all nodes is one number, also of a parameter that a law does not allow per node.
TEST(Pairs, OfOneKindAreANumber) {
  json scene = sliders();
  scene["interfaces"][0]["nodes"] = "steel";
  const Arguments arguments = scene_of(scene).interfaces[0]->setup().arguments;
  EXPECT_TRUE(arguments.per_node.empty());
  EXPECT_EQ(arguments.numbers.at("friction"), 0.2);
}

// Two upper blocks on one lower one, which moves by the friction of either.
json blocks() {
  return json::parse(R"({"model": {"type": "blocks", "blocks": [
      {"name": "table", "corner": [0, 0, 0], "size": [3, 1, 0.2], "elements": [3, 1, 1],
       "material": {"type": "linear", "young": 1e5, "poisson": 0.3, "density": 1000}},
      {"name": "left", "corner": [0.1, 0.2, 0.2], "size": [0.6, 0.6, 0.2], "elements": [1, 1, 1],
       "material": {"type": "linear", "young": 1e5, "poisson": 0.3, "density": 1000}},
      {"name": "right", "corner": [2.1, 0.2, 0.2], "size": [0.6, 0.6, 0.2], "elements": [1, 1, 1],
       "material": {"type": "linear", "young": 1e5, "poisson": 0.3, "density": 1000}}]},
    "sets": {"feet": {"box": [[0, 0, 0.19], [3, 1, 0.21]]}},
    "pairs": {"dry": [{"sides": ["left", "table"], "parameters": {"friction": 0.1}},
                      {"sides": ["table", "right"], "parameters": {"friction": 0.7}}]},
    "time": {"cfl": 0.5, "end": 0.2},
    "interfaces": [{"law": "coulomb", "nodes": "left.z_min", "pairs": "dry",
                    "against": {"surface": "table.z_max"}},
                   {"law": "coulomb", "nodes": "right.z_min", "pairs": "dry",
                    "against": {"surface": "table.z_max"}}]})");
}

TEST(Pairs, MeetSurfacesOfOneSide) {
  const Scene scene = scene_of(blocks().dump());
  EXPECT_EQ(scene.interfaces[0]->setup().arguments.numbers.at("friction"), 0.1);
  EXPECT_EQ(scene.interfaces[1]->setup().arguments.numbers.at("friction"), 0.7);
}

TEST(Pairs, AreRefusedWithPointerFoundAndAllowed) {
  const auto with = [](const char* pointer, const char* value) {
    json scene = sliders();
    scene[json::json_pointer(pointer)] = json::parse(value);
    return refusal_of(scene);
  };
  EXPECT_EQ(with("/interfaces/0/pairs", R"("wett")"),
            "/interfaces/0/pairs: found \"wett\", expected one of wet (did you mean 'wet'?)");
  EXPECT_EQ(with("/pairs/wet/0/sides", R"(["rubbr", "road"])"),
            "/pairs/wet: found the side 'rubbr', expected a set of nodes, or the name of an obstacle");
  EXPECT_EQ(
      with("/sets/rubber", "[0]"),
      "/interfaces/0/nodes: found node 2 in none of the sides, expected each node in one of road, rubber, "
      "steel");
  EXPECT_EQ(with("/sets/rubber", "[0, 1, 2]"),
            "/pairs/wet: found node 1 in 'rubber' and 'steel', expected sides that have no node in common");
  EXPECT_EQ(with("/interfaces/0/obstacle/name", R"("ice")"),
            "/pairs/wet: found the side 'road', expected a set of nodes, or the name of an obstacle");
  EXPECT_EQ(with("/pairs/wet/1/sides", R"(["steel", "steel"])"),
            "/interfaces/0/pairs: found no row for steel and road, expected one in the table");
  EXPECT_EQ(with("/pairs/wet/1/sides", R"(["rubber", "road"])"),
            "/pairs/wet/1/sides: found [\"rubber\",\"road\"] twice, expected each pair once");
  EXPECT_EQ(with("/pairs/wet/1/parameters", R"({"friction": 0.1})"),
            "/pairs/wet/1/parameters: found friction, expected friction, restitution, as in the other rows");
  EXPECT_EQ(
      with("/interfaces/0/parameters", R"({"friction": 0.1})"),
      "/interfaces/0/parameters/friction: found 'friction' here and in the table of 'pairs', expected one "
      "of them");
  EXPECT_THAT(with("/pairs/wet/0/parameters/friction", "-1"), HasSubstr("/interfaces/0/pairs: "));
  json nameless = sliders();
  nameless["interfaces"][0]["obstacle"].erase("name");
  nameless["pairs"]["wet"] =
      json::parse(R"([{"sides": ["rubber", "steel"], "parameters": {"friction": 0.1}}])");
  EXPECT_EQ(refusal_of(nameless),
            "/interfaces/0/obstacle: key 'name' is missing, the side of the obstacle in 'pairs'");
  json mixed = blocks();
  mixed["sets"] = json::parse(R"({"one": {"box": [[0, 0, 0], [1.1, 1, 0.21]], "of": "table"},
                                  "two": {"box": [[1.9, 0, 0], [3, 1, 0.21]], "of": "table"}})");
  mixed["pairs"]["dry"][0]["sides"] = {"left", "one"};
  mixed["pairs"]["dry"][1]["sides"] = {"right", "two"};
  EXPECT_EQ(
      refusal_of(mixed),
      "/interfaces/0/against/surface: found a surface of 'one' and 'two', expected an interface for each of "
      "them");
}

}  // namespace
}  // namespace ilaw::host::testing
