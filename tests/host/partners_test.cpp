// Which nodes of two sets belong together, with which areas, and in which order they are contacts.
#include "host_runner.hpp"

#include "results/history.hpp"

namespace ilaw::host::testing::partners {
namespace {

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

// Faces have orders of their own.
TEST(Spring, JoinsNodesOfFacesThatFaceEachOther) {
  for (const std::string axis : {"x", "y", "z"}) {
    json scene = scene_of_blocks({block("cube", {0, 0, 0}, {2, 2, 2}, {2, 3, 4}, elastic(1, 0.3, 1))}, "[]");
    scene["springs"] = {{{"name", "grip"},
                         {"nodes", "cube." + axis + "_min"},
                         {"to", "cube." + axis + "_max"},
                         {"stiffness", 1}}};
    scene["output"] = {{"forces", {"grip"}}};
    const Scene read = scene_of(until_at_cfl(1, 0.5, scene));
    EXPECT_TRUE(read.warnings.empty()) << axis;
    for (const Spring& spring : read.output.forces.at(0).springs)
      EXPECT_NEAR(spring.length, 2.0, 1e-12) << axis;
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
}  // namespace ilaw::host::testing::partners
