// Scenes as an analyst writes them: each runs without a warning and gives what can be derived by hand.
#include "run_result.hpp"

#include <numeric>

namespace ilaw::host::testing::analyst_scenes {
namespace {

fs::path file_of(const std::string& name) {
  return fs::path(ILAW_SOURCE) / "tests/host/analyst_scenes" / (name + ".json");
}

// The scene may be run from elsewhere.
json scene_in(const fs::path& file) {
  json scene = read_scene_source(file);
  scene.erase("expect");  // its values belong to the scene as it is
  if (scene["model"].contains("meshes"))
    for (json& mesh : scene["model"]["meshes"])
      mesh["file"] = (file.parent_path() / mesh["file"].get<std::string>()).string();
  return scene;
}

json scene_named(const std::string& name) { return scene_in(file_of(name)); }

TEST(AnalystScenes, HaveTheMeshesOfTheirScripts) {
  const auto folder = fresh_folder(), scenes = file_of("arch").parent_path();
  ASSERT_EQ(run_command("python3 " + (scenes / "arch.py").string() + " " + folder.string()).code, 0);
  ASSERT_EQ(
      run_command("python3 " + (scenes / "bracket.py").string() + " " + (folder / "bracket.vtu").string())
          .code,
      0);
  for (const char* made : {"arch.vtu", "arch.json", "bracket.vtu"})
    EXPECT_EQ(text_of(folder / made), text_of(scenes / made)) << made;
}

// ---- mistakes and warnings -----------------------------------------------------------------------------

TEST(Mistakes, StandInALineEach) {
  json scene = scene_named("stack");
  scene["tim"] = 1;
  scene["time"]["end"] = "soon";
  const Outcome outcome = run_scene(scene);
  EXPECT_EQ(outcome.code, 2);
  for (const char* mistake : {"/time/end: found \"soon\"", "/tim: unknown key"}) {
    const std::size_t at = outcome.output.find(mistake);
    ASSERT_NE(at, std::string::npos) << outcome.output;
    const std::string before = outcome.output.substr(0, at);
    EXPECT_TRUE(before.ends_with("\n  ") || before.ends_with("scene.json: ")) << outcome.output;
  }
  EXPECT_EQ(std::count(outcome.output.begin(), outcome.output.end(), '\n'), 2) << outcome.output;
}

std::string warnings_of(const json& scene) {
  std::string text;
  for (const std::string& warning : scene_of(scene).warnings) text += warning + "\n";
  return text;
}

TEST(Warnings, TellOfAMemoryOfLessThanTwoSteps) {
  json scene = json::parse(
      R"({"model": {"type": "points", "dimension": 1, "points": [{"mass": 1, "position": [0], "area": 1}]},
    "time": {"dt": 1e-3, "end": 1}, "interfaces": [{"law": "postit", "parameters": {"initial_adhesion": 1},
      "nodes": "all", "obstacle": {"type": "plane", "point": [0], "normal": [1]}}]})");
  json& memory = scene["interfaces"][0]["parameters"]["memory"];
  for (const json& enough : {json(0.0), json(0.002), json("inf")}) {
    memory = enough;
    EXPECT_EQ(warnings_of(scene), "") << enough;
  }
  memory = 0.00199;
  const std::string said = warnings_of(scene);
  EXPECT_THAT(said,
              StartsWith("/interfaces/0/parameters/memory: found 0.00199, less than two steps of 0.001"));
}

TEST(Warnings, TellOfPartnersThatDoNotFaceTheirNodes) {
  json scene = scene_named("lap_joint");
  scene["interfaces"][0]["nodes"] = {36, 37};
  scene["interfaces"][0]["against"] = {{"nodes", {22, 23}}, {"normal", {0, 0, 1}}};
  EXPECT_EQ(warnings_of(scene), "");
  scene["interfaces"][0]["against"]["nodes"] = {23, 22};
  EXPECT_THAT(warnings_of(scene),
              HasSubstr("/interfaces/0/against/nodes: node 36 and its partner 23 are 0.005"));
  scene["interfaces"][0]["against"]["nodes"] = {22, 36};
  EXPECT_THAT(warnings_of(scene), HasSubstr("/interfaces/0/against/nodes: found node 36 more than once"));
}

// The nodes of a face are in an order that depends on its axis and side.
TEST(Partners, OfTwoFacesFaceEachOther) {
  for (int axis = 0; axis < 3; ++axis)
    for (const bool swapped : {false, true}) {
      json scene = json::parse(R"({"model": {"type": "blocks", "blocks": [
          {"name": "low", "size": [1, 2, 3], "elements": [2, 3, 4], "material": {"type": "linear", "young": 1, "poisson": 0, "density": 1}},
          {"name": "up", "size": [1, 2, 3], "elements": [2, 3, 4], "material": {"type": "linear", "young": 1, "poisson": 0, "density": 1}}]},
          "time": {"cfl": 0.5, "end": 1}, "interfaces": [{"law": "contact"}]})");
      std::array<double, 3> corner{}, normal{};
      corner[axis] = axis + 1.0;
      normal[axis] = swapped ? -1.0 : 1.0;
      scene["model"]["blocks"][1]["corner"] = corner;
      std::array<std::string, 2> faces{std::string("up.") + "xyz"[axis] + "_min",
                                       std::string("low.") + "xyz"[axis] + "_max"};
      scene["interfaces"][0]["nodes"] = faces[swapped];
      scene["interfaces"][0]["against"] = {{"nodes", faces[!swapped]}, {"normal", normal}};
      const Scene read = scene_of(scene.dump());
      const Interface& interface = *read.interfaces[0];
      const std::vector<int>& partners = interface.setup().counterpart->partners();
      ASSERT_EQ(partners.size(), interface.nodes().size());
      for (std::size_t k = 0; k < partners.size(); ++k)
        EXPECT_LT((read.model->position(interface.nodes()[k]) - read.model->position(partners[k])).norm(),
                  1e-12)
            << faces[swapped] << " node " << k;
      EXPECT_EQ(read.warnings.size(), 0U);
    }
}

}  // namespace
}  // namespace ilaw::host::testing::analyst_scenes
