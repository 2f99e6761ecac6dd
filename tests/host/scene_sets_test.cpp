// Nodes by name, by place and by box: what a scene may say of nodes, wherever it names some.
#include "host_runner.hpp"

#include "results/history.hpp"

namespace ilaw::host::testing::scene_sets {
namespace {

// A cube of 4 x 4 x 2 elements, pulled at one corner region, held at another, dropped on a plane.
json cube() {
  return json::parse(R"({"model": {"type": "blocks", "blocks": [{"name": "cube", "size": [1, 1, 0.5],
      "elements": [4, 4, 2], "material": {"type": "linear", "young": 1, "poisson": 0.3, "density": 1}}]},
    "time": {"cfl": 0.8, "end": 1}, "interfaces": []})");
}

Dofs motion_of(const json& source) {
  auto [scene, integrator] = run_to_end(source);
  return integrator.velocity();
}

// A name means what it stands for, in every key that takes nodes.
TEST(NamedSets, StandWhereverNodesAreGiven) {
  const json grip = {{"box", {{-1, -1, -1}, {0.1, 2, 0.1}}}}, tab = {{"box", {{0.4, 0.4, 0.4}, {2, 2, 2}}}},
             pads = {{"box", {{0.2, 0.2, -1}, {0.8, 0.8, 0.1}}}, {"of", "cube.z_min"}}, pulled = {30, 31};
  const auto scene_with = [](const json& a, const json& b, const json& c, const json& d) {
    json scene = cube();
    scene["loads"] = {{{"type", "motion"}, {"nodes", a}},
                      {{"type", "force"}, {"nodes", b}, {"direction", {0, 0, -1}}, {"history", {{0, 0.01}}}},
                      {{"type", "gravity"}, {"nodes", d}, {"acceleration", {0.1, 0, 0}}}};
    scene["interfaces"] = {{{"law", "coulomb"},
                            {"nodes", c},
                            {"parameters", {{"friction", 0.3}}},
                            {"obstacle", {{"type", "plane"}, {"point", {0, 0, 0}}, {"normal", {0, 0, 1}}}}}};
    return scene;
  };
  json named = scene_with("grip", "tab", "pads", "pulled");
  named["sets"] = {{"grip", grip}, {"tab", tab}, {"pads", pads}, {"pulled", pulled}};
  named["output"] = {{"watch", {"pads"}}, {"forces", {"grip"}}};
  EXPECT_EQ(motion_of(named), motion_of(scene_with(grip, tab, pads, pulled)));
  const Scene scene = scene_of(named);
  EXPECT_EQ(scene.output.watch, scene.model->sets().at("pads").nodes);
  EXPECT_EQ(scene.output.watch.size(), 9U);
  ASSERT_EQ(scene.output.forces.size(), 1U);
  EXPECT_EQ(scene.output.forces[0].nodes, scene.model->sets().at("grip").nodes);
}

// A part of a face has the facets that lie in it: a surface for pressure and for other bodies.
TEST(NamedSets, KeepTheFacetsThatLieInThem) {
  json scene = cube();
  scene["sets"] = {{"patch", {{"box", {{0.2, 0.2, -1}, {0.8, 0.8, 0.1}}}, {"of", "cube.z_min"}}},
                   {"same", "cube.z_min"},
                   {"line", {{"box", {{-1, 0.2, -1}, {2, 0.3, 0.1}}}, {"of", "cube.z_min"}}}};
  const Scene read = scene_of(scene);
  EXPECT_EQ(read.model->sets().at("patch").facets.size(), 4U);
  EXPECT_EQ(read.model->sets().at("same").facets.size(), 16U);
  EXPECT_EQ(read.model->sets().at("line").nodes.size(), 5U);
  EXPECT_TRUE(read.model->sets().at("line").facets.empty());
}

TEST(Near, TakesAListOfPlaces) {
  json scene = cube();
  scene["output"]["watch"] = {{{"near", {{0.9, 0.1, 0.6}, {0.0, 0.3, 0.1}, {0.5, 0.5, 0.2}}}}};
  const Scene read = scene_of(scene);
  EXPECT_EQ(read.output.watch, (std::vector<int>{50 + 4, 5, 25 + 12}));
}

TEST(Watch, TakesABox) {
  json scene = cube();
  scene["output"]["watch"] = {0, {{"box", {{-0.1, -0.1, -0.1}, {0.3, 0.1, 0.1}}}}};
  EXPECT_EQ(scene_of(scene).output.watch, (std::vector<int>{0, 1}));
}

// The scene that docs/scenes.md begins with, and what the page says of it.
TEST(ScenesPage, BeginsWithASceneThatDoesWhatItSays) {
  std::ostringstream page;
  page << std::ifstream(fs::path(ILAW_SOURCE) / "docs/scenes.md").rdbuf();
  const std::string text = page.str(), fence = "```json\n";
  const std::size_t first = text.find(fence) + fence.size();
  Scene scene = scene_of(text.substr(first, text.find("```", first) - first));
  EXPECT_TRUE(scene.warnings.empty());
  Integrator integrator = integrator_of(scene);
  while (integrator.displacement()[1] > -0.45 + 1e-9) integrator.step();
  EXPECT_NEAR(integrator.time(), 0.3, 2e-3);
  while (integrator.time() < 0.302) integrator.step();
  EXPECT_NEAR(integrator.velocity()[0], 3.1, 0.02);
  while (integrator.velocity()[0] > 1e-12) integrator.step();
  EXPECT_NEAR(integrator.time(), 1.333, 5e-3);
  EXPECT_NEAR(integrator.displacement()[0], 2.80, 5e-3);
  EXPECT_LT(integrator.time(), 1.5);
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

// Watching makes no contact: contacts have the order of their nodes, of which steps make use.
TEST(Watched, NodesAreContactsInTheirOrder) {
  auto [run, integrator] = simulation_of(R"({"model": {"type": "points", "dimension": 1,
      "points": [{"mass": 2, "position": [0]}, {"mass": 2, "position": [0]}, {"mass": 2, "position": [0]}]},
    "time": {"dt": 0.001, "end": 0.2}, "interfaces": [{"law": "tie", "nodes": "all",
      "obstacle": {"type": "plane", "point": [0], "normal": [1]}}], "output": {"watch": [2, 1]}})");
  const auto folder = fresh_folder();
  History history(run, integrator);
  history.open(folder);
  history.add_row();
  EXPECT_EQ(run.interfaces[0]->contact_count(), 0U);
  integrator.step();
  history.add_row();
  for (int k = 0; k < 3; ++k) EXPECT_EQ(run.interfaces[0]->contact_at(k), k);
}

}  // namespace
}  // namespace ilaw::host::testing::scene_sets
