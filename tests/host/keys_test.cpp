// Keys of an interface beside its law: tangent, birth and death, offset of the gap,
// parameters that vary over time or from node to node.
#include "host_runner.hpp"

#include "results/history.hpp"

#include <chrono>

namespace ilaw::host::testing::keys {
namespace {

constexpr double g = 10.0, h = 1e-3;

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

Dofs velocity_after(const json& source, double time) {
  auto [scene, integrator] = simulation_of(source);
  while (integrator.time() < time - 0.5 * h) integrator.step();
  return integrator.velocity();
}

// ---- tangent --------------------------------------------------------------------------------------------

// Along one tangent a point slows down at mu_1 g, along the other at mu_2 g; the first tangent is turned by
// an angle from the axis x. The first step has half a step of gravity less to press with, and a row stands at
// a half step: one step's friction of difference at most.
TEST(Tangent, TellsWhichWayFrictionIsLarger) {
  constexpr double mu_1 = 0.1, mu_2 = 0.4, time = 0.2;
  for (const double angle : {0.0, 0.3, 1.2, 2.0}) {
    const Eigen::Vector3d t1(std::cos(angle), std::sin(angle), 0.0), t2(-t1[1], t1[0], 0.0);
    const auto along = [](const Eigen::Vector3d& t) { return json{t[0], t[1], t[2]}; };
    const json scene = points_on_plane({point({0, 0, 0}, along(t1)), point({1, 0, 0}, along(t2))},
                                       {{"law", "coulomb"},
                                        {"parameters", {{"friction", mu_1}, {"friction_2", mu_2}}},
                                        {"tangent", along(t1)}});
    const Dofs v = velocity_after(scene, time);
    const Eigen::Vector3d first = v.head<3>(), second = v.tail<3>();
    EXPECT_NEAR(first.dot(t1), 1.0 - mu_1 * g * time, mu_1 * g * h) << angle;
    EXPECT_NEAR(second.dot(t2), 1.0 - mu_2 * g * time, mu_2 * g * h) << angle;
    EXPECT_NEAR(first.dot(t2), 0.0, 1e-12) << "angle " << angle;
    EXPECT_NEAR(second.dot(t1), 0.0, 1e-12) << "angle " << angle;
  }
}

// ---- birth and death ------------------------------------------------------------------------------------

// A point rests on its plane until the plane dies, and then falls freely; where the plane is born later the
// point falls until then, below it, and is stopped.
TEST(BirthAndDeath, AreTheFirstStepWithAndTheFirstWithout) {
  const json resting = points_on_plane({point({0, 0, 0}, {0, 0, 0})}, {{"law", "contact"}, {"death", 0.1}});
  EXPECT_NEAR(velocity_after(resting, 0.099)[2], 0.0, 1e-15);
  EXPECT_NEAR(velocity_after(resting, 0.1)[2], -g * h, 1e-15);
  EXPECT_NEAR(velocity_after(resting, 0.2)[2], -g * 0.101, 1e-13);
  const json falling = points_on_plane({point({0, 0, 0}, {0, 0, 0})}, {{"law", "contact"}, {"birth", 0.1}});
  EXPECT_NEAR(velocity_after(falling, 0.099)[2], -g * 0.0995, 1e-13);
  EXPECT_NEAR(velocity_after(falling, 0.1)[2], 0.0, 1e-15);
}

// Its last status is not the node's any more.
TEST(BirthAndDeath, LeaveTheStatusFree) {
  json scene = points_on_plane({point({0, 0, 0}, {0, 0, 0})}, {{"law", "contact"}, {"death", 0.1}});
  scene["output"] = {{"watch", {0}}};
  auto [run, integrator] = simulation_of(scene);
  const auto folder = fresh_folder();
  History history(run, integrator);
  history.open(folder);
  while (integrator.steps() < run.steps) {
    integrator.step();
    history.add_row(integrator);
  }
  history.commit();
  std::ifstream file(folder / "history.csv");
  std::string row;
  std::getline(file, row);
  ASSERT_EQ(row.substr(row.rfind(',')), ",n0.status");
  for (int step = 1; std::getline(file, row); ++step)
    ASSERT_EQ(row.substr(row.rfind(',') + 1), std::to_string(int{step < 100 ? ILAW_CLOSED : ILAW_FREE}))
        << "step " << step;
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

// The state that a bond was born with waits for its birth: pulled all the time, it breaks R_Y/F after it.
TEST(BirthAndDeath, AgeNoState) {
  json scene =
      json::parse(R"({"model": {"type": "points", "dimension": 1, "points": [{"mass": 1, "position": [0]}]},
    "time": {"dt": 0.001, "end": 1}, "loads": [{"type": "force", "nodes": [0], "direction": [1], "history": [[0.3, 0], [0.3001, 2]]}],
    "interfaces": [{"law": "postit", "nodes": "all", "birth": 0.2, "parameters": {"initial_adhesion": 0.2, "memory": 1},
                    "obstacle": {"type": "plane", "point": [0], "normal": [1]}}]})");
  auto [run, integrator] = simulation_of(scene);
  while (integrator.velocity()[0] == 0.0) integrator.step();
  EXPECT_NEAR(integrator.time(), 0.3 + 0.2 / 2.0, 1.1e-3);
}

// ---- gap offset -----------------------------------------------------------------------------------------

// A ball of radius 0.25 stops with its centre that far from the plane; the history shows the gap of its skin.
TEST(GapOffset, IsTakenOffTheGap) {
  const json scene = points_on_plane(
      {point({0, 0, 0.25 + 0.05}, {0, 0, -1})},
      {{"law", "contact"}, {"gap_offset", 0.25}, {"parameters", {{"activation", "predictive"}}}});
  auto [run, integrator] = simulation_of(scene);
  EXPECT_NEAR(run.interfaces[0]->gap_at(0, integrator.displacement(), 0.0), 0.05, 1e-15);
  while (integrator.steps() < run.steps) integrator.step();
  EXPECT_NEAR(integrator.displacement()[2], -0.05, 1e-15);
  EXPECT_NEAR(run.interfaces[0]->gap_at(0, integrator.displacement(), 0.0), 0.0, 1e-15);
}

// ---- parameters that vary -------------------------------------------------------------------------------

// Friction that grows linearly from 0 to 0.6 within 0.1 and stays: the loss of speed is g times its integral.
TEST(Table, IsLinearBetweenItsTimesAndConstantOutside) {
  const json scene = points_on_plane(
      {point({0, 0, 0}, {5, 0, 0})},
      {{"law", "coulomb"}, {"parameters", {{"friction", {{"table", {{0.05, 0.0}, {0.15, 0.6}}}}}}}});
  const auto loss = [](double time) {
    if (time < 0.05) return 0.0;
    return time < 0.15 ? g * 3.0 * (time - 0.05) * (time - 0.05) : g * (0.03 + 0.6 * (time - 0.15));
  };
  for (const double time : {0.04, 0.08, 0.1, 0.14, 0.18, 0.2})
    EXPECT_NEAR(velocity_after(scene, time)[0], 5.0 - loss(time), g * 0.6 * h) << time;
}

// Each point is slowed down by its own friction, mu r_N at every step.
TEST(PerNode, GivesEachNodeItsOwn) {
  Random random(40);
  constexpr int count = 12;
  std::vector<json> points;
  json values = json::array();
  for (int k = 0; k < count; ++k) {
    // Some come down later than others: what waits in between must not mix up whose friction is whose.
    points.push_back(
        point({random(-3.0, 3.0), random(-3.0, 3.0), k % 2 ? random(0.0, 0.3) : 0.0}, {2, 0, 0}));
    values.push_back(random(0.05, 0.4));
  }
  values[0] = "inf";
  json scene =
      points_on_plane(points, {{"law", "coulomb"}, {"parameters", {{"friction", {{"per_node", values}}}}}});
  scene["time"]["end"] = 0.4;
  Scene run = scene_of(scene);
  Integrator integrator = integrator_of(run);
  std::vector<double> pressed(count), speed(count, 2.0);
  const auto expect_friction = [&] {
    for (int k = 0; k < count; ++k) {
      const auto i = static_cast<std::size_t>(k);
      const double r = integrator.interface_impulse()[3 * k + 2];
      const double mu = k == 0 ? INFINITY : values[i].get<double>();
      if (r > 0.0) speed[i] = std::max(0.0, speed[i] - mu * r / 2.0);
      pressed[i] += r;
      ASSERT_NEAR(integrator.velocity()[3 * k], speed[i], 1e-13) << k << " at " << integrator.time();
    }
  };
  integrator.start();
  expect_friction();
  while (integrator.steps() < run.steps) {
    integrator.step();
    expect_friction();
  }
  for (const double sum : pressed) EXPECT_GT(sum, 0.0);
}

// Numbers of an interface's own list, not of the model: here nodes 2 and 0, in this order.
TEST(PerNode, FollowsTheOrderOfTheInterface) {
  json scene = points_on_plane(
      {point({0, 0, 0}, {1, 0, 0}), point({1, 0, 0}, {1, 0, 0}), point({2, 0, 0}, {1, 0, 0})},
      {{"law", "coulomb"}, {"nodes", {2, 0}}, {"parameters", {{"friction", {{"per_node", {0.1, 0.3}}}}}}});
  const Dofs v = velocity_after(scene, 0.1);
  EXPECT_NEAR(v[6], 1.0 - 0.1 * g * 0.1, 0.1 * g * h);
  EXPECT_NEAR(v[0], 1.0 - 0.3 * g * 0.1, 0.3 * g * h);
  EXPECT_EQ(v[3], 1.0);
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
