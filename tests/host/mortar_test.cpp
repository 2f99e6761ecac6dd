// Constraints that are integrated over the overlap of two faces: a corner that none of them belongs to, and
// memory.
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

// A cube falls with a corner on a plate that is held, whose nodes are the secondary ones: no constraint
// belongs to the corner, unless a second interface has its node.
TEST(DualMortar, BearsACornerThatHasAnInterface) {
  const Eigen::Matrix3d turn(Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitY()) *
                             Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitX()));
  WrittenMesh cube = box_mesh({4, 4, 4}, {1, 1, 1}, false, [&](const Eigen::Vector3d& x) {
    return (turn * (x - Eigen::Vector3d(0.5, 0.5, 0.5))).eval();
  });
  WrittenMesh plate = box_mesh({12, 12, 1}, {3, 3, 0.3}, false);
  double lowest = 1.0;
  for (const Eigen::Vector3d& node : cube.nodes) lowest = std::min(lowest, node[2]);
  std::size_t corner = 0;
  for (std::size_t k = 0; k < cube.nodes.size(); ++k) {
    if (cube.nodes[k][2] == lowest) corner = k;
    cube.nodes[k] += Eigen::Vector3d(1.53, 1.54, 0.32 - lowest);
    cube.of_nodes["bottom"].push_back(k < 25 ? 1 : 0);
  }
  for (const Eigen::Vector3d& node : plate.nodes) plate.of_nodes["top"].push_back(node[2] > 0.2 ? 1 : 0);
  const MeshFile plate_file(plate), cube_file(cube);
  json source = {{"model", {{"type", "solids"}, {"meshes", json::array()}}}};
  for (const auto& [name, file] : {std::pair{"a", &plate_file}, {"b", &cube_file}})
    source["model"]["meshes"].push_back(
        {{"name", name}, {"file", file->path().string()}, {"material", elastic(1e6, 0.3, 1000)}});
  source["model"]["meshes"][0]["velocity"] = {0, 0, 0};
  source["model"]["meshes"][1]["velocity"] = {0, 0, -1};
  source["loads"] = {{{"type", "motion"}, {"nodes", "a"}}};
  source["time"] = {{"cfl", 0.7}, {"end", 0.1}};
  json face = {{"name", "face"}, {"law", "contact"}}, node = {{"name", "corner"}, {"law", "contact"}};
  face["nodes"] = "a.top";
  face["against"] = {{"surface", "b.bottom"}, {"discretization", "dual_mortar"}};
  const int node_of_corner = static_cast<int>(plate.nodes.size() + corner);
  node["nodes"] = {node_of_corner};
  node["against"] = {{"surface", "a.top"}};
  for (const bool has_interface : {false, true}) {
    GIVEN(has_interface);
    source["interfaces"] = {face};
    if (has_interface) source["interfaces"].push_back(node);
    auto [scene, integrator] = simulation_of(source);
    integrator.start();
    double deepest = 0.0;
    while (integrator.steps() < scene.steps) {
      integrator.step();
      deepest = std::max(deepest, 0.3 - scene.model->position()[3 * node_of_corner + 2] -
                                      integrator.displacement()[3 * node_of_corner + 2]);
    }
    constexpr double edge = 0.25;
    if (has_interface)
      EXPECT_LT(deepest, 1e-9 * edge);
    else
      EXPECT_GT(deepest, 0.02 * edge);
    EXPECT_EQ(integrator.tally().unconverged, 0);
    EXPECT_LE(integrator.energy().interface_work, 0.0);
    EXPECT_LE(integrator.energy().balance_error, 1e-12);
  }
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
