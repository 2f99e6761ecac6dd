// Constraints that are integrated over the overlap of two faces: rows for edges and corners that none of
// them belongs to, and memory.
#include "mesh_writer.hpp"

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

json in_contact() { return {{"law", "contact"}}; }
json with_friction(double friction) { return {{"law", "coulomb"}, {"parameters", {{"friction", friction}}}}; }

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
  source["loads"] = {{{"type", "motion"}, {"nodes", "a"}}};
  source["time"] = {{"cfl", 0.7}, {"end", 0.07}};
  source["interfaces"] = {named("face", law)};
  source["interfaces"][0]["nodes"] = cube_is_main ? "a.top" : "b.bottom";
  source["interfaces"][0]["against"] = {{"surface", cube_is_main ? "b.bottom" : "a.top"}};
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

Scene of_two_blocks(json law) {
  law["nodes"] = "b.z_min";
  law["against"] = {{"surface", "a.z_max"}};
  const json blocks =
      scene_of_blocks({block("a", {0, 0, 0}, {1, 1, 0.5}, {3, 3, 2}, elastic(1e6, 0.0, 1000)),
                       block("b", {0, 0, 0.5}, {1, 1, 0.5}, {5, 5, 2}, elastic(1e6, 0.0, 1000))},
                      {law});
  return scene_of(until_at_cfl(0.8, 0.9, blocks));
}

// Bonds need no edge rows: they pull.
TEST(EdgeRows, AreMadeForLawsThatCannotPull) {
  EXPECT_EQ(of_two_blocks(in_contact()).interfaces.size(), 2u);
  EXPECT_EQ(of_two_blocks(with_friction(0.3)).interfaces.size(), 2u);
  EXPECT_EQ(of_two_blocks({{"law", "tie"}}).interfaces.size(), 1u);
}

TEST(EdgeRows, HaveTheValueOfTheClosestSecondaryNode) {
  const auto friction_at = [](double x, double y) {
    return 0.1 + 0.01 * std::round(5 * x) + 0.001 * std::round(5 * y);
  };
  json law = with_friction(0);
  std::vector<double> values;
  for (int k = 0; k < 36; ++k) values.push_back(friction_at(0.2 * (k / 6), 0.2 * (k % 6)));
  law["parameters"]["friction"] = {{"per_node", values}};
  const Scene scene = of_two_blocks(law);
  const Interface& edges = *scene.interfaces.at(1);
  ASSERT_EQ(edges.nodes().size(), 12u);
  for (std::size_t k = 0; k < 12; ++k) {
    const Vector at = scene.model->position(edges.nodes()[k]);
    EXPECT_EQ(edges.parameters_of(static_cast<int>(k)).at(0), friction_at(at[0], at[1])) << k;
  }
}

// The facets of the plate's upper side have the cube behind them, which is below the plate.
TEST(EdgeRows, LeaveANodeFarBehindTheFaceAlone) {
  const MeshFile plate(plate_mesh()), cube(turned_cube(false, {0.53, 0.54, -1.5}));
  const auto [scene, integrator] = run_to_end(on_a_plate(plate, cube, true, in_contact()));
  EXPECT_EQ(integrator.energy().interface_work, 0.0);
  EXPECT_EQ(integrator.tally().penetration_max, 0.0);
}

// While faces slide over each other, so that weights are integrated again and again. Rows and facets of dual
// weights take memory where they meet more partners than ever before: fewer than one in ten in a step.
TEST(CoupledStep, AllocatesNothingOnceWarm) {
  if (is_hostile) GTEST_SKIP() << "Newton's method takes memory";
  const struct {
    const char* discretization;
    double at_most;  // in a step
  } cases[] = {{"node_to_facet", 0.0}, {"dual_mortar", 0.1 * (6 * 6 + 7 * 7)}};
  for (const auto& [discretization, at_most] : cases) {
    GIVEN(discretization);
    json source = scene_of_blocks(
        {block("a", {0, 0, 0}, {1, 1, 0.5}, {6, 6, 2}, elastic(1e6, 0.3, 1000)),
         block("b", {0, 0, 0.5}, {1, 1, 0.5}, {10, 10, 2}, elastic(1e6, 0.3, 1000), {0.2, 0, 0})},
        {law_between("b.z_min", {{"surface", "a.z_max"}, {"discretization", discretization}}, "coulomb",
                     {{"friction", 0.2}})});
    source["loads"] = {{{"type", "pressure"},
                        {"surface", "b.z_max"},
                        {"history", {{"rows", {{0, 0}, {0.2, 100}}}, {"smooth", true}}}}};
    source = until_at_cfl(0.8, 0.9, source);
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
