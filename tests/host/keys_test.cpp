// Keys of an interface beside its law: tangent, birth and death, offset of the gap,
// parameters that vary over time or from node to node.
#include "host_runner.hpp"

#include "results/history.hpp"

namespace ilaw::host::testing::keys {
namespace {

// Points on a plane through the origin, under gravity across it.
json points_on_plane(const std::vector<json>& points, const json& interface) {
  json scene = json::parse(R"({"model": {"type": "points", "dimension": 3},
    "time": {"dt": 0.001, "end": 0.2}, "loads": [{"type": "gravity", "acceleration": [0, 0, -10]}],
    "interfaces": [{"nodes": "all", "obstacle": {"type": "plane", "point": [0, 0, 0], "normal": [0, 0, 1]}}]})");
  scene["model"]["points"] = points;
  scene["interfaces"][0].update(interface);
  return scene;
}

json point(const json& position, const json& velocity) {
  return {{"mass", 2.0}, {"position", position}, {"velocity", velocity}};
}

// Watching makes no contact: contacts have the order of their nodes, of which steps make use.
TEST(Watched, NodesAreContactsInTheirOrder) {
  json scene =
      points_on_plane({point({0, 0, 0}, {0, 0, 0}), point({1, 0, 0}, {0, 0, 0}), point({2, 0, 0}, {0, 0, 0})},
                      {{"law", "tie"}});
  scene["output"] = {{"watch", {2, 1}}};
  auto [run, integrator] = simulation_of(scene);
  const auto folder = fresh_folder();
  History history(run, integrator);
  history.open(folder);
  history.add_row(integrator);
  EXPECT_EQ(run.interfaces[0]->contact_count(), 0U);
  integrator.step();
  history.add_row(integrator);
  for (int k = 0; k < 3; ++k) EXPECT_EQ(run.interfaces[0]->contact_at(k), k);
}

// Values are judged together, node by node: what the least of one and the largest of another would make does
// not count.
TEST(PerNode, IsJudgedNodeByNode) {
  const auto refusal = [](const json& law) {
    return refusal_of(points_on_plane({point({0, 0, 0}, {0, 0, 0}), point({1, 0, 0}, {0, 0, 0})}, law));
  };
  const auto cohesive = [&](const json& toughness) {
    return refusal({{"law", "cohesive"},
                    {"parameters",
                     {{"stiffness", 100},
                      {"strength", {{"per_node", {1, 10}}}},
                      {"toughness", {{"per_node", toughness}}}}}});
  };
  EXPECT_EQ(cohesive({0.1, 10}), "not refused");
  const std::string conflict = cohesive({10, 0.1});
  EXPECT_THAT(conflict, StartsWith("/interfaces/0/parameters/toughness/per_node/1: law 'cohesive': "));
  EXPECT_TRUE(conflict.ends_with(" (node 1)")) << conflict;
  EXPECT_EQ(refusal({{"law", "postit"},
                     {"parameters",
                      {{"initial_adhesion", {{"per_node", {0.1, 1}}}},
                       {"adhesion_limit", {{"per_node", {0.2, 2}}}}}}}),
            "not refused");
}

}  // namespace
}  // namespace ilaw::host::testing::keys
