// Files of meshes: sets that they name, and files that are damaged in any way; refusals.json has their
// mistakes.
#include "mesh_writer.hpp"
#include "model/mesh_topology.hpp"
#include "scene/read_meshes.hpp"

namespace ilaw::host::testing::mesh_file {
namespace {

json scene_with(const std::string& file) {
  return {{"model",
           {{"type", "solids"},
            {"meshes",
             {{{"name", "b"},
               {"file", file},
               {"material", {{"type", "linear"}, {"young", 1e6}, {"poisson", 0.3}, {"density", 1000.0}}}}}}}},
          {"time", {{"cfl", 0.9}, {"end", 0.1}}},
          {"interfaces", json::array()}};
}

WrittenMesh two_cells() { return box_mesh({2, 1, 1}, {2, 1, 1}, false); }

// Without its last byte the mesh is the same: the file ends with a line feed.
TEST(MeshFile, ThatIsCutOffIsRefused) {
  for (const char* name : {"arch.vtu", "bracket.vtu"}) {
    const MeshFile file(text_of(fs::path(ILAW_SOURCE) / "tests/host/analyst_scenes" / name));
    const MeshData whole = read_mesh_file(file.path());
    std::uintmax_t size = fs::file_size(file.path());
    fs::resize_file(file.path(), --size);
    EXPECT_EQ(read_mesh_file(file.path()).nodes, whole.nodes);
    while (size > 0) {
      fs::resize_file(file.path(), --size);
      EXPECT_THROW(read_mesh_file(file.path()), MeshError) << name << " of " << size << " bytes";
    }
  }
}

// ---- sets -----------------------------------------------------------------------------------------------

TEST(MeshFile, NamesSetsByArraysOfIntegers) {
  WrittenMesh mesh = box_mesh({2, 1, 1}, {2, 1, 1}, true);
  const auto elements = static_cast<int>(mesh.cells.size());
  mesh.cells.push_back({CellKind::triangle, {0, 1, 4, 0, 0, 0, 0, 0}});  // of z = 0, seen from inside
  mesh.cells.push_back({CellKind::vertex, {5, 0, 0, 0, 0, 0, 0, 0}});
  mesh.of_cells["gmsh:physical"].assign(mesh.cells.size(), 3);
  mesh.of_cells["gmsh:physical"][static_cast<std::size_t>(elements)] = 7;
  mesh.of_cells["gmsh:physical"].back() = 0;
  mesh.of_nodes["left"].assign(12, 0);
  for (const int node : {0, 3, 6, 9}) mesh.of_nodes["left"][static_cast<std::size_t>(node)] = 1;
  const MeshFile file(mesh);
  const Scene scene = scene_of(scene_with(file.path()).dump());
  const auto& sets = scene.model->sets();
  const NodeSet& physical = sets.at("b.gmsh_physical_7");
  EXPECT_EQ(physical.nodes, (std::vector<int>{0, 1, 4}));
  ASSERT_EQ(physical.facets.size(), 1U);
  // Counter-clockwise seen from outside, which is from below.
  const auto& facet = physical.facets[0];
  const auto at = [&](std::size_t k) { return mesh.nodes[static_cast<std::size_t>(facet[k])]; };
  EXPECT_LT((at(1) - at(0)).cross(at(2) - at(0))[2], 0.0);
  for (const double area : physical.areas) EXPECT_NEAR(area, 0.5 / 3.0, 1e-15);
  EXPECT_EQ(sets.at("b.gmsh_physical_3").nodes.size(), 12U);
  EXPECT_EQ(sets.at("b.gmsh_physical_3").facets.size(), sets.at("b.boundary").facets.size());
  EXPECT_EQ(sets.at("b.left").nodes, (std::vector<int>{0, 3, 6, 9}));
  EXPECT_EQ(sets.at("b.left").facets.size(), 2U);
  EXPECT_EQ(sets.count("b.left_1"), 0U);
}

// Numbers of nodes are no names.
TEST(MeshFile, DoesNotNameASetPerNode) {
  WrittenMesh mesh = box_mesh({10, 10, 10}, {1, 1, 1}, false);
  for (int node = 0; node < 1331; ++node) mesh.of_nodes["id"].push_back(node);
  const MeshFile file(mesh);
  EXPECT_TRUE(read_mesh_file(file.path()).groups.empty());
}

// ---- the program ----------------------------------------------------------------------------

TEST(MeshFile, IsRelativeToTheSceneAndTold) {
  const MeshFile file(box_mesh({2, 2, 2}, {1, 1, 1}, true));
  const auto folder = file.path().parent_path();
  std::ofstream(folder / "scene.json") << scene_with("mesh.vtu").dump();
  const Outcome outcome =
      run_command("cd / && " + std::string(ILAW_PROGRAM) + " run " + (folder / "scene.json").string() +
                  " --out " + (folder / "out").string());
  EXPECT_EQ(outcome.code, 0) << outcome.output;
  EXPECT_EQ(outcome.output.rfind("b from mesh.vtu: 27 nodes, 48 tetrahedra; critical step ", 0), 0U)
      << outcome.output;
  EXPECT_THAT(outcome.output, HasSubstr("; worst element: cell "));
  EXPECT_THAT(outcome.output, HasSubstr("scaled Jacobian 0.5774; sets (facets): boundary (48) x_max (8)"));
  const json summary = json_of(folder / "out" / "summary.json");
  EXPECT_EQ(summary["meshes"][0]["tetrahedra"], 48);
  EXPECT_NEAR(summary["meshes"][0]["sets"]["boundary"]["area"].get<double>(), 6.0, 1e-14);
}

TEST(MeshFile, TellsOfPartsThatShareNoNode) {
  WrittenMesh mesh = two_cells();
  const WrittenMesh other = box_mesh({1, 1, 1}, {1, 1, 1}, false);
  for (const Eigen::Vector3d& node : other.nodes) mesh.nodes.push_back(node + Eigen::Vector3d(2, 0, 0));
  MeshCell cell = other.cells[0];
  for (int& node : cell.nodes) node += 12;
  mesh.cells.push_back(cell);
  const MeshFile file(mesh);
  EXPECT_EQ(scene_of(scene_with(file.path()).dump()).meshes[0]["parts"], 2);
}

// ---- damage ---------------------------------------------------------------------------------------------

std::string damaged(std::string text, std::mt19937_64& random) {
  for (std::size_t edits = 1 + random() % 4; edits > 0; --edits) {
    const std::size_t at = random() % text.size();
    switch (random() % 4) {
      case 0:
        text[at] = static_cast<char>(random());
        break;
      case 1:
        text[at] = "0123456789-e."[random() % 13];
        break;
      case 2:
        text.erase(at, 1 + random() % 20);
        break;
      default:
        text.insert(at, std::to_string(random() >> (random() % 64)));
        break;
    }
  }
  return text;
}

// Whatever the bytes are, a mesh is read or refused; address sanitizers see that nothing else happens.
TEST(MeshFile, SurvivesDamage) {
  WrittenMesh mesh = two_cells();
  mesh.of_cells["part"] = {1, 2};
  const std::string text = mesh.vtu();
  constexpr int cases = 1500;
  std::mt19937_64 random(1);
  int refused = 0;
  for (int k = 0; k < cases; ++k) {
    const MeshFile file(damaged(text, random));
    try {
      topology_of(read_mesh_file(file.path()));
    } catch (const MeshError&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, cases / 4);
}

}  // namespace
}  // namespace ilaw::host::testing::mesh_file
