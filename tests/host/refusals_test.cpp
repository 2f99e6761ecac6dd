// Scenes that are refused before they are read as one, and warnings; refusals.json has the refusals of one
// key.
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

TEST(Scene, WithManyMistakesNamesSomeAndCountsTheOthers) {
  json scene = good_scene();
  for (int k = 0; k < 30; ++k) scene["key" + std::to_string(k)] = k;
  const std::string refusal = refusal_of(scene);
  EXPECT_THAT(refusal, StartsWith("/key0: unknown key"));
  EXPECT_EQ(refusal.substr(refusal.size() - 5), " more") << refusal;
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

TEST(Scene, WhoseLibraryIsNoLibraryIsRefusedThere) {
  const auto folder = fresh_folder();
  std::ofstream(folder / "law.so") << "a text";
  json scene = good_scene();
  scene["interfaces"][0]["library"] = (folder / "law.so").string();
  EXPECT_THAT(refusal_of(scene), StartsWith("/interfaces/0/library: " + (folder / "law.so").string()));
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

// A node on an edge of the box has more area than the face that the nodes are on.
TEST(Warnings, TellOfAreasOfEdges) {
  json scene = json_of(scene_files::named("block_impact.json"));
  json& interface = scene["interfaces"][0];
  interface["law"] = "cohesive";
  interface["parameters"] = {{"strength", 1.0}, {"toughness", 1.0}};
  interface["nodes"] = {{"box", {{-1, -1, -1}, {1, 1, 0.021}}}};
  EXPECT_THAT(scene_of(scene).warnings, Contains(StartsWith("/interfaces/0/nodes: node 0 lies on an edge")));
  interface["nodes"]["of"] = scene["model"]["blocks"][0].value("name", "block0") + std::string(".z_min");
  EXPECT_THAT(scene_of(scene).warnings, Not(Contains(HasSubstr("lies on an edge"))));
}

// Ten times the strength leaves a hundredth of the failure zone.
TEST(Warnings, TellOfACoarseFailureZone) {
  json scene = json_of(scene_files::named("dcb_peel.json"));
  EXPECT_TRUE(scene_of(scene).warnings.empty());
  json& strength = scene["interfaces"][0]["parameters"]["strength"];
  strength = 10.0 * strength.get<double>();
  const std::vector<std::string> warnings = scene_of(scene).warnings;
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_THAT(warnings[0], StartsWith("/interfaces/0/parameters/strength: found"));
  EXPECT_THAT(warnings[0], HasSubstr("three elements"));
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
    std::vector<std::string> warnings = read_scene(file).warnings;
    // A square bar glued to an oblique plane: two of its corners are off it.
    if (file.filename() == "mixed_mode_bar.json")
      std::erase_if(warnings, [](const auto& text) { return text.find("open gap") != std::string::npos; });
    EXPECT_TRUE(warnings.empty()) << file << ": " << warnings.front();
  }
}

}  // namespace
}  // namespace ilaw::host::testing
