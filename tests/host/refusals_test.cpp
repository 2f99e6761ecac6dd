// A mistake in a scene is answered with the JSON pointer, what was found and what is allowed.
#include "host_runner.hpp"

namespace ilaw::host::testing {
namespace {

json good_scene() {
  return json::parse(R"({"model": {"type": "points", "dimension": 2,
      "points": [{"mass": 1.0, "position": [0.0, 1.0]}, {"mass": 1.0, "position": [1.0, 1.0]}]},
    "time": {"dt": 1e-3, "end": 0.1},
    "loads": [{"type": "gravity", "acceleration": [0.0, -10.0]}],
    "interfaces": [{"law": "coulomb", "parameters": {"friction": 0.1}, "nodes": "all",
                    "obstacle": {"type": "plane", "point": [0.0, 0.0], "normal": [0.0, 1.0]}}],
    "output": {"every": 1, "watch": [0]}})");
}

struct Mistake {
  const char* pointer;  // where a value is put
  const char* value;
  const char* message;  // how the refusal begins

  friend void PrintTo(const Mistake& mistake, std::ostream* out) {
    *out << mistake.pointer << " = " << mistake.value;
  }
};

class Mistakes : public ::testing::TestWithParam<Mistake> {};

TEST_P(Mistakes, AreNamedWithPointerFoundAndAllowed) {
  json scene = good_scene();
  scene[json::json_pointer(GetParam().pointer)] = json::parse(GetParam().value);
  const std::string refusal = refusal_of(scene);
  EXPECT_EQ(refusal.substr(0, std::string(GetParam().message).size()), GetParam().message) << refusal;
}

const Mistake scene_mistakes[] = {
    {"/interface", "[]",
     "/interface: unknown key, expected one of: converge, doc, exact, expect, fields, initial, interfaces, loads, "
     "model, output, prestress, sets, springs, study, time, title, units (did you mean 'interfaces'?)"},
    {"/model/type", "\"bar\"", "/model/type: found \"bar\", expected one of \"points\""},
    {"/model/dimension", "4", "/model/dimension: found 4, expected integer >= 1 and <= 3"},
    {"/model/points/1/mass", "0", "/model/points/1/mass: found 0, expected number > 0"},
    {"/model/points/1/mass", "\"heavy\"", "/model/points/1/mass: found \"heavy\", expected number > 0"},
    {"/model/points/1/position", "[1.0]",
     "/model/points/1/position: found 1 components, expected 2, the dimension of the model"},
    {"/time/dt", "-1", "/time/dt: found -1, expected number > 0"},
    {"/time/cfl", "0.5", "/time: found both 'dt' and 'cfl', expected one of 'dt' and 'cfl'"},
    {"/time/end", "1e300", "/time: end/dt is"},
    {"/loads/0/type", "\"wind\"",
     "/loads/0/type: found \"wind\", expected one of \"gravity\", \"force\", \"shock\""},
    {"/loads/0/direction", "[1, 0]",
     "/loads/0/direction: unknown key, expected one of: acceleration, history, name, nodes, type"},
    {"/loads/0/nodes", "[7]", "/loads/0/nodes/0: found node 7, expected 0 to 1"},
    {"/interfaces/0/nodes", "[0, 2]", "/interfaces/0/nodes/1: found node 2, expected 0 to 1"},
    {"/interfaces/0/nodes", "[-1]", "/interfaces/0/nodes/0: found -1, expected integer >= 0"},
    {"/interfaces/0/nodes", "[2147483648]", "/interfaces/0/nodes/0: found node 2147483648, expected 0 to 1"},
    {"/loads/0/nodes", "[4294967296]", "/loads/0/nodes/0: found node 4294967296, expected 0 to 1"},
    {"/loads/0/nodes", "[18446744073709551615]", "/loads/0/nodes/0: found "},
    {"/loads/0/nodes", "[0, 0.5]", "/loads/0/nodes/1: found 0.5, expected integer >= 0"},
    {"/loads/0/nodes", "{\"near\": [\"x\", 0]}", "/loads/0/nodes/near/0: found \"x\", expected number"},
    {"/interfaces/0/nodes", "[0, 0]", "/interfaces/0/nodes/1: found node 0 twice, expected each node once"},
    {"/interfaces/0/nodes", "\"some\"", "/interfaces/0/nodes: found \"some\", expected one of all"},
    {"/interfaces/0/law", "\"glue\"", "/interfaces/0/law: 'glue': no glue.so found, expected it in one of: "},
    {"/interfaces/0/library", "\"./nowhere.so\"", "/interfaces/0/library: "},
    {"/interfaces/0/parameters/friction", "-1",
     "/interfaces/0/parameters/friction: law 'coulomb': parameter 'friction' = -1 is not allowed: expected "
     "a number in [0, inf]"},
    {"/interfaces/0/parameters/fricton", "1",
     "/interfaces/0/parameters/fricton: law 'coulomb': unknown parameter 'fricton': expected one of "
     "friction, "},
    {"/interfaces/0/parameters/friction", "[1]",
     "/interfaces/0/parameters/friction: found [1], expected a number or \"inf\""},
    {"/interfaces/0/parameters/friction", "{\"per_node\": [0.1]}",
     "/interfaces/0/parameters/friction/per_node: found 1 values, expected 2, one per node of the "
     "interface"},
    {"/interfaces/0/parameters/friction", "{\"table\": []}",
     "/interfaces/0/parameters/friction/table: found [], expected at least one entry"},
    {"/interfaces/0/parameters/friction", "{\"table\": [[0, 1], [1, -1]]}",
     "/interfaces/0/parameters/friction/table: law 'coulomb': parameter 'friction' = -1"},
    {"/interfaces/0/parameters", "{}",
     "/interfaces/0/parameters: law 'coulomb': parameter 'friction' is missing"},
    {"/interfaces/0/death", "0", "/interfaces/0/death: found 0, expected a time after birth, 0.0"},
    {"/model/points/0/stiffness", "[0, 4.1e6]", "/time/dt: found 0.001, expected at most 0.000987"},
    {"/interfaces/0/obstacle/normal", "[0, 0]",
     "/interfaces/0/obstacle/normal: found a vector of length 0, expected a direction"},
    {"/output/watch", "[2]", "/output/watch/0: found node 2, expected 0 to 1"},
    {"/output/watch", "[4294967296]", "/output/watch/0: found node 4294967296, expected 0 to 1"},
    {"/output/every", "18446744073709551615",
     "/output/every: found 18446744073709551615, expected integer >= 1"},
    {"/output/every", "0", "/output/every: found 0, expected integer >= 1"},
    {"/output/every", "1.5", "/output/every: found 1.5, expected integer >= 1"}};
INSTANTIATE_TEST_SUITE_P(Scene, Mistakes, ::testing::ValuesIn(scene_mistakes));

const Mistake obstacle_mistakes[] = {
    {"/interfaces/0/against", R"({"nodes": [1], "normal": [0, 1]})",
     "/interfaces/0: found both 'obstacle' and 'against', expected one of 'obstacle' (rigid) and "
     "'against' (another body)"},
    {"/interfaces/0/obstacle", R"({"type": "cylinder", "point": [0, 0], "axis": [0, 1], "radius": 1})",
     "/interfaces/0/obstacle/type: found \"cylinder\" in 2D, expected a model in 3D"},
    {"/interfaces/0/obstacle/rate", "1",
     "/interfaces/0/obstacle/rate: found \"plane\" in 2D, expected none: it cannot turn and keep"},
    {"/interfaces/0/obstacle",
     R"({"type": "sphere", "center": [0, 0], "radius": 1, "rate": 1, "angles": [[0, 0], [1, 1]]})",
     "/interfaces/0/obstacle: found both 'rate' and 'angles', expected at most one of them"},
    {"/interfaces/0/obstacle",
     R"({"type": "sphere", "center": [0, 0], "radius": 1, "rate": 1, "axis": [0, 1]})",
     "/interfaces/0/obstacle/axis: found [0,1], expected none: discs turn in their plane"},
    {"/interfaces/0/obstacle",
     R"({"type": "plane", "point": [0, 0], "normal": [0, 1], "velocity": [0, 1],
                    "path": [[0, 0, 0], [1, 0, 0]]})",
     "/interfaces/0/obstacle: found both 'velocity' and 'path', expected at most one of them"},
    {"/interfaces/0/obstacle/path", "[[0, 0, 0], [1, 0]]",
     "/interfaces/0/obstacle/path/1: found 2 numbers, expected 3 (time and values)"},
    {"/interfaces/0/obstacle/path", "[[0, 0, 0], [0, 1, 0]]",
     "/interfaces/0/obstacle/path/1: found time 0, expected one after 0"},
    {"/interfaces/0/tangent", "[0, 1]",
     "/interfaces/0/tangent: found [0,1], expected a direction across the normal"}};
INSTANTIATE_TEST_SUITE_P(Obstacle, Mistakes, ::testing::ValuesIn(obstacle_mistakes));

const Mistake against_mistakes[] = {
    {"/interfaces/0", R"({"law": "contact", "nodes": [0], "against": {"nodes": [1]}})",
     "/interfaces/0/against: found {\"nodes\":[1]}, expected 'nodes' and 'normal', or 'surface'"},
    {"/interfaces/0", R"({"law": "contact", "nodes": [0, 1], "against": {"nodes": [1], "normal": [0, 1]}})",
     "/interfaces/0/against/nodes: found 1 nodes, expected one for each of the 2 nodes of the"},
    {"/interfaces/0", R"({"law": "contact", "nodes": [0], "against": {"nodes": [0], "normal": [0, 1]}})",
     "/interfaces/0/against/nodes: node 0 would meet itself, expected another node"},
    {"/interfaces/0",
     R"({"law": "coulomb", "nodes": [0], "parameters": {"friction": 1}, "tangent": [1, 0],
                    "obstacle": {"type": "sphere", "center": [0, 0], "radius": 0.1}})",
     "/interfaces/0/tangent: found a tangent, expected none: the normal of the counterpart turns"}};
INSTANTIATE_TEST_SUITE_P(Against, Mistakes, ::testing::ValuesIn(against_mistakes));

// Whole scenes, of one point on a line or of a block.
const Mistake whole_mistakes[] = {
    {"",
     R"({"model": {"type": "points", "dimension": 1, "points": [{"mass": 1, "position": [0], "area": 0}]},
                        "time": {"dt": 1e-3, "end": 1}, "interfaces": [],
                        "loads": [{"type": "force", "nodes": "all", "direction": [1], "total": true,
                                   "history": [[0, 1]]}]})",
     "/loads/0/nodes: the nodes have no area to share a total force by"},
    {"", R"({"model": {"type": "points", "dimension": 1, "points": [{"mass": 1, "position": [0]}]},
                        "time": {"dt": 1e-3, "end": 1}, "interfaces": [],
                        "loads": [{"name": "pull", "type": "force", "nodes": "all", "direction": [1],
                                   "history": [[0, 1]]}],
                        "output": {"forces": [{"of": "pull", "about": [0]}]}})",
     "/output/forces/0/about: found [0], expected none: forces on a line have no moment"},
    {"", R"({"model": {"type": "points", "dimension": 1, "points": [{"mass": 1, "position": [0]}]},
                        "time": {"dt": 1e-3, "end": 1}, "interfaces": [], "output": {"forces": ["pull"]}})",
     "/output/forces/0: found \"pull\", expected the name of an interface, of a load, of springs, or of a "
     "set that a motion drives: the scene has none"},
    {"", R"({"model": {"type": "points", "dimension": 1, "points": [{"mass": 1, "position": [0]}]},
                        "time": {"dt": 1e-3, "end": 1}, "interfaces": [],
                        "loads": [{"type": "shock", "nodes": "all", "time": 0, "impulse": [1]}]})",
     "/loads/0/time: found 0, expected a time > 0"},
    {"",
     R"({"model": {"type": "blocks", "blocks": [{"name": "b", "size": [1, 1, 1], "elements": [1, 1, 1],
                          "material": {"type": "linear", "young": 1, "poisson": 0.3, "density": 1}}]},
                        "time": {"cfl": 0.9, "end": 1},
                        "interfaces": [{"law": "contact", "nodes": "b.x_min", "against": {"surface": "b.z_max"}}]})",
     "/interfaces/0/against/surface: node 4 would meet its own facet, expected the surface of another"},
    {"",
     R"({"model": {"type": "blocks", "blocks": [{"name": "b", "size": [1, 1, 1], "elements": [1, 1, 1],
                          "material": {"type": "linear", "young": 1, "poisson": 0.3, "density": 1}}]},
                        "time": {"cfl": 0.9, "end": 1},
                        "interfaces": [{"law": "contact", "nodes": "b.z_min", "obstacle": {"type": "sphere",
                          "center": [0, 0, -1], "radius": 1, "rate": 1}}]})",
     "/interfaces/0/obstacle: key 'axis' is missing, about which the sphere turns"}};
INSTANTIATE_TEST_SUITE_P(Whole, Mistakes, ::testing::ValuesIn(whole_mistakes));

const Mistake names_mistakes[] = {
    {"/interfaces/1",
     R"({"name": "interface0", "law": "contact", "nodes": [0],
                    "obstacle": {"type": "plane", "point": [0, 0], "normal": [0, 1]}})",
     "/interfaces/1/name: found 'interface0' twice, expected a different name for each"},
    {"/output/forces", "[\"interface0\", \"interface0\"]",
     "/output/forces/1: found 'interface0' twice, expected each once"},
    {"/output/forces", "[{\"of\": \"interface\"}]",
     "/output/forces/0/of: found \"interface\", expected the name of an interface, of a load"},
    {"/loads/0/name", "\"interface0\"", "/loads/0/name: found 'interface0' twice, expected a name that"},
    {"/interfaces/0/nodes", R"({"box": [[5, 5], [6, 6]]})",
     "/interfaces/0/nodes/box: found no node inside, expected at least one"},
    {"/loads/0", R"({"type": "motion", "nodes": [0], "axes": [2]})",
     "/loads/0/axes: found axis 2, expected 0 to 1"},
    {"/loads/0", R"({"type": "motion", "nodes": [0]})",
     "/interfaces/0/nodes: found node 0, which a motion drives along all axes, expected a node that is"},
    {"/interfaces/0/parameters/friction", R"({"values": [0.1, 0.2]})",
     "/interfaces/0/parameters/friction: found {\"values\":[0.1,0.2]}, expected a number, \"inf\""},
    {"/interfaces/0/parameters/friction", R"({"table": 3})",
     "/interfaces/0/parameters/friction/table: found 3, expected an array"},
    {"/interfaces/0/parameters/friction", R"({"table": [[0, 1], [1]]})",
     "/interfaces/0/parameters/friction/table/1: found [1], expected [time, value]"},
    {"/interfaces/0/parameters/friction", R"({"table": [[0, 1], [1, "high"]]})",
     "/interfaces/0/parameters/friction/table/1/1: found \"high\", expected a number or \"inf\""}};
INSTANTIATE_TEST_SUITE_P(Names, Mistakes, ::testing::ValuesIn(names_mistakes));

const Mistake springs_mistakes[] = {
    {"/springs", R"([{"nodes": [0], "stiffness": 1, "to": [1], "anchor": [0, 0]}])",
     "/springs/0: found both 'to' and 'anchor', expected one of 'to' (nodes) and 'anchor' (a fixed"},
    {"/springs", R"([{"nodes": [0], "anchor": [0, 0]}])",
     "/springs/0: found {\"anchor\":[0,0],\"nodes\":[0]}, expected 'stiffness', 'damping' or both"},
    {"/springs", R"([{"nodes": [0, 1], "stiffness": 1, "to": [1]}])",
     "/springs/0/to: found 1 nodes, expected one for each of the 2 nodes of 'nodes'"},
    {"/springs", R"([{"nodes": [0], "stiffness": 1, "to": [0]}])",
     "/springs/0/to: found node 0 at both ends, expected another node"}};
INSTANTIATE_TEST_SUITE_P(Springs, Mistakes, ::testing::ValuesIn(springs_mistakes));

TEST(Scene, OfAnotherKindOfValueIsRefused) {
  EXPECT_THAT(refusal_of("[]"), StartsWith("/: found [], expected object"));
  for (const char* pointer : {"/model", "/model/type", "/interfaces/0", "/interfaces/0/obstacle", "/loads/0",
                              "/interfaces/0/obstacle/type", "/loads", "/interfaces"}) {
    json scene = good_scene();
    scene[json::json_pointer(pointer)] = 3;
    EXPECT_THAT(refusal_of(scene), StartsWith(std::string(pointer) + ": found 3, expected "));
  }
}

TEST(Scene, WithManyMistakesNamesSomeAndCountsTheOthers) {
  json scene = good_scene();
  for (int k = 0; k < 30; ++k) scene["key" + std::to_string(k)] = k;
  const std::string refusal = refusal_of(scene);
  EXPECT_THAT(refusal, StartsWith("/key0: unknown key"));
  EXPECT_EQ(refusal.substr(refusal.size() - 5), " more") << refusal;
}

TEST(Scene, WithAMissingKeyIsRefused) {
  json scene = good_scene();
  scene["interfaces"][0].erase("nodes");
  EXPECT_EQ(refusal_of(scene).substr(0, 44), "/interfaces/0: key 'nodes' is missing, found");
}

TEST(Scene, ThatIsNoJsonIsRefused) {
  EXPECT_THAT(refusal_of("{"), HasSubstr("not valid JSON"));
  EXPECT_THAT(refusal_of(R"({"time": {"dt": 1e999}})"), HasSubstr("not valid JSON"));
  EXPECT_THAT(refusal_of(R"({"time": {}, "time": {}})"), HasSubstr("key 'time' appears twice"));
}

// Far beyond what a reader that goes into values by recursion could stand.
TEST(Scene, NestedTooDeepIsRefusedWhereItIs) {
  const std::string refusal = "values are nested more than 64 deep, expected at most that";
  for (const int depth : {65, 100000}) {
    GIVEN(depth);
    const auto n = static_cast<std::size_t>(depth);
    const std::string arrays = std::string(n, '[') + std::string(n, ']');
    EXPECT_EQ(refusal_of(arrays), "/: " + refusal);
    EXPECT_EQ(refusal_of(R"({"time": {"dt": 1e-3}, "interfaces": )" + arrays + "}"),
              "/interfaces: " + refusal);
    std::string objects = "1";
    for (int k = 0; k < 65; ++k) objects = "{\"a\": " + objects + "}";
    EXPECT_EQ(refusal_of(R"({"model": )" + objects + "}"), "/model: " + refusal);
  }
}

TEST(Scene, WithMoreNodesThanNumbersIsRefused) {
  json scene = json::parse(R"({"model": {"type": "bars", "bars": []}, "time": {"cfl": 0.9, "end": 1.0},
                               "interfaces": []})");
  for (int k = 0; k < 22; ++k)
    scene["model"]["bars"].push_back(
        {{"length", 1.0}, {"elements", 100000000}, {"young", 1.0}, {"density", 1.0}});
  EXPECT_EQ(refusal_of(scene),
            "/model/bars/4/elements: found 100000000, which makes 500000005 nodes, expected at most 5e8");
}

// The bounds of a range are all told, also those that do not belong to it.
TEST(Scene, TellsWhereARangeEnds) {
  json scene = json_of(scene_files::named("block_impact.json"));
  scene["model"]["blocks"][0]["material"]["poisson"] = 0.5;
  EXPECT_EQ(refusal_of(scene), "/model/blocks/0/material/poisson: found 0.5, expected number > -1 and < 0.5");
}

TEST(Scene, WhoseLibraryIsNoLibraryIsRefusedThere) {
  const auto folder = fresh_folder();
  std::ofstream(folder / "law.so") << "a text";
  json scene = good_scene();
  scene["interfaces"][0]["library"] = (folder / "law.so").string();
  EXPECT_THAT(refusal_of(scene), StartsWith("/interfaces/0/library: " + (folder / "law.so").string()));
}

// ---- steps and warnings ---------------------------------------------------------------------------------

// At the critical step itself a run is stable; what is beyond is refused where that is exact.
TEST(Step, MayBeCriticalButNoLarger) {
  json scene = json_of(scene_files::named("two_bars.json"));
  const double critical = 0.01;  // elements of 0.01, waves at 1
  scene["time"] = {{"dt", critical}, {"end", 0.1}};
  EXPECT_EQ(refusal_of(scene), "not refused");
  scene["time"]["dt"] = critical * (1.0 + 1e-12);
  EXPECT_THAT(refusal_of(scene), StartsWith("/time/dt: found 0.01"));
  EXPECT_THAT(refusal_of(scene), HasSubstr("the model's critical step"));
}

std::vector<std::string> warnings_of(const char* pointer, const char* value) {
  json scene = good_scene();
  scene[json::json_pointer(pointer)] = json::parse(value);
  return scene_of(scene).warnings;
}

// A scene that can run, but can hardly be meant, runs with a warning.
TEST(Warnings, TellWhatCanHardlyBeMeant) {
  using Warnings = std::vector<std::string>;
  EXPECT_EQ(warnings_of("/title", "\"as it is\""), Warnings{});
  EXPECT_EQ(warnings_of("/loads/0", R"({"type": "shock", "nodes": [0], "time": 0.2, "impulse": [0, 1]})"),
            Warnings{"/loads/0/time: found 0.2, after the end of the run, 0.1"});
  EXPECT_EQ(warnings_of("/interfaces/0/birth", "0.11"),
            Warnings{"/interfaces/0/birth: found 0.11, after the end of the run, 0.1"});
  EXPECT_EQ(warnings_of("/time/dt", "0.5"),
            Warnings{"/time/end: found 0.1, less than one step, 0.5, which is taken all the same"});
  EXPECT_EQ(warnings_of("/output/every", "101"),
            Warnings{"/output/every: found 101: the history has the last of 100 steps alone"});
  EXPECT_EQ(
      warnings_of("/interfaces/0/obstacle", R"({"type": "sphere", "center": [0.5, 1], "radius": 0.75})"),
      Warnings{"/interfaces/0: 2 node(s) start inside the obstacle, node 0 by 0.25"});
  const Warnings deep = warnings_of("/interfaces/0/obstacle",
                                    R"({"type": "plane", "point": [0, 1.00000001], "normal": [0, 1]})");
  ASSERT_EQ(deep.size(), 1U) << "beyond rounding, though small beside the bodies";
  EXPECT_EQ(deep[0].find("/interfaces/0: 2 node(s) start inside the obstacle"), 0U) << deep[0];
}

// For blocks the critical step is a bound from below.
TEST(Warnings, TellOfAStepThatMayBeUnstable) {
  json scene = json_of(scene_files::named("block_impact.json"));
  scene["time"] = {{"dt", 1e-3}, {"end", 0.01}};
  const std::vector<std::string> warnings = scene_of(scene).warnings;
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_THAT(warnings[0], StartsWith("/time/dt: found 0.001, which may be unstable"));
}

// 36 nodes of the upper block 1 cm inside the lower one.
TEST(Warnings, TellOfAnOverlapWithASurface) {
  json scene = json_of(scene_files::named("two_blocks.json"));
  scene["model"]["blocks"][1]["corner"][2] = 0.09;
  const std::vector<std::string> warnings = scene_of(scene).warnings;
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_THAT(warnings[0], StartsWith("/interfaces/1: 36 node(s) start inside the other body, node "));
  EXPECT_THAT(warnings[0], HasSubstr(" by 0.01"));
  scene["interfaces"][1]["gap_offset"] = -0.0101;
  EXPECT_TRUE(scene_of(scene).warnings.empty());
}

TEST(Warnings, TellOfElementsThatLock) {
  json scene = json_of(scene_files::named("block_impact.json"));
  json& block = scene["model"]["blocks"][0];
  block["material"]["poisson"] = 0.499;
  const std::vector<std::string> warnings = scene_of(scene).warnings;
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_THAT(warnings[0],
              StartsWith("/model/blocks/0/material/poisson: found 0.499, at which full elements"));
  block["element"] = "mean_dilatation";
  EXPECT_TRUE(scene_of(scene).warnings.empty());
  block["element"] = "reduced";
  EXPECT_EQ(refusal_of(scene),
            "/model/blocks/0/element: found \"reduced\", expected one of \"full\", \"mean_dilatation\"");
}

TEST(Warnings, AreNotForTheShippedScenes) {
  for (const fs::path& file : scene_files::all()) {
    std::vector<std::string> warnings = scene_of(text_of(file)).warnings;
    // A square bar glued to an oblique plane: two of its corners are off it.
    if (file.filename() == "mixed_mode_bar.json")
      std::erase_if(warnings, [](const auto& text) { return text.find("open gap") != std::string::npos; });
    EXPECT_TRUE(warnings.empty()) << file << ": " << warnings.front();
  }
}

TEST(Scene, TakesInfinityTablesAndValuesPerNode) {
  for (const char* friction :
       {"\"inf\"", "{\"table\": [[0, 0.1], [1, 0.5]]}", "{\"per_node\": [0.1, \"inf\"]}"}) {
    json scene = good_scene();
    scene["interfaces"][0]["parameters"]["friction"] = json::parse(friction);
    auto [read, integrator] = simulation_of(scene);
    EXPECT_NO_THROW(while (integrator.steps() < read.steps) integrator.step());
  }
}

}  // namespace
}  // namespace ilaw::host::testing
