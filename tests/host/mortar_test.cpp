// Two bodies with constraints that are integrated over the overlap of their faces: patch tests in contact,
// glued and with friction, borders, sliding, corners, and refusals.
#include "mesh_writer.hpp"
#include "run_result.hpp"

#include <Eigen/Geometry>

#include <atomic>
#include <new>

namespace {

std::atomic<long> allocations{0};

void* counted(std::size_t size) {
  ++allocations;
  if (void* made = std::malloc(size)) return made;
  throw std::bad_alloc();
}

}  // namespace

void* operator new(std::size_t size) { return counted(size); }
void* operator new[](std::size_t size) { return counted(size); }
void operator delete(void* room) noexcept { std::free(room); }
void operator delete[](void* room) noexcept { std::free(room); }
void operator delete(void* room, std::size_t) noexcept { std::free(room); }
void operator delete[](void* room, std::size_t) noexcept { std::free(room); }

namespace ilaw::host::testing {
namespace {

using Meshes = std::pair<std::array<int, 3>, std::array<int, 3>>;

// Block b on block a, both of a unit square and half as high. swapped: the nodes of a are the secondary ones.
json blocks_on_each_other(const Meshes& meshes, bool swapped, const json& law, double poisson) {
  json source =
      scene_of_blocks({block("a", {0, 0, 0}, {1, 1, 0.5}, meshes.first, elastic(1e6, poisson, 1000)),
                       block("b", {0, 0, 0.5}, {1, 1, 0.5}, meshes.second, elastic(1e6, poisson, 1000))},
                      "[]");
  json joint = law;
  joint["name"] = "joint";
  joint["nodes"] = swapped ? "a.z_max" : "b.z_min";
  joint["against"] = {{"surface", swapped ? "b.z_min" : "a.z_max"}, {"discretization", "dual_mortar"}};
  source["interfaces"] = {joint};
  source["time"] = {{"cfl", 0.9}, {"end", 0.8}};
  source["loads"] = json::parse(R"([{"type": "damping", "rate": 60}])");
  return source;
}
json in_contact() { return {{"law", "contact"}}; }
json with_friction(double friction) { return {{"law", "coulomb"}, {"parameters", {{"friction", friction}}}}; }

// A load per area on the upper face that grows for 0.2.
json pressure(double size) {
  return {{"type", "pressure"},
          {"surface", "b.z_max"},
          {"history", {{"rows", {{0, 0}, {0.2, size}}}, {"smooth", true}}}};
}
json motion(const char* nodes, const json& axes) {
  return {{"type", "motion"}, {"nodes", nodes}, {"axes", axes}};
}

// Impulses along an axis over the areas of the nodes, relative to their mean, of both faces.
std::vector<double> tractions(const Scene& scene, const Dofs& impulse, int axis) {
  std::vector<double> found;
  for (const char* name : {"a.z_max", "b.z_min"}) {
    const NodeSet& face = scene.model->sets().at(name);
    double sum = 0.0;
    for (const int node : face.nodes) sum += impulse[3 * node + axis];
    for (std::size_t k = 0; k < face.nodes.size(); ++k)
      found.push_back(impulse[3 * face.nodes[k] + axis] / (sum * face.areas[k]));
  }
  return found;
}

const std::vector<Meshes> patch_meshes{
    {{3, 3, 2}, {5, 5, 2}}, {{6, 6, 3}, {10, 10, 5}}, {{12, 12, 4}, {20, 20, 5}}};

// A plane wave runs into each block until it comes back.
TEST(DualMortar, BearsAUniformPressureOfImpact) {
  for (const Meshes& meshes : patch_meshes)
    for (const bool swapped : {false, true}) {
      GIVEN(swapped);
      json source = blocks_on_each_other(meshes, swapped, in_contact(), 0.0);
      source["model"]["blocks"][0]["velocity"] = {0, 0, 1};
      source["model"]["blocks"][1]["velocity"] = {0, 0, -1};
      source["time"]["end"] = 0.014;
      source.erase("loads");
      auto [scene, integrator] = simulation_of(source);
      integrator.start();
      Dofs impulse = integrator.interface_impulse();
      while (integrator.steps() < scene.steps) {
        integrator.step();
        impulse += integrator.interface_impulse();
      }
      EXPECT_THAT(tractions(scene, impulse, 2), Each(DoubleNear(1.0, 1e-10)));
      EXPECT_EQ(integrator.tally().unconverged, 0);
      EXPECT_LE(integrator.tally().sweeps_max, 40);
      EXPECT_LE(integrator.energy().balance_error, 1e-12);
    }
}

// Glued faces pass a uniform tension, and a uniform shear of bodies that are held along the other axes.
TEST(DualMortar, PassesTheGluedPatchTest) {
  const json tie = {{"law", "tie"}},
             cohesive = {{"law", "cohesive"},
                         {"parameters", {{"strength", 1e5}, {"toughness", 100}, {"stiffness", 1e9}}}};
  for (const json& law : {tie, cohesive})
    for (const bool swapped : {false, true})
      for (const int axis : {0, 2}) {
        GIVEN(axis);
        json source = blocks_on_each_other(patch_meshes[0], swapped, law, 0.3);
        if (axis == 2) {
          source["loads"].push_back(motion("a.z_min", {2}));
          source["loads"].push_back(pressure(-1000));
        } else {
          source["loads"].push_back(motion("all", {1, 2}));
          source["loads"].push_back(motion("a.z_min", {0}));
          const Scene scene = scene_of(source);
          const NodeSet& top = scene.model->sets().at("b.z_max");
          for (std::size_t k = 0; k < top.nodes.size(); ++k)
            source["loads"].push_back(
                {{"type", "force"},
                 {"nodes", {top.nodes[k]}},
                 {"direction", {1, 0, 0}},
                 {"history", {{"rows", {{0, 0}, {0.2, 1000 * top.areas[k]}}}, {"smooth", true}}}});
        }
        auto [scene, integrator] = run_to_end(source);
        EXPECT_THAT(tractions(scene, integrator.interface_impulse(), axis), Each(DoubleNear(1.0, 2e-8)));
        EXPECT_EQ(integrator.tally().unconverged, 0);
      }
}

// From both sides, 9 and 33 of these steps stay unsolved with a friction of 0.1 and 0.3.
TEST(DualMortar, IsSolvedWithAnyFriction) {
  for (const double friction : {0.0, 0.1, 0.3, 1.0, 10.0})
    for (const bool swapped : {false, true}) {
      GIVEN(friction);
      json source = blocks_on_each_other(patch_meshes[1], swapped, with_friction(friction), 0.3);
      source["time"]["end"] = 0.1;
      source["loads"].push_back(motion("a.z_min", {2}));
      source["loads"].push_back(pressure(1000));
      auto [scene, integrator] = run_to_end(source);
      EXPECT_EQ(scene.steps, 56);
      EXPECT_EQ(integrator.tally().unconverged, 0);
      EXPECT_LE(integrator.tally().sweeps_max, 15);
    }
}

// Then a shear grows, until a part of the face slips and lifts off.
TEST(DualMortar, IsSolvedWhileAPartSlips) {
  for (const bool swapped : {false, true}) {
    json source = blocks_on_each_other({{6, 6, 3}, {10, 10, 5}}, swapped, with_friction(0.3), 0.3);
    source["time"]["end"] = 0.45;
    source["loads"].push_back(motion("a.z_min", {0, 1, 2}));
    source["loads"].push_back(pressure(1000));
    source["loads"].push_back(json::parse(R"({"type": "force", "nodes": "b.z_max", "direction": [1, 0, 0],
                                             "history": [[0, 0], [0.2, 0], [0.6, 4.13]]})"));
    auto [scene, integrator] = run_to_end(source);
    EXPECT_EQ(integrator.tally().unconverged, 0);
    EXPECT_LE(integrator.tally().sweeps_max, 15);
    EXPECT_LE(integrator.energy().balance_error, 1e-12);
    for (const int status : {ILAW_FREE, ILAW_STICK, ILAW_SLIP})
      EXPECT_GT(integrator.tally().status_counts[static_cast<std::size_t>(status)], 200) << status;
  }
}

// ---- borders --------------------------------------------------------------------------------------------

// A body of width 1 on a pedestal with the edge at 0.45. Its center is at x.
json on_pedestal(double x, int elements_of_body, int elements_of_pedestal, bool swapped) {
  const json material = elastic(1e7, 0.3, 1000);
  json source =
      scene_of_blocks({block("a", {0, 0, 0}, {0.45, 0.4, 0.4}, {elements_of_pedestal, 1, 2}, material),
                       block("b", {x - 0.5, 0, 0.4}, {1, 0.4, 0.3}, {elements_of_body, 1, 2}, material)},
                      "[]");
  json joint = named("joint", with_friction(0.5));
  joint["nodes"] = swapped ? "a.z_max" : "b.z_min";
  joint["against"] = {{"surface", swapped ? "b.z_min" : "a.z_max"}, {"discretization", "dual_mortar"}};
  source["interfaces"] = {joint};
  source["time"] = {{"cfl", 0.8}, {"end", 1.5}};
  source["loads"] = {motion("a.z_min", {0, 1, 2}),
                     {{"type", "gravity"}, {"nodes", "b"}, {"acceleration", {0, 0, -10}}}};
  return source;
}

// Plates that are moved against each other by 0.3 edges and pressed: constraints at the border couple most.
// With directions of the conjugate method in each iteration a step would need 32.
TEST(DualMortar, NeedsFewIterationsAtABorder) {
  const json material = elastic(1.0, 0.0, 1.0);
  json source = scene_of_blocks({block("a", {0, 0, 0}, {10, 10, 1}, {10, 10, 1}, material),
                                 block("b", {0.3, 0.3, 1}, {10, 10, 1}, {10, 10, 1}, material)},
                                "[]");
  json joint = named("joint", with_friction(0.2));
  joint["nodes"] = "b.z_min";
  joint["against"] = {{"surface", "a.z_max"}, {"discretization", "dual_mortar"}};
  source["interfaces"] = {joint};
  source["time"] = {{"cfl", 0.9}, {"end", 20.0}};
  for (const char* face : {"b.z_max", "a.z_min"})
    source["loads"].push_back({{"type", "pressure"}, {"surface", face}, {"history", {{0, 1e-4}}}});
  const auto [scene, integrator] = run_to_end(source);
  EXPECT_EQ(integrator.tally().unconverged, 0);
  EXPECT_LE(integrator.tally().sweeps_max, 25);
}

// How far one end is above the other. The row of a node beyond the border must not lie at the node: a body
// with its center in the air would stand. Nor short of the border, from where a supported body tips.
double tilt_of(const json& source) {
  auto [scene, integrator] = run_to_end(source);
  EXPECT_EQ(integrator.tally().unconverged, 0);
  EXPECT_LE(integrator.tally().sweeps_max, 100);
  double least = 1e9, most = -1e9;
  for (const int node : scene.model->sets().at("b.z_max").nodes) {
    least = std::min(least, integrator.displacement()[3 * node + 2]);
    most = std::max(most, integrator.displacement()[3 * node + 2]);
  }
  return most - least;
}

TEST(DualMortar, SupportsABodyUpToTheBorder) {
  for (const auto& [body, pedestal] : {std::pair(3, 1), {3, 5}, {5, 3}, {8, 5}})
    for (const bool swapped : {false, true}) {
      GIVEN(std::to_string(body) + " on " + std::to_string(pedestal) + (swapped ? ", swapped" : ""));
      EXPECT_LT(tilt_of(on_pedestal(0.40, body, pedestal, swapped)), 0.05);
      EXPECT_GT(tilt_of(on_pedestal(0.50, body, pedestal, swapped)), 0.5);
    }
}

// ---- corners and edges of the main face -----------------------------------------------------------------

// A cube of 4 x 4 x 4 elements, turned, whose lowest node has a place.
WrittenMesh turned_cube(bool on_corner, const Eigen::Vector3d& lowest) {
  const Eigen::Matrix3d turn(Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitY()) *
                             Eigen::AngleAxisd(on_corner ? 0.3 : 0.0, Eigen::Vector3d::UnitX()));
  WrittenMesh cube =
      box_mesh({4, 4, 4}, {1, 1, 1}, false, [&](const Eigen::Vector3d& x) { return (turn * x).eval(); });
  Eigen::Vector3d least = cube.nodes.front();
  for (const Eigen::Vector3d& node : cube.nodes)
    if (node[2] < least[2]) least = node;
  for (std::size_t k = 0; k < cube.nodes.size(); ++k) {
    cube.nodes[k] += lowest - least;
    cube.of_nodes["bottom"].push_back(k < 25 ? 1 : 0);
  }
  return cube;
}

// Plate "a" from (0, 0, 0) to (2, 2, 0.3), which is held, and cube "b" that moves down with speed 1.
json on_a_plate(const MeshFile& plate, const MeshFile& cube, bool cube_is_main, const json& law) {
  json source = {{"model", {{"type", "solids"}, {"meshes", json::array()}}}};
  for (const auto& [name, file] : {std::pair{"a", &plate}, {"b", &cube}})
    source["model"]["meshes"].push_back(
        {{"name", name}, {"file", file->path().string()}, {"material", elastic(1e6, 0.3, 1000)}});
  source["model"]["meshes"][1]["velocity"] = {0, 0, -1};
  source["loads"] = {motion("a", {0, 1, 2})};
  source["time"] = {{"cfl", 0.7}, {"end", 0.07}};
  source["interfaces"] = {named("face", law)};
  source["interfaces"][0]["nodes"] = cube_is_main ? "a.top" : "b.bottom";
  source["interfaces"][0]["against"] = {{"surface", cube_is_main ? "b.bottom" : "a.top"},
                                        {"discretization", "dual_mortar"}};
  source["output"] = {{"forces", {"face"}}};
  return source;
}

WrittenMesh plate_mesh() {
  WrittenMesh plate = box_mesh({8, 8, 1}, {2, 2, 0.3}, false);
  for (const Eigen::Vector3d& node : plate.nodes) plate.of_nodes["top"].push_back(node[2] > 0.2 ? 1 : 0);
  return plate;
}

// Without edge rows the main face would sink in by 0.09 edges at a corner.
TEST(EdgeRows, BearCornersAndEdgesInBothRoles) {
  constexpr double edge = 0.25;
  const MeshFile plate(plate_mesh());
  for (const bool on_corner : {false, true})
    for (const bool cube_is_main : {false, true})
      for (const auto& [restitution, cfl] : {std::pair(0.0, 0.7), {0.5, 0.43}, {1.0, 0.31}}) {
        if (!cube_is_main && restitution > 0.0) continue;
        GIVEN(on_corner, cube_is_main, restitution);
        const MeshFile cube(turned_cube(on_corner, {0.53, 0.54, 0.32}));
        json law = in_contact();
        law["parameters"] = {{"restitution", restitution}};
        json source = on_a_plate(plate, cube, cube_is_main, law);
        source["time"]["cfl"] = cfl;
        auto [scene, integrator] = simulation_of(source);
        integrator.start();
        const std::vector<int>& nodes = scene.model->sets().at("b").nodes;
        double deepest = 0.0, most = 0.0;
        const auto energy = [&, &integrator = integrator] {
          return integrator.energy().kinetic + integrator.energy().internal;
        };
        const double start = energy();
        while (integrator.steps() < scene.steps) {
          integrator.step();
          most = std::max(most, energy() / start);
          for (const int node : nodes)
            deepest = std::max(deepest, 0.3 - scene.model->position(node, integrator.displacement())[2]);
        }
        EXPECT_LT(deepest, (cube_is_main || !on_corner ? 0.0201 : 0.05) * edge);
        EXPECT_LE(most, 1.0 + 1e-12);
        EXPECT_EQ(integrator.tally().unconverged, 0);
        EXPECT_LE(integrator.energy().balance_error, 1e-12);
      }
}

// The force of an interface is what stops the cube, edge rows counted.
TEST(EdgeRows, CountInTheForceOfTheirInterface) {
  const MeshFile plate(plate_mesh()), cube(turned_cube(true, {0.53, 0.54, 0.32}));
  auto [scene, integrator] = simulation_of(on_a_plate(plate, cube, true, in_contact()));
  ASSERT_EQ(scene.interfaces.size(), 2u);
  EXPECT_EQ(scene.interfaces[1]->name(), "face_edges");
  EXPECT_EQ(scene.interfaces[1]->nodes().size(), 16u);  // of the border of 4 x 4 facets
  ASSERT_EQ(scene.output.forces.size(), 1u);
  EXPECT_EQ(scene.output.forces[0].other_side, 1);
  double before = 0.0, after = 0.0;
  std::array<double, 2> impulses{};
  integrator.start();
  while (integrator.steps() < scene.steps) {
    integrator.step();
    for (std::size_t i = 0; i < 2; ++i)
      for (const std::int32_t contact : scene.interfaces[i]->active())
        impulses[i] += scene.interfaces[i]->impulse(contact)[2];
  }
  for (const int node : scene.model->sets().at("b").nodes) {
    const Eigen::Index up = 3 * Eigen::Index{node} + 2;
    before -= scene.model->mass()[up];
    after += scene.model->mass()[up] * integrator.velocity()[up];
  }
  EXPECT_GT(impulses[1], 0.01 * -before);
  EXPECT_NEAR(impulses[1] - impulses[0], after - before, 1e-12 * -before);
}

// Bonds need no edge rows: they pull. Values per node belong to the secondary nodes.
TEST(EdgeRows, AreMadeForLawsThatCannotPull) {
  const auto count = [](const json& law) {
    return scene_of(blocks_on_each_other(patch_meshes[0], false, law, 0.0)).interfaces.size();
  };
  EXPECT_EQ(count(in_contact()), 2u);
  EXPECT_EQ(count(with_friction(0.3)), 2u);
  EXPECT_EQ(count({{"law", "tie"}}), 1u);
  json per_node = with_friction(0.3);
  per_node["parameters"]["friction"] = {{"per_node", std::vector<double>(36, 0.3)}};
  EXPECT_EQ(count(per_node), 1u);
}

// The facets of the plate's upper side have the cube behind them, which is below the plate.
TEST(EdgeRows, LeaveANodeFarBehindTheFaceAlone) {
  const MeshFile plate(plate_mesh()), cube(turned_cube(false, {0.53, 0.54, -1.5}));
  const auto [scene, integrator] = run_to_end(on_a_plate(plate, cube, true, in_contact()));
  EXPECT_EQ(integrator.energy().interface_work, 0.0);
  EXPECT_EQ(integrator.tally().penetration_max, 0.0);
}

// ---- what is refused ------------------------------------------------------------------------------------

TEST(DualMortar, NeedsFacetsOnBothSides) {
  json source = blocks_on_each_other(patch_meshes[0], false, in_contact(), 0.0);
  EXPECT_EQ(refusal_of(source), "not refused");
  source["interfaces"][0]["nodes"] = {{"near", {0, 0, 1}}};
  EXPECT_EQ(
      refusal_of(source),
      "/interfaces/0/against/discretization: found \"dual_mortar\", expected \"node_to_facet\", or a face "
      "with facets as the 'nodes' of the interface");
  source["interfaces"][0]["nodes"] = "b.z_min";
  source["interfaces"][0]["against"]["both_sides"] = true;
  EXPECT_EQ(refusal_of(source),
            "/interfaces/0/against/both_sides: found \"dual_mortar\", which is one of both sides already");
}

// While faces slide over each other, so that weights are integrated again and again. Rows and facets of dual
// weights take memory where they meet more partners than ever before: fewer than one in ten in a step.
TEST(CoupledStep, AllocatesNothingOnceWarm) {
  const struct {
    const char* discretization;
    double at_most;  // in a step
  } cases[] = {{"node_to_facet", 0.0}, {"dual_mortar", 0.1 * (6 * 6 + 7 * 7)}};
  for (const auto& [discretization, at_most] : cases) {
    GIVEN(discretization);
    json source = blocks_on_each_other({{6, 6, 2}, {10, 10, 2}}, false, with_friction(0.2), 0.3);
    source["interfaces"][0]["against"]["discretization"] = discretization;
    source["model"]["blocks"][1]["velocity"] = {0.2, 0, 0};
    source["loads"] = {pressure(100)};
    Scene scene = scene_of(source);
    host::Integrator integrator = unaudited(scene);
    const std::int64_t warm = 2 * scene.steps / 3;
    while (integrator.steps() < warm) integrator.step();
    const long before = allocations;
    while (integrator.steps() < scene.steps) integrator.step();
    EXPECT_LE(static_cast<double>(allocations - before), at_most * static_cast<double>(scene.steps - warm));
    EXPECT_GT(integrator.energy().by_law[ILAW_ENERGY_FRICTION], 0.0);
  }
}

}  // namespace
}  // namespace ilaw::host::testing
